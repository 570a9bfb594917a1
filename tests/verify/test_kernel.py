"""The trusted checker: what it may use, what it reads, and that every rule is decided exactly."""

from __future__ import annotations

import ast
import gc
import hashlib
import io
import json
import math
import subprocess
import sys
import tokenize
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath as mp
import pytest
from gaincert.models import conditions
from gaincert.models.numbers import decimal_text
from gaincert.verify import kernel
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.campaigns.certified_fleets import CASES

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


def signed(content: dict[str, Any]) -> dict[str, Any]:
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
    assert high - low == Fraction(1, 10**60)


@pytest.mark.parametrize("n", [5, 239])
def test_arctangents_are_enclosed_by_their_first_term_left_out(n: int) -> None:
    low, high = kernel._arctan_of_inverse(n)
    assert high - low == Fraction(1, 101 * n**101)
    with mp.workdps(600):
        assert (
            mp.mpf(low.numerator) / low.denominator < mp.atan(mp.mpf(1) / n) < mp.mpf(high.numerator) / high.denominator
        )


@settings(deadline=None)
@given(st.fractions(min_value=Fraction(1, 10**9), max_value=200))
def test_tanh_is_bounded_from_below_and_closely(q: Fraction) -> None:
    with mp.workdps(400):  # exp(200) is 1e87, and the difference less than its inverse squared
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


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("half_turn", [0, 1])
def test_a_bound_is_checked_on_both_halves_and_for_both_signs(sign: int, half_turn: int) -> None:
    """|1/4 + cos(x)| has its only supremum, 5/4, at x = 0; with -cos(x) it is at x = pi; then both negated."""
    amplitude = f"{-sign if half_turn else sign}"
    table = {"family": "harmonics", "mean": f"{sign * 0.25}", "frequency": "1", "sin": [], "cos": [amplitude]}
    point = {"half_tangent": "0", "half_turn": half_turn, "at_least": "1.25"}
    for bar, valid in (("1.2500000001", True), ("1.2499999999", False), ("0.25", False), ("0.2499", False)):
        content = single("100", psi_bar=bar, psi_point=point)
        content["fleet"]["excitation"] = table
        verdict = kernel.check(json.dumps(signed(content)))
        assert verdict.valid == valid
        if not valid:
            beyond = (
                f"psi has the mean {sign * 0.25}, beyond psi_bar = {bar}" if bar == "0.2499" else f"> {bar} = psi_bar"
            )
            assert verdict.rule == "psi_bounded" and beyond in verdict.reason
    psi = kernel.read_psi(table)
    kernel._bounded_on_half(psi, Fraction("1.2499999999"), 1 - half_turn)
    with pytest.raises(kernel.FalseError, match="plus half a period" if half_turn else r"is 0/1$"):
        kernel._bounded_on_half(psi, Fraction("1.2499999999"), half_turn)


@pytest.mark.parametrize("n", range(1, 6))
def test_every_cosine_is_turned_by_half_a_period(n: int) -> None:
    psi = kernel.read_psi(
        {"family": "harmonics", "mean": "0.75", "frequency": "1", "sin": [], "cos": ["0"] * (n - 1) + ["1"]}
    )
    hair = Fraction(1, 10**9)
    for half_turn in (0, 1):
        kernel._bounded_on_half(psi, Fraction("1.75") + hair, half_turn)
    with pytest.raises(kernel.FalseError):
        kernel._bounded_on_half(psi, Fraction("1.75") - hair, 0)
    if n == 1:
        kernel._bounded_on_half(psi, Fraction("0.76"), 1)
    else:
        with pytest.raises(kernel.FalseError):
            kernel._bounded_on_half(psi, Fraction("1.5"), 1)


def between_the_bounds_of_4_over_pi() -> Fraction:
    """A decimal of which the enclosure of pi cannot tell on which side of 4 / pi it lies."""
    low, high = kernel.pi_bounds()
    unit = 10**70
    return Fraction(int((4 / low + 4 / high) / 2 * unit), unit)


@pytest.mark.parametrize("tangent", ["1", "-1"])
def test_what_the_enclosure_of_pi_cannot_tell_is_refused(tangent: str) -> None:
    """4 / pi sin(x) at its extrema: the stated value, and the bound, must hold for every pi that is enclosed."""
    square = {"family": "square-wave", "mean": "0", "frequency": "1", "terms": 1}
    middle, hair = between_the_bounds_of_4_over_pi(), Fraction(1, 10**60)
    for least, holds in ((middle - hair, True), (middle, False)):
        point = {"half_tangent": tangent, "half_turn": 0, "at_least": decimal_text(least)}
        content = single("100", psi_bar="1.2733", psi_point=point)
        content["fleet"]["excitation"] = square
        verdict = kernel.check(json.dumps(signed(content)))
        assert verdict.valid == holds
        assert holds or "at the stated point |psi| is 1.27323954474 < 1.27323954474" in verdict.reason
    with pytest.raises(kernel.FalseError, match=r"^\|psi\| is 1.27323954474 > 1.27323954474"):
        kernel._bounded_on_half(kernel.read_psi(square), middle, 0)


def test_the_power_is_accepted_up_to_its_lower_bound() -> None:
    exact = Fraction("0.81") * kernel.pi_bounds()[0]
    assert kernel.check(json.dumps(single("6", psi_power=decimal_text(exact)))).valid
    assert "excited" in reason(single("6", psi_power=decimal_text(exact + Fraction(1, 10**70))))


@pytest.mark.parametrize(
    "psi",
    [
        kernel.Psi(
            Fraction(1, 4), Fraction(1), False, [(1, Fraction(0), Fraction(-1)), (2, Fraction(1, 3), Fraction(1))]
        ),
        kernel.Psi(Fraction(-2), Fraction(1), False, [(3, Fraction(-1, 2), Fraction(1, 7))]),
        kernel.Psi(
            Fraction(1, 2), Fraction(1), True, [(1, Fraction(4), Fraction(0)), (3, Fraction(4, 3), Fraction(0))]
        ),
    ],
)
@pytest.mark.parametrize("half_turn", [0, 1])
def test_an_arc_is_settled_where_its_ends_lie_above_what_the_curvature_can_take(
    psi: kernel.Psi, half_turn: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The points that are evaluated are those of the rule: B h^2 / 8 at most, where h = 2 e and |psi''| <= B."""
    scale = mp.pi if psi.over_pi else mp.mpf(1)
    mean = mp.mpf(psi.mean.numerator) / psi.mean.denominator
    waves = [(n, mp.mpf(s.numerator) / s.denominator, mp.mpf(c.numerator) / c.denominator) for n, s, c in psi.terms]
    curvature = sum(n * n * (abs(s) + abs(c)) for n, s, c in waves) / scale

    def size(t: Fraction) -> Any:
        x = 2 * mp.atan(mp.mpf(t.numerator) / t.denominator) + mp.pi * half_turn
        return abs(mean + sum(s * mp.sin(n * x) + c * mp.cos(n * x) for n, s, c in waves) / scale)

    supremum = max(size(Fraction(i, 2000)) for i in range(-2000, 2001))
    bar = Fraction(str(mp.nstr(supremum + mp.mpf("0.001"), 12)))

    def visited(left: Fraction, width: Fraction) -> set[Fraction]:
        slack = min(mp.mpf(bar.numerator) / bar.denominator - size(t) for t in (left, left + width))
        if slack >= curvature * mp.mpf(2 * width.numerator) ** 2 / width.denominator**2 / 8:
            return {left, left + width}
        return visited(left, width / 2) | visited(left + width / 2, width / 2)

    points: set[Fraction] = set()
    true_sum = kernel.harmonic_sum
    monkeypatch.setattr(
        kernel, "harmonic_sum", lambda terms, p, q: (points.add(Fraction(p, q)), true_sum(terms, p, q))[1]
    )
    kernel._bounded_on_half(psi, bar, half_turn)
    assert points == visited(Fraction(-1), Fraction(1)) | visited(Fraction(0), Fraction(1))
    assert len(points) > 10


def test_the_supremum_itself_is_refused_as_too_close_and_not_believed() -> None:
    psi = kernel.Psi(Fraction(3, 4), Fraction(1), False, [(1, Fraction(0), Fraction(1))])
    kernel._bounded_on_half(psi, Fraction(7, 4), 1)  # there the cosine is <= 0
    with pytest.raises(kernel.FalseError, match="too close to the supremum"):
        kernel._bounded_on_half(psi, Fraction(7, 4), 0)


@pytest.mark.parametrize("wide", [7, 40_000])
def test_the_work_on_psi_is_bounded_to_the_last_evaluation(wide: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """An evaluation at p / 2^(k + 1) counts 1 + (highest harmonic) k^2 / WIDE; the four at the ends count nothing."""
    points: list[int] = []
    true_sum = kernel.harmonic_sum

    def counted(terms: dict[int, tuple[int, int]], p: int, q: int) -> tuple[int, int]:
        points.append(q)
        return true_sum(terms, p, q)

    monkeypatch.setattr(kernel, "harmonic_sum", counted)
    monkeypatch.setattr(kernel, "WIDE", wide)
    psi = kernel.Psi(Fraction(0), Fraction(1), False, [(1, Fraction(1), Fraction(0)), (5, Fraction(1), Fraction(0))])
    bar = 2 + Fraction(1, 10**20)
    kernel._bounded_on_half(psi, bar, 0)
    assert points[:4] == [1] * 4
    cost = sum(1 + 5 * (q.bit_length() - 2) ** 2 // wide for q in points[4:])
    monkeypatch.setattr(kernel, "MAX_WORK", 5 * cost)
    kernel._bounded_on_half(psi, bar, 0)
    monkeypatch.setattr(kernel, "MAX_WORK", 5 * cost - 1)
    with pytest.raises(kernel.FalseError, match="too close to the supremum"):
        kernel._bounded_on_half(psi, bar, 0)


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
    line = document("line")  # psi = sin + sin 3 / 4 at half the frequency: pi / 2 (1 + 9 / 16) = 2.45436926061702...
    assert "excited" in reason({**line, "psi_power": "2.454369260618"})
    assert kernel.check(json.dumps({**line, "psi_power": "2.454369260617"})).valid
    assert "(A2): psi_power" in reason({**line, "psi_power": "0"})
    point = {**content["psi_point"], "at_least": "2.43232820886"}
    assert "psi_bounded: at the stated point" in reason({**content, "psi_point": point})


@pytest.mark.parametrize("half_turn", [0, 1])
def test_the_stated_point_is_taken_with_either_sign_and_up_to_equality(half_turn: int) -> None:
    """1/8 + 9/10 sin(x): 41/40 at a quarter turn, -31/40 at three quarters."""
    table = {"family": "harmonics", "mean": "0.125", "frequency": "1", "sin": ["0.9"], "cos": []}
    for tangent, value in (("1", "1.025"), ("-1", "0.775")):
        if half_turn:
            tangent = {"1": "-1", "-1": "1"}[tangent]
        for beyond, holds in (("", True), ("0000000001", False)):
            point = {"half_tangent": tangent, "half_turn": half_turn, "at_least": value + beyond}
            content = single("7", psi_bar="1.1", psi_point=point)
            content["fleet"]["excitation"] = table
            verdict = kernel.check(json.dumps(signed(content)))
            assert verdict.valid == holds, verdict
            assert holds or f"|psi| is {value} < {value}" in verdict.reason


@pytest.mark.parametrize("half_turn", [2, -1, True, "1", None])
def test_a_half_turn_is_0_or_1(half_turn: Any) -> None:
    point = {"half_tangent": "1", "half_turn": half_turn, "at_least": "0.9"}
    with pytest.raises(kernel.UnreadableError, match="half_turn"):
        kernel.check(json.dumps(single("6", psi_point=point)))


def test_a_negative_least_value_is_refused() -> None:
    point = {"half_tangent": "1", "half_turn": 0, "at_least": "-0.1"}
    assert "at the stated point" in reason(single("6", psi_point=point))
    assert kernel.check(json.dumps(single("6", psi_point={**point, "at_least": "0"}))).valid


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
    return signed({**content, **changes})


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


@pytest.mark.parametrize("name", CASES)
def test_its_conditions_are_those_of_the_models(name: str) -> None:
    case = CASES[name]()
    claims = kernel.read_claims(document(name))
    bounds = case.fleet.condition_data(case.psi)
    assert claims.psi_bar == bounds.psi_bar
    for condition in (
        conditions.condition_15,
        conditions.condition_15_prime,
        conditions.condition_16,
        conditions.condition_16_star,
        conditions.speed_condition,
        conditions.turn_rate_condition,
    ):
        sides = condition(conditions.exact_numbers(), bounds, case.gains)
        for vehicle, small, large in zip(claims.vehicles, sides.small, sides.large, strict=True):
            own = kernel.CONDITIONS[sides.source](vehicle, claims.psi_bar)
            assert (own is None) == (large == math.inf)
            if own is not None:
                assert math.sqrt(own.square) + float(own.rest) == pytest.approx(float(small), rel=1e-14)
                assert float(own.large) == pytest.approx(float(large), rel=1e-14)
                assert own.strict == sides.strict


def test_no_room_is_room_for_nothing_and_a_little_less_is_none() -> None:
    nothing = kernel.Sides(Fraction(0), Fraction(1), Fraction(1))
    kernel.holds_with_margin("test", nothing, Fraction(0))
    kernel.holds_with_margin("test", kernel.Sides(Fraction(0), Fraction(1), Fraction(3)), Fraction(2))
    for square in (Fraction(0), Fraction(1, 100)):
        with pytest.raises(kernel.FalseError, match=r"<= 0.5 fails by 0\.[56]$"):
            kernel.holds_with_margin("test", kernel.Sides(square, Fraction(1), Fraction(1, 2)), Fraction(0))


def test_a_margin_is_accepted_up_to_the_room_there_is() -> None:
    sides = kernel.Sides(Fraction(4), Fraction(1), Fraction(9))  # 2 + 1 <= 9, 6 to spare
    for margin in ("0", "3", "6"):
        kernel.holds_with_margin("test", sides, Fraction(margin))
    for margin in ("-0.001", "6.001", "8", "8.5", "10", "14"):
        with pytest.raises(kernel.FalseError, match=f"stated margin {margin} is not in 0 .. 6$"):
            kernel.holds_with_margin("test", sides, Fraction(margin))


@pytest.mark.parametrize(
    ("sides", "words"),
    [
        (kernel.Sides(Fraction(4), Fraction(1), Fraction(2)), "3 <= 2 fails by 1"),
        (kernel.Sides(Fraction(4), Fraction(1), Fraction(3), strict=True), "3 < 3 fails by 0"),
        (
            kernel.Sides(Fraction(2, 10**60), Fraction(0), Fraction(1, 10**30)),
            "1.41421356237e-30 <= 1e-30 fails by 4.14213562373e-31",
        ),
        (
            kernel.Sides(Fraction(2 * 10**60), Fraction(0), Fraction(-1)),
            "1.41421356237e+30 <= -1 fails by 1.41421356237e+30",
        ),
    ],
)
def test_what_fails_is_said_with_both_sides(sides: kernel.Sides, words: str) -> None:
    with pytest.raises(kernel.FalseError) as caught:
        kernel.holds_with_margin("here", sides, Fraction(0))
    assert str(caught.value) == f"here: {words}"


def test_a_vehicle_counts_with_its_worst_values() -> None:
    row = {"name": "v", "mass": ["2", "3"], "inertia": ["5", "7"], "half_track": ["1", "2"], "offset": ["0", "0"]}
    row |= {"wheel_radius": ["3", "4"], "torque_limit": {"left": ["10", "20"], "right": ["8", "30"]}}
    row |= {"limits": {"speed": "0.5", "turn_rate": None}}
    gains = [Fraction(n) for n in range(11, 16)]
    for lever in (1, 2):
        read = kernel.read_vehicle(row, lever, Fraction(9), *gains)
        assert read == kernel.Vehicle(
            "v", (Fraction(2 * 3, 4), Fraction(3 * 4, 3)), (Fraction(5 * 3, 4 * 2), Fraction(7 * 4 * 2, 3)),
            Fraction(4), Fraction(lever), Fraction(8), Fraction(1, 2), None, Fraction(9), *gains,
        )  # fmt: skip
    row["torque_limit"] = {"left": ["7", "20"], "right": ["8", "30"]}
    assert kernel.read_vehicle(row, 1, Fraction(9), *gains).torque == 7


# -- rates, decided exactly -------------------------------------------------------------------------------------------


def pencil(weights: list[str], led: str, masses: list[tuple[str, str]], damping: list[Fraction]) -> kernel.Claims:
    """A line of vehicles, led at its beginning, with p = 2, 3, ...: what the rule of the rates reads."""
    edges = [(i, i + 1, Fraction(weight)) for i, weight in enumerate(weights)]
    degrees = [Fraction(led), *[Fraction(0)] * len(weights)]
    for i, j, weight in edges:
        degrees[i] += weight
        degrees[j] += weight
    one, psi = Fraction(1), kernel.Psi(Fraction(0), Fraction(1), False, [])
    vehicles = [
        kernel.Vehicle(
            f"v{i}", (low, high), (2 * low, 2 * high), one, one, one, None, None, degree, Fraction(i + 2), d,
            Fraction(i + 2), 2 * d, one,
        )
        for i, ((low, high), degree, d) in enumerate(
            zip([(Fraction(a), Fraction(b)) for a, b in masses], degrees, damping, strict=True)
        )
    ]  # fmt: skip
    return kernel.Claims({}, vehicles, edges, {0: Fraction(led)}, psi, one)


HAIR = Fraction(1, 10**30)
LINE = ["0.5", "0.75"], "2", [("1", "1.5"), ("0.5", "0.5"), ("2", "3")]
VECTOR, ROWS = [10, 18, 20], (Fraction(16), Fraction("2.5"), Fraction("1.5"))  # K x of that line


def what_is_wrong(name: str, damping: list[Fraction], vector: list[int] = VECTOR) -> str:
    try:
        kernel.rate(pencil(*LINE, damping), name, "0.01", vector)
    except kernel.FalseError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(("name", "doubled"), [("gamma_v", 1), ("gamma_omega", 2)])
def test_a_rate_is_accepted_up_to_equality_in_every_row(name: str, doubled: int) -> None:
    """Damping that leaves each row of (K - gamma C + gamma^2 M) x at exactly 0: a hair more is too much."""
    gamma, lows = Fraction("0.01"), [Fraction(low) for low, _ in LINE[2]]
    d = [(i + 2) * ROWS[i] / (gamma * VECTOR[i] * doubled) + gamma * lows[i] for i in range(3)]
    assert what_is_wrong(name, d) == ""
    assert what_is_wrong(name, d, [1000 * entry for entry in VECTOR]) == ""
    for i in range(3):
        more = [*d[:i], d[i] + HAIR, *d[i + 1 :]]
        assert what_is_wrong(name, more).startswith(f"{name}: vehicle 'v{i}': (K - gamma C + gamma^2 M) x is -")


@pytest.mark.parametrize("name", ["gamma_v", "gamma_omega"])
def test_a_rate_is_accepted_up_to_critical_damping(name: str) -> None:
    d = [2 * Fraction("0.01") * Fraction(high) for _, high in LINE[2]]
    assert what_is_wrong(name, d) == ""
    for i in range(3):
        less = [*d[:i], d[i] - HAIR, *d[i + 1 :]]
        assert what_is_wrong(name, less).startswith(f"{name}: vehicle 'v{i}': C >= 2 gamma M fails: ")


@pytest.mark.parametrize("entry", [0, -1, True, "1"])
def test_the_vector_of_a_rate_has_positive_integers(entry: Any) -> None:
    assert "positive integers" in what_is_wrong("gamma_v", [Fraction(1)] * 3, [10, entry, 20])


Change = Callable[[dict[str, Any]], Any]
BROKEN: list[tuple[str, Change]] = [
    ("INVALID: well_formed: (A2)", lambda c: c["gains"].update(p_v=["-1"] + ["56"] * 5)),
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
    assert words in reason(signed(content))


def test_a_digest_that_is_not_the_fleets_is_refused() -> None:
    content = document()
    assert "same_fleet" in reason({**content, "digest": content["digest"][:-1] + "x"})
    assert not kernel.check(json.dumps(content), "sha256:" + "0" * 64).valid
    assert kernel.check(json.dumps(content), content["digest"]).valid


# -- what follows -----------------------------------------------------------------------------------------------------

ALWAYS = ("From every initial state, the closed loop", "From every initial state and at all times, no wheel torque")
TURNING, FAST, QUICK = (
    "|omega_i(t)| <= max(|omega_i(t0)|, atanh",
    "|v_i(t)| <= max",
    "|omega_i(t)| <= max(|omega_i(t0)|, its",
)
HEADINGS, ALONG = "Linearised at the formation, the headings", "Linearised at the formation, the along-track"


@pytest.mark.parametrize(
    ("name", "own"),
    [
        ("paper", (HEADINGS, ALONG)),
        ("mixed_ring", (TURNING, FAST, QUICK, HEADINGS, ALONG)),
        ("line", (HEADINGS, ALONG)),
    ],
)
def test_the_theorem_has_a_sentence_for_each_claim_and_no_other(name: str, own: tuple[str, ...]) -> None:
    content = document(name)
    first, *rest = kernel.check(json.dumps(content)).theorem
    designed = ", designed excitation" if name == "line" else ""
    assert first == (
        f"{len(content['fleet']['vehicle'])} vehicles, fleet {content['digest']}, conditions {content['conditions']}"
        + designed
    )
    begins = (*ALWAYS, f"|psi| <= {content['psi_bar']} (psi_bar).", *own)
    assert len(rest) == len(begins)
    assert all(line.startswith(begin) for line, begin in zip(rest, begins, strict=True))
    for line, key in zip(rest[-2:], ("gamma_omega", "gamma_v"), strict=True):
        assert line.endswith(f"no exponent above -{content['rates'][key]['rate']} 1/s ({key}).")
        less = {**content, "rates": {**content["rates"], key: None}}
        assert kernel.check(json.dumps(less)).theorem == tuple(kept for kept in (first, *rest) if kept != line)


@pytest.mark.parametrize(("limit", "sentence"), [("speed", FAST), ("turn_rate", QUICK)])
def test_a_limit_is_claimed_where_one_vehicle_asks_for_it(limit: str, sentence: str) -> None:
    content = single("100")
    content["gains"].update(d_v=["3"], d_omega=["5"])
    content["fleet"]["vehicle"][0]["limits"][limit] = "1"
    condition = limit.replace("_", " ") + " limit"
    assert f"expected a table with the keys (16*), {condition}" in str(refusal(signed(content)))
    content["margins"][condition] = ["0"]
    assert any(line.startswith(sentence) for line in kernel.check(json.dumps(signed(content))).theorem)
    content["margins"][condition] = [None]
    assert f"{condition}: vehicle 'one': the margin must be null iff no limit is asked for" in reason(signed(content))
    content["margins"] = {"(16*)": [None]}
    content["fleet"]["vehicle"][0]["limits"][limit] = None
    assert "(16*): vehicle 'one': the margin must be null iff" in reason(signed(content))


def refusal(content: Any) -> kernel.UnreadableError:
    with pytest.raises(kernel.UnreadableError) as caught:
        kernel.check(json.dumps(content))
    return caught.value


# -- reading ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"a": 1.5}', "1.5 must be written as a decimal string"),
        ('{"a": 1e3}', "1e3 must be written as a decimal string"),
        ('{"a": [-Infinity]}', "-Infinity is not a number"),
        ('{"a": {"b": 1, "b": 1}}', "a key stands twice in one table"),
        ('{"a": ' + "1" * 131 + "}", "an integer is too long"),
        ("{", "the file is not JSON: "),
        ("\udcff", "the file is not JSON: "),
    ],
)
def test_what_no_file_may_hold_is_refused_wherever_it_stands(text: str, words: str) -> None:
    with pytest.raises(kernel.UnreadableError) as caught:
        kernel.load(text.encode("utf-8", "surrogateescape"))
    assert str(caught.value).startswith(words)


@pytest.mark.parametrize(
    ("value", "found"), [({"b": 1, "a": 2, "c": 3}, "['a', 'b', 'c']"), ({"b": 1}, "['b']"), (5, "5"), (None, "None")]
)
def test_a_table_has_exactly_the_keys_that_are_asked_for(value: Any, found: str) -> None:
    assert kernel.table({"b": 1, "a": 2}, "a", "b") == [2, 1]
    with pytest.raises(kernel.UnreadableError) as caught:
        kernel.table(value, "a", "b")
    assert str(caught.value) == f"expected a table with the keys a, b, not {found}"


def test_a_list_has_the_length_that_is_asked_for() -> None:
    assert kernel.sequence([1, 2]) == kernel.sequence([1, 2], 2) == [1, 2]
    assert kernel.sequence([], 0) == []
    for value, length, words in (
        ({}, None, "a list, not {}"),
        ([1], 2, "a list of 2, not [1]"),
        ([1], 0, "a list of 0"),
    ):
        with pytest.raises(kernel.UnreadableError) as caught:
            kernel.sequence(value, length)
        assert str(caught.value).startswith(f"expected {words}")


@pytest.mark.parametrize("value", [1.5, True, False, None, [1], {"1": 1}])
def test_a_number_is_an_integer_or_a_text(value: Any) -> None:
    assert (kernel.number(-7), kernel.number("-7")) == (-7, -7)
    with pytest.raises(kernel.UnreadableError, match="is not a decimal number"):
        kernel.number(value)


def test_designed_parts_stand_in_place_of_the_fleets() -> None:
    content = single("100")
    graph = {"edges": [], "leader_links": {"one": "1.5"}}
    excitation = {"family": "square-wave", "mean": "0.25", "terms": 2, "frequency": "3"}
    claims = kernel.read_claims({**content, "designed": {"graph": graph, "excitation": excitation}})
    assert claims.vehicles[0].degree == claims.led[0] == Fraction(3, 2)
    assert claims.psi == kernel.read_psi(excitation)
    content["designed"] = {"graph": graph, "excitation": content["fleet"]["excitation"]}
    first, *_ = kernel.check(json.dumps(content)).theorem
    assert first.endswith(", conditions corrected, designed excitation, designed graph")
    plain = kernel.read_claims({**content, "designed": {}})
    assert plain.vehicles[0].degree == 1 and plain.psi == kernel.read_psi(content["fleet"]["excitation"])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: c["gains"].update(p_v=["0"]), "p_v must be > 0, not 0"),
        (lambda c: c["gains"].update(k_alpha=["-0.5"]), "k_alpha must be > 0, not -0.5"),
        (lambda c: c["fleet"]["vehicle"][0].update(mass="0"), "a parameter must be > 0, not 0"),
        (
            lambda c: c["fleet"]["vehicle"][0].update(mass=["3", "2"]),
            "a parameter must satisfy 0 < low <= high, not 3, 2",
        ),
        (lambda c: c["fleet"]["vehicle"][0]["limits"].update(speed="0"), "limit must be > 0, not 0"),
        (lambda c: c["fleet"]["excitation"].update(frequency="-1"), "frequency must be > 0, not -1"),
        (lambda c: c.update(psi_power="-1"), "psi_power must be > 0, not -1"),
        (lambda c: c["rates"].update(gamma_v={"rate": "0", "vector": [1]}), "gamma_v must be > 0, not 0"),
    ],
)
def test_what_must_be_positive_is_named(change: Change, words: str) -> None:
    content = single("100")
    change(content)
    assert reason(signed(content)).endswith(f"(A2): {words}")


def test_a_parameter_is_a_positive_number_or_a_pair_of_them() -> None:
    assert kernel.interval("2.50") == (Fraction(5, 2), Fraction(5, 2))
    assert kernel.interval(["2", "3"]) == (2, 3)
    assert kernel.interval(["2", "2"]) == (2, 2)
    for false in ("0", "-1", ["0", "1"], ["-1", "1"], ["3", "2"]):
        with pytest.raises(kernel.FalseError, match=r"^\(A2\): "):
            kernel.interval(false)
    for unreadable in (["1"], ["1", "2", "3"], [], None, True, {"low": "1"}):
        with pytest.raises(kernel.UnreadableError):
            kernel.interval(unreadable)


@pytest.mark.parametrize(
    ("text", "value"), [("0", "0"), ("-0.5", "-1/2"), ("-12", "-12"), ("10.050", "201/20"), ("0.001", "1/1000")]
)
def test_decimals_are_read_exactly(text: str, value: str) -> None:
    assert kernel.number(text) == Fraction(value)


@pytest.mark.parametrize(
    "text", ["", "-", ".5", "5.", "05", "00", "+1", "1e3", "1,5", "0x1", "1/2", "--1", "1.2.3", "1\n"]
)
def test_what_is_no_decimal_is_refused(text: str) -> None:
    with pytest.raises(kernel.UnreadableError, match="is not a decimal number of at most 130 characters"):
        kernel.number(text)


def test_psi_is_read_as_it_stands() -> None:
    common = {"mean": "-0.5", "frequency": "2"}
    square = kernel.read_psi({"family": "square-wave", "terms": 3, **common})
    waves = [(1, Fraction(4), 0), (3, Fraction(4, 3), 0), (5, Fraction(4, 5), 0)]
    assert square == (Fraction(-1, 2), Fraction(2), True, waves)
    one = kernel.read_psi({"family": "square-wave", "terms": 1, **common})
    assert one.terms == waves[:1]
    for sin, cos in ((["1", "0", "0", "3"], ["0", "0.5"]), (["1"], ["0", "0.5", "0", "0"]), ([], [])):
        mean, frequency, over_pi, terms = kernel.read_psi({"family": "harmonics", "sin": sin, "cos": cos, **common})
        assert (mean, frequency, over_pi) == (Fraction(-1, 2), 2, False)
        found = {n: (s, c) for n, s, c in terms}
        for n in range(1, 5):
            own = tuple(Fraction(q[n - 1]) if n <= len(q) else Fraction(0) for q in (sin, cos))
            assert found.get(n, (0, 0)) == own
        assert (0, 0) not in found.values()
    for terms in (0, -1, True, "3", 1.0):
        with pytest.raises(kernel.UnreadableError):
            kernel.read_psi({"family": "square-wave", "terms": terms, **common})
    with pytest.raises(kernel.FalseError, match="frequency must be > 0"):
        kernel.read_psi({"family": "square-wave", "terms": 1, **common, "frequency": "0"})
    for wrong in ({"family": "noise"}, {"sin": 5}, {"cos": "12"}, {"sin": {"1": "1"}}):
        with pytest.raises(kernel.UnreadableError):
            kernel.read_psi({"family": "harmonics", "sin": [], "cos": [], **common, **wrong})


@pytest.mark.parametrize(("p", "q"), [(0, 1), (1, 1), (-1, 1), (1, 2), (-3, 7), (5, 3)])
def test_harmonic_sums_are_those_of_sines_and_cosines(p: int, q: int) -> None:
    terms = {1: (3, -2), 2: (0, 5), 5: (-7, 1)}
    numerator, denominator = kernel.harmonic_sum(terms, p, q)
    assert denominator == (p * p + q * q) ** 5
    with mp.workdps(40):
        x = 2 * mp.atan(mp.mpf(p) / q)
        true = sum(s * mp.sin(n * x) + c * mp.cos(n * x) for n, (s, c) in terms.items())
        assert mp.almosteq(mp.mpf(numerator) / denominator, true, 1e-35, 1e-35)


def test_degrees_count_every_edge_at_both_ends_and_the_leader() -> None:
    claims = kernel.read_claims(document("mixed_ring"))
    edges = [(i, (i + 1) % 10, Fraction(1 + i % 3) + Fraction(1, 2)) for i in range(10)]
    assert claims.edges == edges and claims.led == {0: 2, 5: Fraction(1, 4), 7: 0}
    for i, vehicle in enumerate(claims.vehicles):
        assert vehicle.degree == claims.led.get(i, 0) + sum(w for a, b, w in edges if i in (a, b))


@pytest.mark.parametrize(("drive", "arm"), [("paper", 2), ("physical", 1)])
def test_the_arm_is_that_of_the_drive(drive: str, arm: int) -> None:
    content = single("6")
    content["fleet"]["drive"] = drive
    assert kernel.read_claims(content).vehicles[0].arm == arm


@pytest.mark.parametrize(
    "change",
    [
        lambda c: c.update(schema="gaincert-certificate-2"),
        lambda c: c.update(conditions=["corrected"]),
        lambda c: c.update(conditions="(16*)"),
        lambda c: c.update(designed=[]),
        lambda c: c.update(designed={"vehicle": []}),
        lambda c: c["fleet"].update(drive="other"),
        lambda c: c["fleet"].update(drive=["paper"]),
        lambda c: c["fleet"].update(vehicle=[]),
        lambda c: c["fleet"].update(vehicle=5),
        lambda c: c["fleet"]["vehicle"].append(1),
        lambda c: c["fleet"]["graph"].update(edges=5),
        lambda c: c.update(forest=5),
        lambda c: c["fleet"].update(vehicle=[1]),
        lambda c: c["fleet"]["vehicle"][0].update(name=1),
        lambda c: c["fleet"]["vehicle"][0].update(more="1"),
        lambda c: c["fleet"]["vehicle"][0].update(offset=["0"]),
        lambda c: c["fleet"]["vehicle"][0].update(offset=["0", "x"]),
        lambda c: c["fleet"]["graph"].update(edges=[["one", 2, "1"]]),
        lambda c: c["fleet"]["graph"].update(edges=[["one", "1"]]),
        lambda c: c["gains"].update(p_v=["1", "1"]),
        lambda c: c["gains"].pop("p_v"),
        lambda c: c.update(forest=[[0]]),
        lambda c: c.update(forest=[["0", -1]]),
        lambda c: c.update(forest=[[0, None]]),
        lambda c: c.update(forest=[[False, -1]]),
        lambda c: c.update(rates={}),
        lambda c: c["rates"].update(gamma_v={"rate": "1"}),
        lambda c: c["rates"].update(gamma_v={"rate": "0.1", "vector": [1, 1]}),
        lambda c: c.update(margins={"(16*)": ["0", "0"]}),
        lambda c: c.update(margins={}),
        lambda c: c.update(more=1),
        lambda c: c.pop("provenance"),
    ],
)
def test_a_document_of_another_form_is_refused(change: Change) -> None:
    content = single("6")
    change(content)
    assert "\n" not in str(refusal(signed(content)))


def test_every_vehicle_needs_a_name() -> None:
    content = single("6")
    content["fleet"]["vehicle"].append({**content["fleet"]["vehicle"][0], "name": 7})
    content["gains"] = {name: 2 * values for name, values in content["gains"].items()}
    assert "every vehicle needs a name" in str(refusal(signed(content)))


@pytest.mark.parametrize("conditions", kernel.SETS)
def test_each_set_requires_its_own_conditions(conditions: str) -> None:
    required = {"paper": ["(15)", "(16)"], "corrected": ["(16*)"], "rate-bounded": ["(15')", "(16*)"]}[conditions]
    content = single("100", conditions=conditions, margins={name: ["0"] for name in required})
    content["gains"]["d_omega"] = ["5"]
    assert kernel.check(json.dumps(content)).valid
    for name in required:
        content["margins"].pop(name)
        assert f"expected a table with the keys {', '.join(required)}" in str(refusal(content))
        content["margins"][name] = ["0"]


def test_a_certificate_is_given_as_text_or_as_a_file(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(TEXT)
    for source in (TEXT, f" \n{TEXT}", str(path), path):
        assert kernel.check(source).valid
    with pytest.raises(kernel.UnreadableError, match="not JSON"):
        kernel.check('{"\ud800": 1}')
    for source in (tmp_path, str(tmp_path / "absent"), "a\0b"):
        with pytest.raises(kernel.UnreadableError, match="cannot be read"):
            kernel.check(source)


def turned(value: Any) -> Any:
    """The same tables with their keys in the other order."""
    if isinstance(value, dict):
        return {key: turned(value[key]) for key in reversed(value)}
    return [turned(entry) for entry in value] if isinstance(value, list) else value


@pytest.mark.parametrize("name", CASES)
def test_the_order_of_keys_does_not_count(name: str) -> None:
    content = document(name)
    assert json.dumps(turned(content)) != json.dumps(content)
    assert kernel.check(json.dumps(turned(content))) == kernel.check(json.dumps(content))


def test_the_digest_is_of_ascii_text() -> None:
    content = single("6")
    content["fleet"]["vehicle"][0]["name"] = "größe"
    content["fleet"]["graph"]["leader_links"] = {"größe": "1"}
    assert kernel.check(json.dumps(signed(content))).valid


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


@pytest.mark.parametrize(
    ("limit", "value"),
    [
        ("SCHEMA", "gaincert-certificate-1"),
        ("MAX_BYTES", 2**30),
        ("MAX_VALUES", 64 * 10**6),
        ("MAX_LENGTH", 130),
        ("MAX_HARMONIC", 200),
    ],
)
def test_the_limits_are_those_of_the_documentation(limit: str, value: Any) -> None:
    assert getattr(kernel, limit) == value


def test_a_file_of_just_the_largest_size_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = TEXT.encode()
    path = tmp_path / "certificate.json"
    path.write_bytes(data)
    values = sum(data.count(mark) for mark in (b",", b"[", b"{"))
    for limit, size in (("MAX_BYTES", len(data)), ("MAX_VALUES", values)):
        monkeypatch.setattr(kernel, limit, size)
        assert kernel.check_data(data).valid and kernel.check(path).valid
        monkeypatch.setattr(kernel, limit, size - 1)
        for read in (lambda: kernel.check_data(data), lambda: kernel.check(path)):
            with pytest.raises(kernel.UnreadableError, match="larger"):
                read()
        monkeypatch.undo()


@pytest.mark.parametrize("digits", [129, 130, 131])
def test_numbers_have_at_most_130_characters(digits: int) -> None:
    whole, places = "1" * digits, "1." + "1" * (digits - 2)
    if digits <= 130:
        assert kernel.number(whole) == kernel.load(whole.encode()) == int(whole)
        assert kernel.number(places) == Fraction(int("1" * (digits - 1)), 10 ** (digits - 2))
        return
    for refused in (lambda: kernel.number(whole), lambda: kernel.number(places), lambda: kernel.load(whole.encode())):
        with pytest.raises(kernel.UnreadableError):
            refused()


@pytest.mark.parametrize("harmonics", [199, 200, 201])
def test_psi_has_at_most_200_harmonics(harmonics: int) -> None:
    table = {"family": "harmonics", "mean": "0", "frequency": "1", "cos": []}
    square = {"family": "square-wave", "mean": "0", "frequency": "1", "terms": (harmonics + 1) // 2}
    for excitation in ({**table, "sin": ["0"] * (harmonics - 1) + ["1"]}, square):
        if harmonics <= 200:
            assert max(n for n, _, _ in kernel.read_psi(excitation).terms) in (harmonics, harmonics - 1)
        else:
            with pytest.raises(kernel.UnreadableError, match="excitation: "):
                kernel.read_psi(excitation)


def test_a_machine_without_memory_refuses(monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(_: Any) -> Any:
        raise MemoryError

    monkeypatch.setattr(kernel, "read_claims", exhausted)
    with pytest.raises(kernel.UnreadableError, match="memory"):
        kernel.check(TEXT)


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


def test_its_exit_code_is_its_verdict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, content = tmp_path / "certificate.json", document()
    path.write_text(TEXT)
    for arguments, code, said, refused in (
        ([str(path)], 0, "VALID\n6 vehicles", ""),
        ([str(path), content["digest"]], 0, "VALID\n6 vehicles", ""),
        ([str(path), "sha256:0"], 1, "INVALID: same_fleet: the certificate is of the fleet sha256:", ""),
        ([str(tmp_path / "absent")], 2, "", "REFUSED: "),
        ([TEXT], 2, "", "REFUSED: "),  # the name of a file, whatever it begins with
        ([], 2, "", "usage: "),
        ([str(path), content["digest"], "more"], 2, "", "usage: "),
    ):
        assert kernel.main(arguments) == code
        out, err = capsys.readouterr()
        assert out.startswith(said) and bool(out) == bool(said)
        assert err.startswith(refused) and bool(err) == bool(refused)


@pytest.mark.parametrize("collecting", [True, False])
def test_garbage_is_collected_again_afterwards(collecting: bool) -> None:
    """As before, also where the kernel refuses the file."""
    try:
        (gc.enable if collecting else gc.disable)()
        with kernel.no_collections():
            assert not gc.isenabled()
        with pytest.raises(kernel.UnreadableError):
            kernel.check_data(b"{")
        assert gc.isenabled() == collecting
    finally:
        gc.enable()
