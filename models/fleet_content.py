"""What certificates and digests say of a fleet: columns of exact decimals, without names.

A column is one string of decimals with a space between, all with as many digits after the point as the longest needs.
Vehicles are referred to by their place in the fleet file, from 0. Links are sorted, so that their order and direction
in the file do not count.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from .errors import InputError
from .excitation import Excitation
from .fleet_tables import MotionLimits, Vehicle
from .graph import Graph
from .numbers import Interval, decimal_places, high, low

LIMITS = tuple(MotionLimits.model_fields)


def fixed_point(values: Iterable[Fraction | int]) -> str:
    """A column: the numbers in order, all with the same places. Raises ValueError for a number that is no decimal."""
    numbers = list(values)
    places = max(map(_places, {number.denominator for number in numbers}), default=0)
    unit = 10**places
    return scaled_text([number.numerator * (unit // number.denominator) for number in numbers], places)


def scaled_text(scaled: Iterable[int], places: int) -> str:
    """The column of the numbers scaled / 10^places."""
    return " ".join(map(str, scaled)) if places == 0 else " ".join([_text(number, places) for number in scaled])


def _places(denominator: int) -> int:
    places = decimal_places(denominator)
    if places is None:
        raise ValueError(f"a number with the denominator {denominator} is no decimal number")
    return places


def _text(scaled: int, places: int) -> str:
    if scaled < 0:
        return "-" + _text(-scaled, places)
    digits = str(scaled).rjust(places + 1, "0")
    return digits[:-places] + "." + digits[-places:]


def numbers_of(column: str) -> list[Fraction]:
    """The numbers of a column."""
    return [Fraction(text) for text in column.split(" ")] if column else []


def uncertain_column(parameters: Sequence[Fraction | Interval]) -> str | list[str]:
    """A column, or two of the least and the greatest values where one of the parameters is an interval."""
    least, most = [low(parameter) for parameter in parameters], [high(parameter) for parameter in parameters]
    return fixed_point(least) if least == most else [fixed_point(least), fixed_point(most)]


def excitation_content(psi: Excitation) -> dict[str, Any]:
    """Psi as a certificate states it. Raises InputError where its coefficients are no decimals."""
    try:
        common = {"mean": fixed_point([psi.mean]), "frequency": fixed_point([psi.frequency])}
        if psi.terms is not None:
            return {"family": "square-wave", **common, "terms": psi.terms}
        if not psi.over_pi:
            return {"family": "harmonics", **common, "sin": fixed_point(psi.sin), "cos": fixed_point(psi.cos)}
    except ValueError as error:
        raise InputError(f"excitation: {error}; round it") from None
    raise InputError(
        "excitation: its coefficients have a factor 1/pi, which no table of a fleet file can state; use decimals"
    )


def excitation_of(content: Mapping[str, Any]) -> Excitation:
    """The psi of `excitation_content`."""
    (mean,), (frequency,) = numbers_of(content["mean"]), numbers_of(content["frequency"])
    if content["family"] == "square-wave":
        return Excitation.square_wave(mean, content["terms"], frequency)
    return Excitation(mean, frequency, tuple(numbers_of(content["sin"])), tuple(numbers_of(content["cos"])))


def graph_content(graph: Graph) -> dict[str, dict[str, str]]:
    """The links with their weights: edges from the earlier to the later vehicle, and the links to the leader."""
    edges = sorted(
        (min(i, j), max(i, j), weight)
        for i, j, weight in zip(graph.tail.tolist(), graph.head.tolist(), graph.weight, strict=True)
    )
    led = [(i, weight) for i, weight in enumerate(graph.leader_weight) if weight]
    return {
        "edges": {
            "tail": " ".join([str(i) for i, _, _ in edges]),
            "head": " ".join([str(j) for _, j, _ in edges]),
            "weight": fixed_point(weight for _, _, weight in edges),
        },
        "leader_links": {
            "vehicle": " ".join([str(i) for i, _ in led]),
            "weight": fixed_point(weight for _, weight in led),
        },
    }


def limits_content(vehicles: Sequence[Vehicle]) -> dict[str, dict[str, str] | None]:
    """The limits that vehicles ask for: which vehicles, and what; None where no vehicle does."""
    content: dict[str, dict[str, str] | None] = dict.fromkeys(LIMITS)
    for name in LIMITS:
        asked = [(i, limit) for i, v in enumerate(vehicles) if (limit := getattr(v.limits, name)) is not None]
        if asked:
            vehicle, value = " ".join([str(i) for i, _ in asked]), fixed_point(limit for _, limit in asked)
            content[name] = {"vehicle": vehicle, "value": value}
    return content


def fleet_content(drive: str, vehicles: Sequence[Vehicle], graph: Graph, psi: Excitation | None) -> dict[str, Any]:
    """All that a certificate says of a fleet."""
    parameters: Mapping[str, Sequence[Any]] = {
        "mass": [v.mass for v in vehicles],
        "inertia": [v.inertia for v in vehicles],
        "half_track": [v.half_track for v in vehicles],
        "wheel_radius": [v.wheel_radius for v in vehicles],
        "wheel_inertia": [v.wheel_inertia for v in vehicles],
        "torque_left": [v.torque_limit.left for v in vehicles],
        "torque_right": [v.torque_limit.right for v in vehicles],
    }
    return {
        "drive": drive,
        "vehicles": len(vehicles),
        **{name: uncertain_column(values) for name, values in parameters.items()},
        "offset_x": fixed_point(v.offset[0] for v in vehicles),
        "offset_y": fixed_point(v.offset[1] for v in vehicles),
        "limits": limits_content(vehicles),
        **graph_content(graph),
        "excitation": None if psi is None else excitation_content(psi),
    }
