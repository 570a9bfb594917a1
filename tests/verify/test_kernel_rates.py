"""The kernel's rates: decided exactly, with the local gains and the effective masses."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from gaincert.models.fleet import Fleet
from gaincert.models.numbers import Interval
from gaincert.verify import kernel

from tests.campaigns.certified_fleets import CASES
from tests.verify.certificate_documents import Document, arcs, check, column, document, harmonics, reason, refusal

HAIR = Fraction(1, 10**30)
WHEELS = Interval(Fraction("0.001"), Fraction("0.002"))
WEIGHTS, LED = (Fraction(1, 2), Fraction(3, 4)), Fraction(2)
MASSES = [(Fraction(a), Fraction(b)) for a, b in (("1", "1.5"), ("0.5", "0.5"), ("2", "3"))]
VECTOR, ROWS = [8, 16, 20], (Fraction(12), Fraction(1), Fraction(3))  # L_l x of that line
GAMMA = Fraction("0.01")
SCALES = {"position_scale": "0.5", "heading_scale": "0.25"}
OWN = {"speed_scale": "2 4 5", "turn_rate_scale": "0.5 1.0 2.0"}


def pencil(damping: list[Fraction], name: str, vector: list[Any] = VECTOR) -> Document:
    """A line of three vehicles, led at its beginning, with p = 2, 3, 4 and the rate GAMMA."""
    fleet = {
        "drive": "physical",
        "vehicles": 3,
        **{
            key: [column(*(low for low, _ in MASSES)), column(*(high for _, high in MASSES))]
            for key in ("mass", "inertia")
        },
        **dict.fromkeys(("half_track", "wheel_radius"), "1 1 1"),
        **dict.fromkeys(("torque_left", "torque_right"), " ".join(["1" + "0" * 9] * 3)),
        **dict.fromkeys(("offset_x", "offset_y", "wheel_inertia"), "0 0 0"),
        "limits": dict.fromkeys(kernel.LIMITS),
        "edges": {"tail": "0 1", "head": "1 2", "weight": column(*WEIGHTS)},
        "leader_links": {"vehicle": "0", "weight": column(LED)},
        "excitation": harmonics("0.9"),
    }
    d_v, d_omega = (damping, ["1"] * 3) if name == "gamma_v" else (["1"] * 3, damping)
    gains = {"p_v": "2 3 4", "p_omega": "2 3 4", "k_alpha": "1 1 1", "d_v": column(*d_v), "d_omega": column(*d_omega)}
    stated = {"rate": column(GAMMA), "vector": " ".join(map(str, vector))}
    return {
        "schema": kernel.SCHEMA,
        "conditions": "corrected",
        "fleet": fleet,
        "designed": {"excitation": None, "weights": None},
        "gains": {**gains, **SCALES, **OWN},
        "psi_bar": "1",
        "arcs": arcs(2),
        "tree": {"link": "-1 0 1", "depth": "0 1 2"},
        "margins": {"(16*)": "0 0 0"},
        "rim_speed": "",
        "rates": {**dict.fromkeys(kernel.RATES), name: stated},
        "provenance": {},
    }


def scales(name: str, i: int) -> tuple[Fraction, Fraction]:
    """The scale of the network and that of vehicle i."""
    network, own = ("position_scale", "speed_scale") if name == "gamma_v" else ("heading_scale", "turn_rate_scale")
    return Fraction(SCALES[network]), Fraction(OWN[own].split()[i])


@pytest.mark.parametrize("name", kernel.RATES)
def test_a_rate_is_accepted_up_to_equality_in_every_row(name: str) -> None:
    """Damping that leaves each row of (K - gamma C + gamma^2 M) x at exactly 0: a hair more is too much."""
    d = []
    for i, (least, _) in enumerate(MASSES):
        network, s = scales(name, i)
        local = (i + 2) / network * ROWS[i] / (GAMMA * VECTOR[i]) + GAMMA * least  # d / s
        d.append(local * s)
    assert check(pencil(d, name)).valid
    for factor in (1000, 4 * 10**58):  # the longest numbers of a certificate have 60 digits
        assert check(pencil(d, name, [factor * entry for entry in VECTOR])).valid
    for i in range(3):
        more = [*d[:i], d[i] + HAIR, *d[i + 1 :]]
        assert (
            reason(pencil(more, name))
            == f"INVALID: rates: {name}: vehicle {i + 1}: (K - gamma C + gamma^2 M) x is negative"
        )


@pytest.mark.parametrize("name", kernel.RATES)
def test_a_rate_is_accepted_up_to_critical_damping(name: str) -> None:
    d = [2 * GAMMA * most * scales(name, i)[1] for i, (_, most) in enumerate(MASSES)]
    assert check(pencil(d, name)).valid
    for i in range(3):
        less = [*d[:i], d[i] - HAIR, *d[i + 1 :]]
        assert reason(pencil(less, name)) == f"INVALID: rates: {name}: vehicle {i + 1}: C >= 2 gamma M fails"


@pytest.mark.parametrize("entry", ["0", "-1", "1.5", "x"])
def test_the_vector_of_a_rate_has_positive_integers(entry: str) -> None:
    content = pencil([Fraction(1)] * 3, "gamma_v", [10, entry, 20])
    try:
        assert "gamma_v: all must be from 1 to" in reason(content)
    except kernel.UnreadableError as error:
        assert str(error).startswith("gamma_v: expected a string of 3 decimals")


def test_a_rate_is_stated_with_its_vector() -> None:
    content = pencil([Fraction(1)] * 3, "gamma_v")
    for stated, words in (
        ({"rate": "0.01"}, "expected a table with the keys rate, vector"),
        ({"rate": "0.01", "vector": "1 1"}, "expected a string of 3 decimals"),
        ([], "expected a table"),
    ):
        assert words in refusal({**content, "rates": {"gamma_omega": None, "gamma_v": stated}})
    assert "gamma_v: all must be > 0 (A2)" in reason(
        {**content, "rates": {"gamma_omega": None, "gamma_v": {"rate": "0", "vector": "1 1 1"}}}
    )
    assert "expected a table with the keys gamma_omega, gamma_v" in refusal({**content, "rates": {}})


@pytest.mark.parametrize("name", CASES)
def test_masses_are_those_of_the_models(name: str) -> None:
    """The least and the greatest effective mass and inertia, with mismatched radii and tracks and spinning wheels."""
    content = document(name)
    count = content["fleet"]["vehicles"]
    content["fleet"]["wheel_inertia"] = [column(*["0.001"] * count), column(*["0.002"] * count)]
    claims = kernel.read_claims(content)
    fleet = CASES[name]().fleet
    wheels = [v.model_copy(update={"wheel_inertia": WHEELS}) for v in fleet.vehicles]
    for mine, own in zip(wheels, claims.vehicles(range(count)), strict=True):
        least, below, most, over = kernel.effective_mass(own, claims.unit)
        assert (Fraction(least, below * claims.unit), Fraction(most, over * claims.unit)) == mine.mass_bounds()
        least, below, most, over = kernel.effective_inertia(own)
        bounds = Fraction(least, below * claims.unit), Fraction(most, over * claims.unit)
        assert bounds == mine.inertia_bounds(fleet.arm_factor)


def test_the_effective_mass_is_never_outside_its_bounds() -> None:
    """Every controller's r and R with every vehicle's r', R', J, m, I of the intervals; the bounds are attained."""
    fleet: Fleet = CASES["mixed_ring"]().fleet
    vehicle = next(v for v in fleet.vehicles if isinstance(v.wheel_radius, tuple)).model_copy(
        update={"wheel_inertia": WHEELS, "mass": Interval(Fraction(10), Fraction(11))}
    )
    masses, inertias = [], []
    ends = lambda q: q if isinstance(q, tuple) else (q,)  # noqa: E731
    for r in ends(vehicle.wheel_radius):
        for r_own in ends(vehicle.wheel_radius):
            for J in ends(vehicle.wheel_inertia):
                masses += [(m + 2 * J / r_own**2) * r_own / r for m in ends(vehicle.mass)]
                for R in ends(vehicle.half_track):
                    for R_own in ends(vehicle.half_track):
                        inertias += [
                            (inertia + 2 * J * (R_own / r_own) ** 2) * r_own / r * R / R_own
                            for inertia in ends(vehicle.inertia)
                        ]
    least, most = vehicle.mass_bounds()
    assert least <= min(masses) and max(masses) <= most
    least, most = vehicle.inertia_bounds(1)
    assert least <= min(inertias) and max(inertias) <= most
    assert float(most / max(inertias)) < 1.05 and float(min(inertias) / least) < 1.05


def test_rates_of_the_papers_fleet_are_below_the_spectral_abscissas() -> None:
    case = CASES["paper"]()
    stated = case.certificate.rates
    plant, local = case.fleet.plant(), case.gains.map(lambda q: np.asarray(q, dtype=float)).local()
    laplacian = plant.graph.composed_laplacian().toarray()
    for name, p, d, mass in (
        ("gamma_omega", local.p_omega, local.d_omega, plant.inertia),
        ("gamma_v", local.p_v, local.d_v, plant.m),
    ):
        linear = np.block([[np.zeros((6, 6)), np.eye(6)], [-(p / mass)[:, None] * laplacian, -np.diag(d / mass)]])
        abscissa = -np.linalg.eigvals(linear).real.max()
        rate = float(stated[name] or 0)
        assert abscissa * (1 - 1e-4) < rate <= abscissa * (1 + 1e-9)


def test_these_documents_are_valid_without_a_rate() -> None:
    content = pencil([Fraction(1)] * 3, "gamma_v")
    content["rates"] = dict.fromkeys(kernel.RATES)
    assert check(content).valid
