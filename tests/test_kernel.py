"""The trusted checker: what it may use, what it reads, and that every rule is decided exactly."""

from __future__ import annotations

import ast
import hashlib
import io
import json
import subprocess
import sys
import tokenize
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath as mp
import pytest
from gaincert.tests.certified_fleets import CASES
from gaincert.verify import kernel
from hypothesis import given, settings
from hypothesis import strategies as st

SOURCE = Path(kernel.__file__)
TREE = ast.parse(SOURCE.read_text())


def document(name: str = "paper") -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads(CASES[name]().certificate.to_json())
    return loaded


def reason(content: Any) -> str:
    """The rule that fails and why."""
    verdict = kernel.check(json.dumps(content))
    assert not verdict.valid
    return str(verdict)


def sign(content: dict[str, Any]) -> dict[str, Any]:
    """With the digest of the changed fleet: a certificate that states something else, not a forged one."""
    text = json.dumps(content["fleet"], sort_keys=True, separators=(",", ":"))
    return {**content, "digest": "sha256:" + hashlib.sha256(text.encode()).hexdigest()}


# -- what it is made of -----------------------------------------------------------------------------------------------


def test_it_imports_the_standard_library_alone() -> None:
    imported = {alias.name for node in ast.walk(TREE) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {str(node.module) for node in ast.walk(TREE) if isinstance(node, ast.ImportFrom)}
    assert {name.partition(".")[0] for name in imported} <= sys.stdlib_module_names | {"__future__"}
    assert not any(node.level for node in ast.walk(TREE) if isinstance(node, ast.ImportFrom))


def test_it_has_no_floating_point() -> None:
    constants = [node.value for node in ast.walk(TREE) if isinstance(node, ast.Constant)]
    assert not any(isinstance(value, (float, complex)) for value in constants)
    assert "float" not in {node.id for node in ast.walk(TREE) if isinstance(node, ast.Name)}
    from_math = [node for node in ast.walk(TREE) if isinstance(node, ast.ImportFrom) and node.module == "math"]
    assert {alias.name for node in from_math for alias in node.names} <= {"isqrt", "lcm", "gcd"}


class CheckedDivision(ast.NodeTransformer):
    """`a / b` becomes `divide(a, b)`."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Div):
            return node
        return ast.Call(ast.Name("divide", ast.Load()), [node.left, node.right], [])


def test_every_division_divides_fractions() -> None:
    divisions = []

    def divide(a: Any, b: Any) -> Any:
        divisions.append(isinstance(a, Fraction) or isinstance(b, Fraction))
        return a / b

    tree = ast.fix_missing_locations(CheckedDivision().visit(ast.parse(SOURCE.read_text())))
    space: dict[str, Any] = {"__name__": "kernel_with_checked_division", "divide": divide}
    sys.modules["kernel_with_checked_division"] = type(sys)("kernel_with_checked_division")
    exec(compile(tree, "kernel", "exec"), space)  # noqa: S102
    for name in CASES:
        assert space["check"](json.dumps(document(name))).valid
    assert divisions and all(divisions)


def test_no_value_that_decides_is_a_float(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []
    original = kernel.holds_with_margin
    monkeypatch.setattr(kernel, "holds_with_margin", lambda where, *rest: (seen.extend(rest), original(where, *rest)))
    for name in CASES:
        kernel.check(json.dumps(document(name)))
    sides = [number for entry in seen for number in (entry if isinstance(entry, tuple) else [entry])]
    assert sides and all(isinstance(number, (Fraction, int)) for number in sides)


def test_it_has_fewer_than_500_lines_of_code() -> None:
    texts = {
        line
        for node in ast.walk(TREE)
        if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node)
        for line in range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1)
    }
    quiet = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
    tokens = tokenize.generate_tokens(io.StringIO(SOURCE.read_text()).readline)
    code = {line for t in tokens if t.type not in quiet for line in range(t.start[0], t.end[0] + 1)} - texts
    assert len(code) < 500


def test_every_function_says_what_it_does() -> None:
    public = [n for n in TREE.body if isinstance(n, (ast.FunctionDef, ast.ClassDef)) and not n.name.startswith("_")]
    assert all(ast.get_docstring(node) for node in public)


# -- constants --------------------------------------------------------------------------------------------------------


def test_pi_is_enclosed() -> None:
    low, high = kernel.pi_bounds()
    with mp.workdps(90):
        assert mp.mpf(low.numerator) / low.denominator < mp.pi < mp.mpf(high.numerator) / high.denominator
    assert high - low <= Fraction(1, 10**59)


@settings(deadline=None)
@given(st.fractions(min_value=Fraction(1, 10**9), max_value=200))
def test_tanh_is_bounded_from_below_and_closely(q: Fraction) -> None:
    with mp.workdps(120):
        true = mp.tanh(mp.mpf(q.numerator) / q.denominator)
        below = mp.mpf(kernel.tanh_below(q).numerator) / kernel.tanh_below(q).denominator
        assert true * (1 - mp.mpf(10) ** -60) < below <= true


# -- psi --------------------------------------------------------------------------------------------------------------


def test_the_bound_of_the_papers_psi_is_proven_below_2_4323284() -> None:
    content = document()
    assert Fraction(content["psi_bar"]) < Fraction("2.4323284")
    for bar, valid in (("2.4323284", True), ("2.43232820886", True), ("2.4323282", False), ("2.43", False)):
        assert kernel.check(json.dumps({**content, "psi_bar": bar, "margins": _no_margins(content)})).valid == valid
    assert "psi_bounded: |psi| is 2.43232820" in reason({**content, "psi_bar": "2.4323282"})


def _no_margins(content: dict[str, Any]) -> dict[str, Any]:
    return {name: ["0"] * len(margins) for name, margins in content["margins"].items()}


@settings(deadline=None)
@given(st.integers(0, 40), st.integers(1, 8))
def test_psi_bounds_are_decided_to_every_digit(digits: int, harmonic: int) -> None:
    # |3/4 + sin(n x)| has the supremum 7/4, which no rational half-tangent attains for n = 1 .. 8 but at n x = pi/2.
    psi = kernel.Psi(Fraction(3, 4), Fraction(1), False, [(harmonic, Fraction(1), Fraction(0))])
    off = Fraction(1, 10**digits)
    for half_turn in (0, 1):
        kernel._bounded_on_half(psi, Fraction(7, 4) + off, half_turn)
    if digits <= 9:
        with pytest.raises(kernel.FalseError):
            for half_turn in (0, 1):
                kernel._bounded_on_half(psi, Fraction(7, 4) - off / 10, half_turn)


def test_a_psi_of_200_harmonics_is_bounded_in_seconds() -> None:
    sin = [str(Fraction((-1) ** n * (37 * n % 101), 128).numerator) for n in range(200)]
    psi = kernel.read_psi({"family": "harmonics", "mean": "0", "frequency": "1", "sin": sin, "cos": []})
    for half_turn in (0, 1):
        kernel._bounded_on_half(psi, sum(abs(s) for _, s, _ in psi.terms), half_turn)


def test_a_constant_psi_is_refused() -> None:
    content = document("line")
    content["designed"]["excitation"].update(sin=["0"], cos=[], mean="0.5")
    assert "excited" in reason(content)


def test_the_stated_power_and_point_are_checked() -> None:
    content = document()
    assert "excited" in reason({**content, "psi_power": "12.7323954474"})  # 40 / pi = 12.73239544735...
    assert kernel.check(json.dumps({**content, "psi_power": "12.7323954473"})).valid
    point = {**content["psi_point"], "at_least": "2.43232820886"}
    assert "psi_bounded: at the stated point" in reason({**content, "psi_point": point})


# -- conditions, decided exactly --------------------------------------------------------------------------------------


def single(torque: str, **changes: Any) -> dict[str, Any]:
    """One vehicle, r = 2, arm = 1, D = 1, p_v = k psi_bar: T = d_v + 2 p_v + d_omega + p_omega = 6 exactly."""
    limits = {"speed": None, "turn_rate": None}
    vehicle = dict.fromkeys(("mass", "inertia", "half_track"), "1") | {"name": "one", "wheel_radius": "2"}
    vehicle |= {"torque_limit": {"left": torque, "right": "100"}, "offset": ["0", "0"], "limits": limits}
    excitation = {"family": "harmonics", "mean": "0", "frequency": "1", "sin": ["0.9"], "cos": []}
    graph: dict[str, Any] = {"edges": [], "leader_links": {"one": "1"}}
    content = {
        "schema": kernel.SCHEMA,
        "conditions": "corrected",
        "fleet": {"drive": "physical", "excitation": excitation, "graph": graph, "vehicle": [vehicle]},
        "designed": {},
        "gains": dict(zip(kernel.GAINS, (["1"], ["1"], ["2"], ["1"], ["1"]), strict=True)),
        "psi_bar": "1",
        "psi_point": {"half_tangent": "1", "half_turn": 0, "at_least": "0.9"},
        "psi_power": "2.5",
        "forest": [[0, -1]],
        "margins": {"(16*)": ["0"]},
        "rates": {"gamma_omega": None, "gamma_v": None},
        "provenance": {},
    }
    return sign({**content, **changes})


@pytest.mark.parametrize("digits", [3, 15, 40, 59])
def test_a_torque_bound_equal_to_the_limit_is_accepted_and_one_above_it_refused(digits: int) -> None:
    assert kernel.check(json.dumps(single("6"))).valid
    assert kernel.check(json.dumps(single("6." + "0" * digits + "1"))).valid
    assert "(16*): vehicle 'one': 6 <= " in reason(single("5." + "9" * digits))
    assert "stated margin" in reason(single("6", margins={"(16*)": ["0." + "0" * digits + "1"]}))


def test_a_strict_condition_refuses_equality() -> None:
    with pytest.raises(kernel.FalseError):
        kernel.holds_with_margin("test", kernel.Sides(Fraction(4), Fraction(1), Fraction(3), strict=True), Fraction(0))
    kernel.holds_with_margin("test", kernel.Sides(Fraction(4), Fraction(1), Fraction(3)), Fraction(0))


@settings(deadline=None)
@given(st.fractions(min_value=Fraction(1, 100), max_value=100, max_denominator=1000), st.integers(12, 60))
def test_roots_are_compared_exactly(square: Fraction, digits: int) -> None:
    with mp.workdps(digits + 20):
        root = mp.sqrt(mp.mpf(square.numerator) / square.denominator)
        above = Fraction(int(mp.ceil(root * mp.mpf(10) ** digits)), 10**digits)
    kernel.holds_with_margin("test", kernel.Sides(square, Fraction(0), above), Fraction(0))
    below = above - Fraction(1, 10**digits)
    if below**2 < square:
        with pytest.raises(kernel.FalseError):
            kernel.holds_with_margin("test", kernel.Sides(square, Fraction(0), below), Fraction(0))


def test_a_negative_room_is_not_squared_away() -> None:
    with pytest.raises(kernel.FalseError):
        kernel.holds_with_margin("test", kernel.Sides(Fraction(1), Fraction(5), Fraction(3)), Fraction(0))
    with pytest.raises(kernel.FalseError):  # a margin so large that room - margin is negative, and its square large
        kernel.holds_with_margin("test", kernel.Sides(Fraction(1), Fraction(0), Fraction(2)), Fraction(9))


Change = Callable[[dict[str, Any]], Any]
BROKEN: list[tuple[str, Change]] = [
    ("(A2)", lambda c: c["gains"].update(p_v=["0"] + ["56"] * 5)),
    ("(A2)", lambda c: c["fleet"]["vehicle"][0].update(mass=["11", "9"])),
    ("(A2)", lambda c: c["fleet"]["vehicle"][0].update(half_track="-0.3")),
    ("edge", lambda c: c["fleet"]["graph"]["edges"].append(["v2", "v1", "1"])),
    ("edge", lambda c: c["fleet"]["graph"]["edges"].append(["v2", "v2", "1"])),
    ("edge", lambda c: c["fleet"]["graph"]["edges"].append(["v2", "v9", "1"])),
    ("edge weight", lambda c: c["fleet"]["graph"]["edges"].append(["v2", "v5", "-1"])),
    ("leader_links", lambda c: c["fleet"]["graph"]["leader_links"].update(v7="1")),
    ("negative weight", lambda c: c["fleet"]["graph"]["leader_links"].update(v1="-1")),
    ("two vehicles", lambda c: c["fleet"]["vehicle"][0].update(name="v2")),
    ("connected", lambda c: c["fleet"]["graph"].update(leader_links={})),
    ("connected", lambda c: c["fleet"]["graph"]["leader_links"].update(v2="0")),
    ("connected", lambda c: c["forest"].pop()),
    ("connected", lambda c: c["forest"].reverse()),
    ("connected", lambda c: c["forest"].insert(0, [0, 5])),
    ("connected", lambda c: c["forest"].insert(0, [0, -1])),
    ("psi_bounded", lambda c: c["fleet"]["excitation"].update(mean="2.5")),
    ("(15)", lambda c: c["gains"].update(d_omega=["27.09", *c["gains"]["d_omega"][1:]])),
    ("(16)", lambda c: c["gains"].update(d_v=["840"] * 4 + ["841"] * 2)),
    ("C >= 2 gamma M", lambda c: c["rates"]["gamma_v"].update(rate="1000000")),
    ("gamma_omega: vehicle", lambda c: c["rates"]["gamma_omega"].update(rate="0.06")),
    ("gamma_v: vehicle", lambda c: c["rates"]["gamma_v"].update(vector=[1] * 6)),
    ("positive integers", lambda c: c["rates"]["gamma_v"].update(vector=[-1] * 6)),
]


@pytest.mark.parametrize("number", range(len(BROKEN)))
def test_each_rule_names_what_fails(number: int) -> None:
    content = document()
    words, change = BROKEN[number]
    change(content)
    assert words in reason(sign(content))


def test_a_digest_that_is_not_the_fleets_is_refused() -> None:
    content = document()
    assert "same_fleet" in reason({**content, "digest": content["digest"][:-1] + "x"})
    assert not kernel.check(json.dumps(content), "sha256:" + "0" * 64).valid
    assert kernel.check(json.dumps(content), content["digest"]).valid


# -- hostile files ----------------------------------------------------------------------------------------------------

TEXT = json.dumps(document())
HOSTILE = {
    "empty": "",
    "not an object": "[1]",
    "deep": '{"a":' + "[" * 200_000 + "]" * 200_000 + "}",
    "deep objects": '{"a":' * 100_000 + "1" + "}" * 100_000,
    "duplicate key": TEXT.replace('"psi_bar"', '"psi_bar": "3", "psi_bar"', 1),
    "nan": TEXT.replace('"2.43232821109"', "NaN"),
    "infinity": TEXT.replace('"2.43232821109"', "Infinity"),
    "float": TEXT.replace('"2.43232821109"', "2.43232821109"),
    "exponent": TEXT.replace('"2.43232821109"', '"2e9"'),
    "huge integer": TEXT.replace('"2.43232821109"', "9" * 100_000),
    "long decimal": TEXT.replace('"2.43232821109"', '"2.' + "4" * 1000 + '"'),
    "other digits": TEXT.replace('"2.43232821109"', '"\\u0662.5"'),
    "spaces": TEXT.replace('"2.43232821109"', '" 2.5"'),
    "underscore": TEXT.replace('"2.43232821109"', '"2_5"'),
    "true": TEXT.replace('"2.43232821109"', "true"),
    "unknown schema": TEXT.replace("certificate-1", "certificate-2"),
    "unknown condition set": TEXT.replace('"conditions": "paper"', '"conditions": "none"'),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_files_are_refused(kind: str) -> None:
    with pytest.raises(kernel.UnreadableError) as caught:
        kernel.check_data(HOSTILE[kind].encode())
    assert len(str(caught.value)) < 500 and "\n" not in str(caught.value)


def test_too_many_values_are_refused_before_they_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel, "MAX_VALUES", 10)
    with pytest.raises(kernel.UnreadableError, match="larger"):
        kernel.check(TEXT)
    monkeypatch.setattr(kernel, "MAX_BYTES", 10)
    with pytest.raises(kernel.UnreadableError, match="larger"):
        kernel.check_data(b"{" * 11)


# -- as a program -----------------------------------------------------------------------------------------------------


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-I", str(SOURCE), *arguments], capture_output=True, text=True, check=False, timeout=60
    )


def test_it_runs_alone(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(TEXT)
    done = run(str(path))
    assert done.returncode == 0 and done.stdout.startswith("VALID") and "asymptotically stable" in done.stdout
    assert run(str(path), "sha256:0").returncode == 1
    path.write_text(TEXT.replace('"2.43232821109"', '"2.43"'))
    done = run(str(path))
    assert done.returncode == 1 and done.stdout.startswith("INVALID: psi_bounded")
    path.write_bytes(b"\xff\xfe{")
    done = run(str(path))
    assert done.returncode == 2 and "REFUSED" in done.stderr and "Traceback" not in done.stderr
    assert run(str(tmp_path / "absent")).returncode == 2
    assert run(str(tmp_path)).returncode == 2
    assert run().returncode == 2
