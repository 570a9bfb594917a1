"""Logs of a run: another decoder reads back every number."""

import csv
import math
import sys

import numpy as np
import pytest
from gaincert.models.equations import accelerations
from gaincert.models.errors import InputError
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.reports.deployment import write_fleet_copy
from gaincert.reports.export.formats import export
from gaincert.reports.export.ros_messages import Message
from gaincert.reports.export.run_log import wheel_speeds
from gaincert.verify.simulation.simulate import simulate

from tests.cli.command_line import gaincert


@pytest.fixture(scope="module")
def run():
    return simulate(paper_fleet(), paper_gains(), paper_excitation(), horizon=5.0)


@pytest.fixture
def folder(run, tmp_path):
    run.write(tmp_path / "trajectory.npz", {"fleet_digest": paper_fleet().digest, "controller_digest": "sha256:0"})
    write_fleet_copy(paper_fleet(), tmp_path)
    return tmp_path


@pytest.mark.needs("mcap")
def test_every_number_is_read_back(run, folder):
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    export(folder, "mcap")
    fleet, found = paper_fleet(), {}
    with (folder / "trajectory.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        for _, channel, message, content in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append((message.log_time, content))
        (labels,) = (record.metadata for record in reader.iter_metadata())
    assert labels == {"fleet": "paper", "fleet_digest": fleet.digest, "controller_digest": "sha256:0"}
    assert set(found) == {"/tf", *(f"/{name}/{kind}" for name in fleet.names for kind in ("pose", "twist", "wheels"))}
    left, right = wheel_speeds(fleet, run)
    for i, name in enumerate(fleet.names):
        for kind in ("pose", "twist", "wheels"):
            assert [time for time, _ in found[f"/{name}/{kind}"]] == [round(t * 1e9) for t in run.t]
        poses, twists, wheels = (
            [content for _, content in found[f"/{name}/{kind}"]] for kind in ("pose", "twist", "wheels")
        )
        assert [p.pose.position.x for p in poses] == run.state.x[:, i].tolist()
        assert [p.pose.position.y for p in poses] == run.state.y[:, i].tolist()
        turns = [2 * math.atan2(p.pose.orientation.z, p.pose.orientation.w) for p in poses]
        assert np.cos(turns) == pytest.approx(np.cos(run.state.theta[:, i]), abs=1e-12)
        assert np.sin(turns) == pytest.approx(np.sin(run.state.theta[:, i]), abs=1e-12)
        assert [t.twist.linear.x for t in twists] == run.state.v[:, i].tolist()
        assert [t.twist.angular.z for t in twists] == run.state.omega[:, i].tolist()
        assert [w.name for w in wheels] == [["left_wheel", "right_wheel"]] * len(run.t)
        assert [list(w.effort) for w in wheels] == np.column_stack([run.tau_left[:, i], run.tau_right[:, i]]).tolist()
        assert [list(w.velocity) for w in wheels] == np.column_stack([left[:, i], right[:, i]]).tolist()
        seconds = [p.header.stamp.sec + 1e-9 * p.header.stamp.nanosec for p in poses]
        assert seconds == pytest.approx(run.t, abs=1e-9)
        assert {p.header.frame_id for p in poses} == {"map"} and {t.header.frame_id for t in twists} == {name}
    frames = [content.transforms[0] for _, content in found["/tf"]]
    assert [f.child_frame_id for f in frames[:6]] == fleet.names
    assert [f.transform.translation.x for f in frames] == run.state.x.ravel().tolist()


def test_torque_times_wheel_speed_is_the_power_of_the_model(run):
    """(2) has v' m = sum of torques / r: the power of the wheels is the power that moves the vehicle."""
    fleet = paper_fleet()
    plant, (left, right) = fleet.plant(), wheel_speeds(fleet, run)
    v_rate, omega_rate = accelerations(plant, run.tau_left, run.tau_right)
    gained = plant.m * run.state.v * v_rate + plant.inertia * run.state.omega * omega_rate
    assert run.tau_left * left + run.tau_right * right == pytest.approx(gained, rel=1e-9, abs=1e-9)


@pytest.mark.needs("mcap")
def test_the_table_has_one_row_per_time_and_one_column_per_signal(run, folder):
    export(folder, "mcap")
    with (folder / "trajectory.csv").open(newline="") as file:
        heading, *rows = csv.reader(file)
    assert heading[:8] == ["t", *(f"v1/{c}" for c in ("x", "y", "theta", "v", "omega", "tau_left", "tau_right"))]
    assert heading[-2:] == ["V", "W"] and len(heading) == 1 + 6 * 7 + 2
    numbers = np.array(rows, dtype=float)
    assert numbers[:, 0].tolist() == run.t.tolist()
    assert numbers[:, heading.index("v3/tau_right")].tolist() == run.tau_right[:, 2].tolist()
    assert numbers[:, -1].tolist() == run.W.tolist()


def test_numbers_are_aligned_to_their_size():
    """CDR: four bytes of header, then each number at a multiple of its own size."""
    text_then_double = Message().text("ab").number("d", 1.0).data().hex()
    assert text_then_double == "00010000" + "03000000" + "616200" + "00" + "000000000000f03f"
    assert Message().number("I", 1).numbers([]).data().hex() == "00010000" + "01000000" + "00000000"


@pytest.mark.needs("mcap")
def test_the_command_line_says_what_is_missing(folder):
    assert gaincert("export", folder, "--format", "mcap").returncode == 0
    (folder / "trajectory.npz").unlink()
    done = gaincert("export", folder, "--format", "mcap")
    assert done.returncode == 2
    assert "trajectory.npz: is not there; run gaincert simulate first" in done.stderr


def test_a_run_of_another_fleet_is_refused(run, folder):
    run.write(folder / "trajectory.npz", {"fleet_digest": "sha256:0"})
    with pytest.raises(InputError, match="belongs to another fleet; simulate again"):
        export(folder, "mcap")


def test_the_package_is_named_where_it_is_missing(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "mcap", None)
    with pytest.raises(InputError, match=r"needs the package mcap: pip install 'gaincert\[logs\]'"):
        export(folder, "mcap")
    assert not (folder / "trajectory.mcap").exists()
