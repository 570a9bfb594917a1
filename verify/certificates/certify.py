"""Certificates from fleet, gains and psi: what is claimed, with witnesses, and the kernel's verdict on it."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

from ...models.conditions import condition_set
from ...models.digests import controller_digest
from ...models.errors import InputError
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.fleet_content import excitation_content, fixed_point
from ...models.fleet_tables import Links
from ...models.gain_checks import exact_gains
from ...models.gains import GAIN_NAMES, Gains
from ...models.numbers import decimal_places, decimal_text
from .. import kernel
from .arcs import arcs
from .certificate import Certificate, as_text, verify
from .margins import LIMITS, check_conditions
from .rates import NO_RATES, certified_rates
from .remarks import notes_of
from .repair import Violation, violations
from .tree import designed_weights, tree
from .wheel_speed import rim_speeds

LARGEST = 10**kernel.MAX_WHOLE

__all__ = ["Certificate", "certify", "verify"]


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

    Gains are decimal numbers, as `exact_gains` takes them. Where a condition is broken the result is not valid and says
    how to repair it. Raises InputError for gains that are not decimals > 0, one per vehicle, and for links that the
    fleet lacks.
    """
    content, broken = _content(fleet, excitation, exact_gains(gains, fleet.names), conditions, links)
    content["provenance"]["seed"] = seed
    verdict = kernel.Verdict(False, "conditions", str(broken[0])) if broken else _self_check(content)
    if verdict.rule == "rates":  # rates are welcome, not needed: the rounding of a float must not cost the rest
        content["rates"] = NO_RATES
        verdict = _self_check(content)
    return Certificate(content, verdict, tuple(broken), tuple(content["provenance"]["notes"]))


def _content(
    fleet: Fleet, excitation: Excitation, gains: Gains, conditions: str, links: Links | None
) -> tuple[dict[str, Any], list[Violation]]:
    """The document, and the conditions that are broken."""
    chosen, used = condition_set(conditions), fleet.with_links(links)
    gains_table = _gains_table(fleet, gains)
    data = used.condition_data(excitation)
    checked = check_conditions(chosen, data, gains)
    broken = violations(fleet.names, chosen, checked)
    own = fleet.content
    psi = excitation_content(excitation)
    designed = {
        "excitation": None if psi == own["excitation"] else psi,
        "weights": None if links is None or links == fleet.links else designed_weights(fleet.graph, used.graph),
    }
    psi_bar = decimal_text(data.psi_bar)
    content: dict[str, Any] = {
        "schema": kernel.SCHEMA,
        "conditions": conditions,
        "fleet": own,
        "designed": designed,
        "gains": gains_table,
        "psi_bar": psi_bar,
        "arcs": arcs(psi, psi_bar),
        "tree": tree(fleet.graph, used.graph),
        "margins": {LIMITS.get(source, source): stated.text for source, stated in checked.margins.items()},
        "rim_speed": "" if broken else rim_speeds(data, gains, checked),
        "rates": NO_RATES if broken else certified_rates(used, gains),
        "provenance": {
            "seed": None,
            "controller_digest": controller_digest(used, excitation, gains),
            "versions": _versions(),
            "notes": notes_of(used, data, gains, conditions),
        },
    }
    return content, broken


def _self_check(content: dict[str, Any]) -> kernel.Verdict:
    """The kernel's verdict on what is to be written. Raises InputError where it has numbers that it does not read."""
    try:
        return kernel.check_data(as_text(content).encode())
    except kernel.UnreadableError as error:
        raise InputError(f"certificate: the kernel refused it: {error}; use numbers of moderate size") from None


def _gains_table(fleet: Fleet, gains: Gains) -> dict[str, str]:
    """Gains and scales as columns. Raises InputError where they are not decimals > 0, one per vehicle."""
    scales = {f"{name}_scale": column for name, column in gains.saturation.columns(len(fleet)).items()}
    for name in ("position_scale", "heading_scale"):
        scales[name] = scales[name][:1]
    return {
        **{name: _column(fleet, name, getattr(gains, name)) for name in GAIN_NAMES},
        **{name: _column(fleet, name, column) for name, column in scales.items()},
    }


def _column(fleet: Fleet, name: str, values: Sequence[Any]) -> str:
    """A column of positive decimals. Raises InputError."""
    for vehicle, number in zip(fleet.names, values, strict=False):
        places = decimal_places(number.denominator)
        short = places is not None and places <= kernel.MAX_PLACES
        if short and number.numerator < LARGEST * number.denominator:
            continue
        label = f"gains: vehicle {vehicle!r}: {name}"
        if places is None:
            raise InputError(f"{label} = {number} is no decimal number; round it")
        raise InputError(
            f"{label} = {float(number):g} has more than {kernel.MAX_WHOLE} digits before or {kernel.MAX_PLACES} "
            "after the point; round it or use other units"
        )
    return fixed_point(values)


def _versions() -> dict[str, str]:
    names = ("numpy", "scipy", "python-flint", "pydantic")
    from ... import __version__

    return {"gaincert": __version__, "python": platform.python_version(), **{name: version(name) for name in names}}
