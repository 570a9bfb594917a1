"""Exports: the C controller against Python, the ROS 2 parameters and node, the tables."""

import csv
import ctypes
import importlib.util
import json
import math
import subprocess
import sys
import tomllib
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gaincert.cli_options import Format, Interface
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.arrays import floats
from gaincert.models.conditions import float_numbers
from gaincert.models.equations import State, closed_loop, control
from gaincert.models.errors import InputError, UndecidedError
from gaincert.models.excitation import Excitation
from gaincert.models.files.fleet_text import dumps
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES
from gaincert.models.motion_bounds import motion_bounds
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import Saturation
from gaincert.reports.deployment import Deployment, fleet_of_folder, load_deployment, write_fleet_copy
from gaincert.reports.escapes import c_comment, no_formula, yaml_text
from gaincert.reports.export import casadi_source
from gaincert.reports.export.formats import FORMATS, INTERFACES, RUN_LOG, export
from gaincert.reports.export.latex import margin_rows, psi_formula
from gaincert.reports.export.ros2 import namespaces, ros2_files
from gaincert.verify.certificates.certify import certify
from scipy.integrate import solve_ivp

ROOT = Path(__file__).parents[2]
OPS = numpy_ops()
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]
HOSTILE = (
    "*/ int x; /*",
    "??/",
    '"; exit(1); //',
    "\\input{/etc/passwd}",
    "=1+1",
    "a: [1, {b: !!python/object}]\n- x",
)
compiler = pytest.mark.needs("gcc")


def deployed_of(fleet: Fleet, excitation: object, gains: object) -> Deployment:
    return Deployment(fleet, excitation, gains, fleet.digest, None, "corrected")


def build(deployed: Deployment, folder: Path, *flags: str) -> ctypes.CDLL:
    for name, text in FORMATS["c"](deployed).items():
        (folder / name).write_text(text)
    out = folder / "controller.so"
    source = folder / "gaincert_controller.c"
    subprocess.run(["gcc", *STRICT, *flags, "-O2", "-shared", "-fPIC", "-o", out, source, "-lm"], check=True)
    library = ctypes.CDLL(str(out))
    for name in ("gaincert_torque_bound", "gaincert_torque_limit"):
        getattr(library, name).restype = ctypes.c_double
    return library


def c_torques(library: ctypes.CDLL, vehicle: int, t: float, state: State, leader: object = None) -> tuple[float, float]:
    double = ctypes.POINTER(ctypes.c_double)
    arrays = [np.ascontiguousarray(values, dtype=float).ctypes.data_as(double) for values in state]
    left, right = ctypes.c_double(), ctypes.c_double()
    end = (vehicle, ctypes.c_double(t), *arrays, ctypes.byref(left), ctypes.byref(right))
    if leader is None:
        library.gaincert_torques(*end)
    else:
        library.gaincert_torques_led(ctypes.byref(leader), *end)
    return left.value, right.value


def only_heard(library: ctypes.CDLL, vehicle: int, state: State) -> State:
    """NaN in all entries that the vehicle must not read."""
    near = [library.gaincert_neighbour(vehicle, k) for k in range(library.gaincert_neighbour_count(vehicle))]
    seen = State(*(np.full_like(values, np.nan) for values in state))
    for k, (kept, values) in enumerate(zip(seen, state, strict=True)):
        heard = [vehicle, *near] if k < 3 else [vehicle]
        kept[heard] = values[heard]
    return seen


# -- the C controller -------------------------------------------------------------------------------------------------


@compiler
def test_c_agrees_with_python_on_1000_states_and_reads_what_it_may(fleet, psi, draw_gains, draw_state, tmp_path):
    """Every graph family x both drives. Compares torques relative to the bound, and checks the bound."""
    deployed = deployed_of(fleet, psi, draw_gains(len(fleet)))
    library = build(deployed, tmp_path)
    count = -(-1000 // len(fleet))  # states times vehicles are 1000 or more
    states, times = draw_state(len(fleet), (count,)), np.linspace(0, 500, count)
    expected = control(
        numpy_ops(), fleet.plant(), deployed.gains.map(floats), psi.value(numpy_ops(), times[:, None]), states
    )
    for k in range(count):
        state = State(*(values[k] for values in states))
        for vehicle in range(len(fleet)):
            found = c_torques(library, vehicle, times[k], only_heard(library, vehicle, state))
            bound = float(deployed.torque_bounds[vehicle])
            assert library.gaincert_torque_bound(vehicle) == bound
            assert found == pytest.approx([wheel[k, vehicle] for wheel in expected], rel=0, abs=1e-12 * max(1, bound))
            assert max(map(abs, found)) <= bound * (1 + 1e-12)


@compiler
def test_the_papers_controller_stays_within_its_limits_far_out(tmp_path, random):
    library = build(deployed_of(paper_fleet(), paper_excitation(), paper_gains()), tmp_path)
    for scale in (1.0, 1e3, 1e9):
        for _ in range(200):
            state = State(*(random.uniform(-scale, scale, 6) for _ in range(5)))
            for vehicle in range(6):
                limit = library.gaincert_torque_limit(vehicle)
                assert limit == (55, 55, 160, 160, 56, 56)[vehicle]
                assert max(map(abs, c_torques(library, vehicle, 17.0, state))) <= limit


class Leader(ctypes.Structure):
    _fields_ = (("x", ctypes.c_double), ("y", ctypes.c_double), ("theta", ctypes.c_double))


@compiler
def test_the_leader_can_be_set_at_compile_time_and_at_run_time(tmp_path, draw_state):
    fleet = paper_fleet()
    deployed = deployed_of(fleet, paper_excitation(), paper_gains())
    state = draw_state(6)
    (tmp_path / "a").mkdir()
    library = build(deployed, tmp_path / "a")
    defined = build(
        deployed, tmp_path, "-DGAINCERT_LEADER_X=3.5", "-DGAINCERT_LEADER_Y=-1", "-DGAINCERT_LEADER_THETA=0.5"
    )
    plant = fleet.plant()
    moved = type(plant)(**{**vars(plant), "leader_x": 3.5, "leader_y": -1.0, "leader_theta": 0.5})
    expected = np.column_stack(
        control(numpy_ops(), moved, paper_gains().map(floats), paper_excitation().value(numpy_ops(), 2.0), state)
    )
    for vehicle in range(6):
        at_run_time = c_torques(library, vehicle, 2.0, state, Leader(3.5, -1, 0.5))
        assert at_run_time == c_torques(defined, vehicle, 2.0, state)
        assert at_run_time == pytest.approx(expected[vehicle], rel=0, abs=1e-10)
        assert (at_run_time != c_torques(library, vehicle, 2.0, state)) == (vehicle in (1, 3))  # those that hear it


@compiler
def test_an_index_that_is_no_vehicle_gives_no_torque(tmp_path, draw_state):
    library = build(deployed_of(paper_fleet(), paper_excitation(), paper_gains()), tmp_path)
    for vehicle in (-1, 6, 10**6, -(2**31)):
        assert c_torques(library, vehicle, 0.0, draw_state(6)) == (0.0, 0.0)
        assert library.gaincert_neighbour_count(vehicle) == 0
        assert library.gaincert_neighbour(vehicle, 0) == -1
        assert library.gaincert_torque_limit(vehicle) == 0


@compiler
def test_make_builds_and_the_test_program_passes_and_can_fail(fleet, psi, draw_gains, tmp_path):
    files = FORMATS["c"](deployed_of(fleet, psi, draw_gains(len(fleet))))
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    run = ["make", "-s", "-f", "gaincert_controller.mk", "CC=gcc", "all", "check"]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    # Random gains may break a limit, and the program then says so; the torques must be the computed ones in any case.
    assert "expected" not in done.stdout, done.stdout
    assert "torques of" in done.stdout, done.stderr
    source = tmp_path / "gaincert_controller.c"
    source.write_text(files["gaincert_controller.c"].replace("=cos(", "=sin(", 1))
    broken = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert broken.returncode != 0
    assert "expected" in broken.stdout


@compiler
def test_c_has_no_variables_outside_functions_and_allocates_nothing(tmp_path):
    for name, text in FORMATS["c"](deployed_of(paper_fleet(), paper_excitation(), paper_gains())).items():
        (tmp_path / name).write_text(text)
    subprocess.run(["gcc", *STRICT, "-c", "gaincert_controller.c"], cwd=tmp_path, check=True)
    symbols = subprocess.run(
        ["nm", "gaincert_controller.o"], cwd=tmp_path, check=True, capture_output=True, text=True
    ).stdout.split("\n")
    kinds = {line.split()[-2] for line in symbols if line}
    assert not kinds & set("bBdDCcGgSs")  # no data that can be written
    assert {line.split()[-1] for line in symbols if " U " in line} <= {"sin", "cos", "tanh", "sincos"}


@compiler
def test_hostile_names_stay_in_comments(tmp_path, draw_gains, psi):
    fleet = hostile_fleet()
    files = FORMATS["c"](deployed_of(fleet, psi, draw_gains(len(fleet))))
    header = files["gaincert_controller.h"]
    assert header.index("*/") > header.index("Nothing is saturated")  # the first comment ends where it should
    build(deployed_of(fleet, psi, draw_gains(len(fleet))), tmp_path)


def test_code_that_is_not_known_is_refused():
    text = (
        "static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {\n"
    )
    with pytest.raises(UndecidedError, match="not known"):
        casadi_source._cleaned(text + "  system(0);\n  return 0;\n}\n", 0, 1)
    with pytest.raises(UndecidedError, match="no function"):
        casadi_source._cleaned("", 0, 1)


def hostile_fleet() -> Fleet:
    """The paper's fleet under names that are code somewhere."""
    names = dict(zip(paper_fleet().names, HOSTILE, strict=True))
    content = json.loads(paper_fleet().model_dump_json(by_alias=True))
    content["name"] = '*/ "$(id)" <b>'
    for vehicle in content["vehicle"]:
        vehicle["name"] = names[vehicle["name"]]
    graph = content["graph"]
    graph["edges"] = [[names[a], names[b], weight] for a, b, weight in graph["edges"]]
    graph["leader_links"] = {names[name]: weight for name, weight in graph["leader_links"].items()}
    return Fleet.model_validate(content)


# -- tables -----------------------------------------------------------------------------------------------------------


def test_csv_has_its_origin_and_no_formula(tmp_path):
    deployed = deployed_of(hostile_fleet(), paper_excitation(), paper_gains())
    (tmp_path / "x.csv").write_text(FORMATS["csv"](deployed)["gains_export.csv"])
    with (tmp_path / "x.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["vehicle"] for row in rows] == [no_formula(name) for name in HOSTILE]
    assert rows[4]["vehicle"] == "'=1+1"
    assert {row["controller_digest"] for row in rows} == {deployed.digests.controller}
    assert rows[0]["p_v"] == "56"


@pytest.mark.parametrize("text", ["=1", "+1", "-1", "@x", "\tx", "\rx", "\nx"])
def test_no_cell_begins_a_formula(text):
    assert no_formula(text) == "'" + text
    assert no_formula("a" + text) == "a" + text


@pytest.mark.needs("latex")
@pytest.mark.parametrize("many", [1, 8])
def test_latex_compiles_alone_and_inside_a_document(many, tmp_path):
    fleet = hostile_fleet()
    deployed = deployed_of(fleet, paper_excitation(), paper_gains())
    text = FORMATS["latex"](deployed)["gains.tex"]
    if many > 1:  # a table that breaks over pages
        from gaincert.reports.export import latex as exports

        text = long_table(exports, deployed)
    (tmp_path / "gains.tex").write_text(text)
    (tmp_path / "outer.tex").write_text(
        "\\documentclass{article}\\usepackage{booktabs,longtable}\\begin{document}A\\input{gains}B\\end{document}"
    )
    for name in ("gains", "outer"):
        command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", name]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, errors="replace")
        assert done.returncode == 0, done.stdout[-2000:]
        assert (tmp_path / f"{name}.pdf").stat().st_size > 5000


@pytest.mark.needs("latex")
def test_latex_tables_stay_within_the_margins_of_an_article(tmp_path):
    saturation = Saturation(Fraction("0.3391"), Fraction("0.01766"), Fraction("4.065"), Fraction("16.03"))
    for unit in (True, False):
        gains = paper_gains() if unit else replace(paper_gains(), saturation=saturation)
        files = FORMATS["latex"](deployed_of(paper_fleet(), paper_excitation(), gains))
        (tmp_path / "gains.tex").write_text(files["gains.tex"])
        command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "gains"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, errors="replace")
        assert done.returncode == 0, done.stdout[-2000:]
        assert "Overfull" not in done.stdout


def long_table(exports: object, deployed: Deployment) -> str:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exports, "LONG_TABLE", 3)
        return FORMATS["latex"](deployed)["gains.tex"]


def test_latex_has_psi_and_exact_margins_and_fits_into_a_page():
    """The margins of docs/theory.md, section 6: (15) and (16) are tight under the paper's gains."""
    deployed = deployed_of(paper_fleet(), paper_excitation(), paper_gains())
    text = FORMATS["latex"](deployed)["gains.tex"]
    assert r"1.25 + \sum_{k=1}^{5} \frac{4}{(2k-1)\pi} \sin((2k-1)\cdot 0.5\,t)" in text
    assert r"|\psi(t)| \le 2.432328" in text
    assert "All scales inside $\\tanh$ are 1" in text
    margins = {row.vehicle: row.margins for row in margin_rows(deployed)}
    c = math.sqrt(2) * 3 * 2 * float(paper_excitation().bound)
    assert float(margins["v5"][0]) == pytest.approx(28 * math.tanh(1) - c, rel=1e-4)
    assert float(margins["v5"][1]) == pytest.approx(504 - 503.52, abs=0.01)
    assert float(margins["v5"][2]) > 0


def test_latex_spells_out_harmonics_and_scales():
    psi = Excitation(Fraction(0), Fraction(1, 2), (Fraction(-1, 2), Fraction(0)), (Fraction(0), Fraction(3)))
    gains = replace(paper_gains(), saturation=Saturation(Fraction(1, 4), Fraction(1, 2), Fraction(2), Fraction(3)))
    assert psi_formula(psi) == r"- 0.5 \sin(0.5\,t) + 3 \cos(1\,t)"
    assert psi_formula(replace(psi, mean=Fraction(2))).startswith("2 - 0.5")
    text = FORMATS["latex"](deployed_of(paper_fleet(), psi, gains))["gains.tex"]
    assert r"$\ell = 0.25$" in text and r"$\rho = 0.5$" in text


def test_markdown_has_one_line_for_each_vehicle_and_no_markup_of_names():
    deployed = deployed_of(hostile_fleet(), paper_excitation(), paper_gains())
    lines = FORMATS["markdown"](deployed)["gains.md"].splitlines()
    table = [line for line in lines if line.startswith("| ") and " 840 " in line]
    assert len(table) == 6
    assert "<b>" not in lines[0]
    assert deployed.fleet_digest in "\n".join(lines)


# -- ROS 2 ------------------------------------------------------------------------------------------------------------


@pytest.mark.needs("yaml")
def test_ros2_parameters_load_with_the_types_that_ros_wants():
    import yaml

    deployed = deployed_of(paper_fleet(), paper_excitation(), paper_gains())
    content = yaml.safe_load(FORMATS["ros2"](deployed)["gaincert.yaml"])
    assert list(content) == [f"/v{i}/gaincert_controller" for i in range(1, 7)]
    first = content["/v1/gaincert_controller"]["ros__parameters"]
    assert first["wheel_separation"] == 0.6
    assert first["neighbours"] == [1, 5]
    assert first["neighbour_namespaces"] == ["v2", "v6"]
    assert first["controller_digest"] == deployed.digests.controller
    for i, node in enumerate(content.values()):
        parameters = node["ros__parameters"]
        assert parameters["vehicle"] == i
        for name in GAIN_NAMES:
            assert type(parameters[name]) is float
            assert parameters[name] == float(getattr(paper_gains(), name)[i])
        assert [] not in parameters.values()
        assert (parameters["rate"], parameters["max_age"], parameters["start_time"]) == (100.0, 0.1, 0.0)


@pytest.mark.needs("yaml")
def test_the_rate_and_the_age_limit_of_the_node_come_from_the_fleet_file():
    import yaml

    content = {**paper_fleet().model_dump(by_alias=True), "disturbance": {"sample_time": "0.05", "delay": "0.04"}}
    fleet = Fleet.model_validate(content)
    written = yaml.safe_load(FORMATS["ros2"](deployed_of(fleet, paper_excitation(), paper_gains()))["gaincert.yaml"])
    for node in written.values():
        parameters = node["ros__parameters"]
        assert (parameters["rate"], parameters["max_age"]) == (20.0, pytest.approx(0.29))


@compiler
def test_the_node_knows_the_leaders_pose_from_its_parameters(node, tmp_path, draw_state):
    """With the compiled pose nothing changes; with another the commands are those for a leader there."""
    deployed = deployed_of(paper_fleet(), paper_excitation(), paper_gains())
    build(deployed, tmp_path)
    path, digest = tmp_path / "controller.so", deployed.digests.controller
    plant, known = paper_fleet().plant(), all_known(node, draw_state(6))
    pose = [plant.leader_x, plant.leader_y, plant.leader_theta]
    compiled, same = node.Library(path, digest, 6), node.Library(path, digest, 6, pose)
    moved = node.Library(path, digest, 6, [3.5, -1.0, 0.5])
    build(deployed, tmp_path, "-DGAINCERT_LEADER_X=3.5", "-DGAINCERT_LEADER_Y=-1.0", "-DGAINCERT_LEADER_THETA=0.5")
    (tmp_path / "there.so").write_bytes(path.read_bytes())
    there = node.Library(tmp_path / "there.so", digest, 6)
    for vehicle in range(6):
        for ask in ("torques", "accelerations"):
            found = getattr(compiled, ask)(vehicle, 1.0, known)
            assert getattr(same, ask)(vehicle, 1.0, known) == found
            assert getattr(moved, ask)(vehicle, 1.0, known) == getattr(there, ask)(vehicle, 1.0, known)
    assert moved.torques(1, 1.0, known) != compiled.torques(1, 1.0, known)  # vehicle 2 hears the leader


@pytest.mark.needs("yaml")
def test_hostile_names_are_yaml_strings_and_no_ros_names():
    import yaml

    content = yaml.safe_load(
        FORMATS["ros2"](deployed_of(hostile_fleet(), paper_excitation(), paper_gains()))["gaincert.yaml"]
    )
    assert list(content) == [f"/vehicle_{i}/gaincert_controller" for i in range(6)]
    assert [node["ros__parameters"]["vehicle_name"] for node in content.values()] == list(HOSTILE)
    assert namespaces(["a", "b__c"]) == ["vehicle_0", "vehicle_1"]


@pytest.mark.needs("yaml")
@pytest.mark.parametrize("text", ["plain", *HOSTILE, "\x00\x7f\x85\u2028\ufeff", "\U0001f916", "'", "# x"])
def test_text_survives_yaml(text):
    import yaml

    assert yaml.safe_load(yaml_text(text)) == text


def test_a_c_comment_holds_no_way_out():
    text = c_comment("".join(map(chr, range(0x250))))
    assert not set(text) & set('*/\\?"\n\r')


@pytest.fixture(scope="module")
def node():
    spec = importlib.util.spec_from_file_location("gaincert_node", ROOT / "reports" / "templates" / "gaincert_node.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_node_knows_headings(node):
    for angle in np.linspace(-3.1, 3.1, 9):
        assert node.yaw(0, 0, math.sin(angle / 2), math.cos(angle / 2)) == pytest.approx(angle)
    turns = np.linspace(0, 20, 200)
    seen = math.nan
    for angle in turns:
        seen = node.unwrapped(math.remainder(angle, math.tau), seen)
        assert seen == pytest.approx(angle)


@compiler
def test_the_node_commands_what_the_library_says_and_nothing_on_old_poses(node, tmp_path, draw_state):
    deployed = deployed_of(paper_fleet(), paper_excitation(), paper_gains())
    build(deployed, tmp_path)
    path = tmp_path / "controller.so"
    with pytest.raises(ValueError, match="export both again"):
        node.Library(path, "sha256:0", 6)
    library = node.Library(path, deployed.digests.controller, 6)
    assert library.neighbours(0) == [1, 5]
    assert library.torque_limit(2) == 160
    state, known = draw_state(6), node.FleetState(6)
    known.own(0, 1.0, (state.x[0], state.y[0], math.remainder(state.theta[0], math.tau)), state.v[0], state.omega[0])
    assert node.command(library, 0, 1.0, 1.0, known, 0.1) == [0, 0]  # the neighbours are not known yet
    for other in (1, 5):
        known.hear(other, 1.0, (state.x[other], state.y[other], state.theta[other]))
    known.hear(1, 1.05, (math.nan, 0.0, 0.0))  # not heard
    theta = state.theta.copy()
    theta[0] = math.remainder(theta[0], math.tau)
    full = state._replace(theta=theta)
    expected = control(
        numpy_ops(), paper_fleet().plant(), paper_gains().map(floats), paper_excitation().value(numpy_ops(), 1.0), full
    )
    assert node.command(library, 0, 1.0, 1.05, known, 0.1) == pytest.approx([wheel[0] for wheel in expected], abs=1e-10)
    assert node.command(library, 0, 1.0, 1.2, known, 0.1) == [0, 0]  # too old


def test_the_node_says_what_it_needs_where_there_is_no_ros():
    done = subprocess.run(
        [sys.executable, ROOT / "reports" / "templates" / "gaincert_node.py"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1 or "rclpy" in sys.modules
    assert "needs ROS 2" in done.stderr


# -- the velocity interface -------------------------------------------------------------------------------------------


def all_known(node, state, now=0.0):
    """The knowledge of a robot that hears the whole fleet."""
    known = node.FleetState(len(state.x))
    for vehicle, own in enumerate(zip(*state, strict=True)):
        known.hear(vehicle, now, own[:3])
        known.place(vehicle, own)
    return known


@compiler
def test_c_accelerations_are_those_of_the_closed_loop(node, fleet, psi, draw_gains, draw_state, tmp_path):
    """Every graph family x both drives, with wheels that have an inertia of their own."""
    content = fleet.model_dump(by_alias=True)
    for vehicle in content["vehicle"]:
        vehicle["wheel_inertia"] = "0.01"
    fleet = Fleet.model_validate(content)
    deployed = deployed_of(fleet, psi, draw_gains(len(fleet)))
    build(deployed, tmp_path)
    library = node.Library(tmp_path / "controller.so", deployed.digests.controller, len(fleet))
    state = draw_state(len(fleet))
    rates = closed_loop(OPS, fleet.plant(), deployed.gains.map(floats), psi.value(OPS, 3.0), state)
    known = all_known(node, state)
    for vehicle in range(len(fleet)):
        found = library.accelerations(vehicle, 3.0, known)
        assert found == pytest.approx((rates.v[vehicle], rates.omega[vehicle]), rel=1e-9, abs=1e-9)
    assert library.accelerations(len(fleet), 3.0, known) == (0, 0)


@compiler
def test_the_commanded_motion_is_the_closed_loop(node, tmp_path, draw_state):
    """All nodes of the paper's fleet, integrated together on bases that do what they are told: to 1e-9 over 20 s."""
    deployed = deployed_of(paper_fleet(), paper_excitation(), paper_gains())
    build(deployed, tmp_path)
    library = node.Library(tmp_path / "controller.so", deployed.digests.controller, 6)
    gains, plant, start = paper_gains().map(floats), paper_fleet().plant(), np.concatenate(draw_state(6))

    def commanded(t, values):
        state = State(*values.reshape(5, 6))
        known = all_known(node, state)
        nodes = [node.CommandedVelocity(library, i, 1.0, 1.0) for i in range(6)]
        own = (tuple(column[i] for column in state) for i in range(6))
        slopes = [each._slope(t, list(mine), known) for each, mine in zip(nodes, own, strict=True)]
        return np.array(slopes).T.ravel()

    def model(t, values):
        return np.concatenate(
            closed_loop(OPS, plant, gains, paper_excitation().value(OPS, t), State(*values.reshape(5, 6)))
        )

    ends = [solve_ivp(rate, (0, 20), start, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1] for rate in (commanded, model)]
    assert ends[0] == pytest.approx(ends[1], rel=0, abs=1e-9)


@compiler
def test_a_node_alone_steps_along_the_closed_loop(node, tmp_path, psi, draw_gains, draw_state):
    """One vehicle and a leader, stepped at 500 Hz by the node's own method, on a base that does what it is told."""
    content = paper_fleet().model_dump(by_alias=True)
    content["vehicle"], content["graph"] = content["vehicle"][:1], {"leader_links": {"v1": 1}}
    fleet = Fleet.model_validate(content)
    deployed = deployed_of(fleet, psi, draw_gains(1))
    build(deployed, tmp_path)
    library = node.Library(tmp_path / "controller.so", deployed.digests.controller, 1)
    gains, plant, start = deployed.gains.map(floats), fleet.plant(), np.concatenate(draw_state(1))

    def model(t, values):
        return np.concatenate(closed_loop(OPS, plant, gains, psi.value(OPS, t), State(*values.reshape(5, 1))))

    step, count = 0.002, 1000
    times = step * np.arange(count + 1)
    exact = solve_ivp(model, (0, times[-1]), start, "DOP853", rtol=1e-12, atol=1e-13, t_eval=times).y
    mover = node.CommandedVelocity(library, 0, 1.0, 1.0)
    mover.twist = tuple(exact[3:, 0])
    for k in range(count):
        known = all_known(node, State(*exact[:, k].reshape(5, 1)), times[k])
        twist = mover.advance(times[k], step, times[k], known, 0.1)
        assert twist == pytest.approx(exact[3:, k + 1], rel=0, abs=1e-9)
        assert known.pose(0) == tuple(exact[:3, k])  # as it was measured


@compiler
def test_a_base_slows_down_within_its_acceleration_where_poses_are_old(node, tmp_path, draw_state):
    deployed = deployed_of(paper_fleet(), paper_excitation(), paper_gains())
    build(deployed, tmp_path)
    library = node.Library(tmp_path / "controller.so", deployed.digests.controller, 6)
    mover = node.CommandedVelocity(library, 0, 2.0, 3.0)
    mover.twist = 0.5, -0.2
    twists = [mover.advance(9.0, 0.1, 9.0, node.FleetState(6), 0.1) for _ in range(4)]
    assert np.array(twists) == pytest.approx(np.array([[0.3, 0], [0.1, 0], [0, 0], [0, 0]]))
    known = all_known(node, draw_state(6), 9.0)
    known.x[1] = math.nan  # whatever the reason: the command stays a number
    assert mover.advance(9.0, 0.1, 9.0, known, 0.1) == (0, 0)


@pytest.mark.needs("yaml")
def test_the_velocity_interface_has_the_certified_limits_of_the_motion():
    """Under the names of diff_drive_controller; 3000 random states of a run from rest keep within them."""
    import yaml

    deployed = deployed_of(paper_fleet(), paper_excitation(), paper_gains())
    content = yaml.safe_load(ros2_files(deployed, "velocity")["gaincert.yaml"])
    plain = yaml.safe_load(FORMATS["ros2"](deployed)["gaincert.yaml"])
    data = paper_fleet().condition_data(paper_excitation())
    bounds = motion_bounds(float_numbers(), data.map(floats), paper_gains().map(floats))
    for i, (name, node) in enumerate(content.items()):
        parameters = node["ros__parameters"]
        assert parameters["interface"] == "velocity"
        assert plain[name]["ros__parameters"]["interface"] == "effort"
        assert "linear.x.max_velocity" not in plain[name]["ros__parameters"]
        for axis, speed, acceleration in (
            ("linear.x", bounds.speed, bounds.acceleration),
            ("angular.z", bounds.turn_rate, bounds.turn_acceleration),
        ):
            assert parameters[f"{axis}.max_acceleration"] == pytest.approx(acceleration[i], rel=1e-9)
            assert parameters[f"{axis}.max_deceleration"] == -parameters[f"{axis}.max_acceleration"]
            if np.isfinite(speed[i]):
                assert parameters[f"{axis}.max_velocity"] == pytest.approx(speed[i], rel=1e-9)
                assert parameters[f"{axis}.min_velocity"] == -parameters[f"{axis}.max_velocity"]
            else:
                assert f"{axis}.max_velocity" not in parameters
    assert np.isinf(bounds.turn_rate[1])  # (15') is broken by the paper's vehicles 2 and 4


def test_no_acceleration_passes_the_bound_and_some_come_near(draw_state):
    fleet, gains = paper_fleet(), paper_gains().map(floats)
    bounds = motion_bounds(float_numbers(), fleet.condition_data(paper_excitation()).map(floats), gains)
    states = State(*(100 * column for column in draw_state(6, (3000,))))
    psi = np.where(np.arange(3000) % 2, 1, -1)[:, None] * float(paper_excitation().bound)
    rates = closed_loop(OPS, fleet.plant(), gains, psi, states)
    for found, bound in ((rates.v, bounds.acceleration), (rates.omega, bounds.turn_acceleration)):
        share = np.abs(found).max(axis=0) / bound
        assert np.all(share < 1)
        assert share.max() > 0.9


def test_the_command_line_offers_every_format_and_interface():
    assert [member.value for member in Format] == [*FORMATS, RUN_LOG]
    assert [member.value for member in Interface] == list(INTERFACES)


def test_only_ros2_has_a_choice_of_interface(folder):
    assert export(folder, "ros2", interface="velocity")
    with pytest.raises(InputError, match="interface = 'velocity' belongs to the format ros2, not to c; leave it out"):
        export(folder, "c", interface="velocity")
    with pytest.raises(InputError, match="interface = 'torque' is not known; choose one of effort, velocity"):
        export(folder, "ros2", interface="torque")


# -- folders ----------------------------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path):
    """The paper's gains, certified."""
    certify(paper_fleet(), paper_excitation(), paper_gains(), "paper").write(tmp_path / "certificate.json")
    write_fleet_copy(paper_fleet(), tmp_path)
    return tmp_path


def design_of(gains: object) -> dict[str, object]:
    return {
        "fleet_digest": paper_fleet().digest,
        "conditions": "paper",
        "excitation": paper_excitation().table(),
        "gains": {name: [str(value) for value in map(float, getattr(gains, name))] for name in GAIN_NAMES},
    }


@pytest.mark.parametrize("kind", FORMATS)
def test_every_format_is_written_from_a_certificate_alone(kind, folder):
    paths = export(folder, kind)
    digest = load_deployment(folder, fleet_of_folder(folder)).certificate_digest
    assert paths
    assert all(path.stat().st_size > 100 for path in paths)
    assert any(digest in path.read_text() or digest.replace("sha256:", "") in path.read_text() for path in paths)
    assert not list(folder.glob(".*"))


def test_the_fleet_copy_says_the_same(folder):
    assert fleet_of_folder(folder) == paper_fleet()
    assert tomllib.loads((folder / "fleet_copy.toml").read_text())["name"] == "paper"


def test_a_design_and_a_certificate_of_other_gains_are_refused(folder):
    (folder / "design.json").write_text(json.dumps(design_of(paper_gains())))
    assert load_deployment(folder, paper_fleet()).certificate_digest
    other = design_of(paper_gains())
    other["gains"]["p_v"][0] = "55"
    (folder / "design.json").write_text(json.dumps(other))
    with pytest.raises(InputError, match="does not belong to the gains in design"):
        export(folder, "c")


def test_a_certificate_that_was_tampered_with_is_refused(folder):
    path = folder / "certificate.json"
    path.write_text(path.read_text().replace('"840 840 ', '"8400 840 '))
    with pytest.raises(InputError, match="certify"):
        export(folder, "c")


def test_what_is_missing_is_named(tmp_path, folder):
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(InputError, match="neither"):
        load_deployment(empty, paper_fleet())
    (folder / "fleet_copy.toml").unlink()
    with pytest.raises(InputError, match="--fleet"):
        export(folder, "c")
    (tmp_path / "given.toml").write_text(dumps(paper_fleet()))
    assert export(folder, "csv", tmp_path / "given.toml")
    with pytest.raises(InputError, match="ros2, c, latex"):
        export(folder, "matlab")


def test_designed_weights_are_deployed(tmp_path):
    design = design_of(paper_gains())
    links = json.loads(paper_fleet().links.model_dump_json())
    links["leader_links"]["v2"] = "0.5"
    (tmp_path / "design.json").write_text(json.dumps({**design, "weights": links}))
    deployed = load_deployment(tmp_path, paper_fleet())
    assert float(deployed.fleet.graph.leader_weight[1]) == 0.5
    assert deployed.fleet_digest == paper_fleet().digest


def test_the_command_line_exports(folder):
    command = [sys.executable, "-m", "gaincert", "export", folder, "--format", "csv", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == {"format": "csv", "files": [str(folder / "gains_export.csv")]}
    command[4] = folder / "absent"
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
