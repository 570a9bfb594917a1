"""Certificates: built from fleet, gains and psi, checked by `kernel.py`, written as JSON and read back."""

from __future__ import annotations

import json
import platform
from dataclasses import dataclass
from fractions import Fraction
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from ...models.arrays import Array, column, floats
from ...models.conditions import ConditionData, Inequality, condition_set, exact_numbers
from ...models.digests import gains_digest
from ...models.errors import InputError
from ...models.excitation import Excitation
from ...models.files.text import read_text, write_text
from ...models.fleet import Fleet, digest_of
from ...models.fleet_tables import Links
from ...models.gains import GAIN_NAMES, Gains
from ...models.numbers import Interval, decimal_text, high, low
from .. import kernel
from . import witnesses as witness
from .remarks import notes_of
from .repair import Violation, asked_for, violations

MARGIN_DIGITS = 6
NO_RATES = {"gamma_omega": None, "gamma_v": None}
READABLE = 50  # vehicles up to which the JSON is indented


@dataclass(frozen=True, eq=False)
class Certificate:
    """What `gaincert certify` found: a file for the kernel where all holds, a diagnosis where it does not."""

    content: dict[str, Any]  # the JSON document; docs/certificate.md
    verdict: kernel.Verdict  # the kernel's word on that document
    margins: dict[str, Array]  # condition: (N,) margin, at most 1e-6 of it below the truth; None where not asked for
    violations: tuple[Violation, ...] = ()
    notes: tuple[str, ...] = ()  # facts of interest that the certificate does not claim

    @property
    def valid(self) -> bool:
        """Whether the kernel accepts the document."""
        return self.verdict.valid

    @property
    def facts(self) -> tuple[str, ...]:
        """What the certificate proves, in sentences."""
        return self.verdict.theorem

    @property
    def gains(self) -> Gains:
        """The certified gains, exact."""
        return Gains(*(column(map(Fraction, self.content["gains"][name])) for name in GAIN_NAMES))

    def to_json(self) -> str:
        """The document as JSON text."""
        return _text(self.content)

    def write(self, path: str | Path) -> None:
        """Write the document, whole or not at all. Raises InputError where it is not valid: such a file would lie."""
        if not self.valid:
            raise InputError(*(map(str, self.violations) if self.violations else [str(self.verdict)]))
        write_text(Path(path), self.to_json() + "\n")

    @classmethod
    def read(cls, path: str | Path, fleet: Fleet | None = None) -> Certificate:
        """The certificate in a file, checked by the kernel, against a fleet where one is given. Raises InputError."""
        data = read_text(Path(path), kernel.MAX_BYTES).encode()  # once: what was checked is what is used
        verdict = _checked(data, path, fleet)
        content = kernel.load(data)
        stated = content["margins"] if verdict.valid else {}
        return cls(content, verdict, {name: column(map(_number, entries)) for name, entries in stated.items()})


@kernel.no_collections()
def certify(
    fleet: Fleet,
    excitation: Excitation,
    gains: Gains,
    conditions: str,
    *,
    links: Links | None = None,
    seed: int | None = None,
) -> Certificate:
    """The certificate of these gains for a fleet, with psi and, where they were designed, the links that are used.

    Gains are exact decimals (`Fraction`s). Where a condition is broken the result is not valid and says how to repair
    it. Raises InputError for gains that are not decimals > 0, one per vehicle.
    """
    gain_texts = _gain_texts(fleet, gains)
    chosen = condition_set(conditions)
    used = fleet.with_links(links)
    limits = used.condition_data(excitation)
    found = chosen.inequalities(exact_numbers(), limits, gains)
    broken = violations(fleet.names, chosen, limits, gains, found)
    notes = notes_of(used, limits, gains, conditions)
    margins = {sides.source: _margins(sides, limits) for sides in found}
    own = fleet.content()
    content: dict[str, Any] = {
        "schema": kernel.SCHEMA,
        "conditions": conditions,
        "digest": digest_of(own),
        "fleet": own,
        "designed": _designed(fleet, excitation, links),
        "gains": gain_texts,
        "psi_bar": decimal_text(limits.psi_bar),
        "psi_point": _texts(witness.psi_point(excitation)),
        "psi_power": decimal_text(witness.psi_power(excitation)),
        "forest": witness.forest(used.graph),
        "margins": {name: [_stated(margin) for margin in entries] for name, entries in margins.items()},
        "rates": NO_RATES if broken else _rates(used, gains),
        "provenance": {
            "seed": seed,
            "gains_digest": gains_digest(used, excitation, gains),
            "versions": _versions(),
            "notes": notes,
        },
    }
    verdict = kernel.Verdict(False, "conditions", str(broken[0])) if broken else _self_check(content)
    if verdict.rule == "rates":  # rates are welcome, not needed: the rounding of a float must not cost the rest
        content["rates"] = NO_RATES
        verdict = _self_check(content)
    return Certificate(content, verdict, margins, tuple(broken), tuple(notes))


def _self_check(content: dict[str, Any]) -> kernel.Verdict:
    """The kernel's verdict on what is to be written. Raises InputError where it has numbers that it does not read."""
    try:
        return kernel.check(_text(content))
    except kernel.UnreadableError as error:
        raise InputError(f"certificate: the kernel refused it: {error}; use numbers of moderate size") from None


def _checked(data: bytes, path: str | Path, fleet: Fleet | None) -> kernel.Verdict:
    try:
        return kernel.check_data(data, fleet.digest if fleet else None)
    except kernel.UnreadableError as error:
        raise InputError(f"{path}: {error}; give a certificate.json that gaincert certify wrote") from None


def verify(path: str | Path, fleet: Fleet | None = None) -> kernel.Verdict:
    """The kernel's verdict on a certificate file, and that it is of this fleet. Raises InputError if unreadable."""
    try:
        return kernel.check(Path(path), fleet.digest if fleet else None)
    except kernel.UnreadableError as error:
        raise InputError(f"{path}: {error}; give a certificate.json that gaincert certify wrote") from None


def same_fleet(certificate: Certificate, fleet: Fleet) -> bool:
    """Whether a certificate speaks of this fleet, by digest."""
    return bool(certificate.content["digest"] == fleet.digest)


def excitation_table(psi: Excitation) -> dict[str, Any]:
    """psi as the table of a fleet file that gives it. Raises InputError where none does that the kernel reads."""
    if psi.terms is None and psi.over_pi:
        raise InputError("excitation: its coefficients carry 1/pi and no table of a fleet file says so; use decimals")
    for number in (psi.mean, psi.frequency, *psi.sin, *psi.cos) if psi.terms is None else ():
        _decimal(number, "excitation: a coefficient")
    return psi.table()


def _decimal(number: Any, name: str) -> str:
    """The decimal text of a number. Raises InputError where there is none, or none that the kernel reads."""
    try:
        text = decimal_text(Fraction(number))
    except ValueError:
        raise InputError(f"{name} = {number} is no decimal number; round it") from None
    if len(text) > kernel.MAX_LENGTH:
        raise InputError(f"{name} = {text[:20]}... has more than {kernel.MAX_LENGTH} digits; round it")
    return text


def _text(content: dict[str, Any]) -> str:
    small = len(content["fleet"]["vehicle"]) <= READABLE
    return json.dumps(content, indent=1 if small else None, separators=None if small else (",", ":"))


def _texts(point: dict[str, Any]) -> dict[str, Any]:
    return {key: decimal_text(value) if isinstance(value, Fraction) else value for key, value in point.items()}


def _gain_texts(fleet: Fleet, gains: Gains) -> dict[str, list[str]]:
    """The gains as decimal texts. Raises InputError where they are not decimals > 0, one per vehicle."""
    texts = {}
    for name in GAIN_NAMES:
        values = getattr(gains, name)
        if len(values) != len(fleet):
            raise InputError(f"gains: {name} has {len(values)} entries for {len(fleet)} vehicles; give one per vehicle")
        labels = [f"gains: {name} of vehicle {vehicle!r}" for vehicle in fleet.names]
        texts[name] = [_decimal(value, label) for label, value in zip(labels, values, strict=True)]
        for label, value in zip(labels, values, strict=True):
            if not value > 0:
                raise InputError(f"{label} = {decimal_text(Fraction(value))} must be > 0 (A2)")
    return texts


def _designed(fleet: Fleet, excitation: Excitation, links: Links | None) -> dict[str, Any]:
    """What is used in place of what the fleet file says: psi, links or neither."""
    designed = {}
    if fleet.psi != excitation:
        designed["excitation"] = excitation_table(excitation)
    if links is not None and links != fleet.links:
        designed["graph"] = links.model_dump(mode="json")
    return designed


def _margins(sides: Inequality, limits: ConditionData) -> Array:
    """Margins rounded down to a few digits; None where the condition does not concern a vehicle."""
    concerned = asked_for(sides, limits)
    return column(
        (witness.rounded(Fraction(margin), MARGIN_DIGITS) if asked else None)
        for margin, asked in zip(sides.margin, concerned, strict=True)
    )


def _number(text: str | None) -> Fraction | None:
    return None if text is None else Fraction(text)


def _stated(margin: Fraction | None) -> str | None:
    """A margin as the kernel wants it; within the 1e-40 to which roots are enclosed, the kernel decides by squares."""
    return None if margin is None else decimal_text(max(margin, Fraction(0)))


def _rates(fleet: Fleet, gains: Gains) -> dict[str, Any]:
    """Both rates with their witnesses, null where none was found."""
    # As in the kernel: a mismatch of r or R between controller and vehicle acts as a change of mass and inertia.
    in_r = [_mismatch(v.wheel_radius) for v in fleet.vehicles]
    turning = [a * _mismatch(v.half_track) for a, v in zip(in_r, fleet.vehicles, strict=True)]
    number = gains.map(floats)
    inertia = _extremes([v.inertia for v in fleet.vehicles], turning)
    mass = _extremes([v.mass for v in fleet.vehicles], in_r)
    found = {
        "gamma_omega": witness.rate(fleet.graph, inertia, number.p_omega, number.d_omega),
        "gamma_v": witness.rate(fleet.graph, mass, number.p_v, number.d_v),
    }
    return {name: rate and {"rate": decimal_text(rate[0]), "vector": rate[1]} for name, rate in found.items()}


def _mismatch(parameter: Fraction | Interval) -> float:
    return float(parameter.high / parameter.low) if isinstance(parameter, Interval) else 1.0


def _extremes(parameters: list[Fraction | Interval], mismatch: list[float]) -> tuple[Array, Array]:
    pairs = list(zip(parameters, mismatch, strict=True))
    return (
        np.array([float(low(parameter)) / ratio for parameter, ratio in pairs]),
        np.array([float(high(parameter)) * ratio for parameter, ratio in pairs]),
    )


def _versions() -> dict[str, str]:
    names = ("numpy", "scipy", "python-flint", "pydantic")
    from ... import __version__

    return {"gaincert": __version__, "python": platform.python_version(), **{name: version(name) for name in names}}
