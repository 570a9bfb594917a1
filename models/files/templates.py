"""Fleets that `gaincert init` writes."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from ..errors import InputError
from ..fleet import Fleet
from ..paper import paper_fleet
from .fleet_text import dumps

DEFAULT_VEHICLES = 6

# A small service robot, for all shapes.
_ROBOT = {"mass": 20, "inertia": "0.8", "half_track": "0.25", "wheel_radius": "0.08", "torque_limit": 12}
# ROBOTIS TurtleBot3 Burger: mass, yaw inertia about the axle's centre, half track and wheel radius as its URDF yields
# them (ROBOTIS-GIT/turtlebot3, turtlebot3_description/urdf/turtlebot3_burger.urdf); stall torque of the XL430-W250 at
# 11.1 V; top speed and turn rate by the maker's sheet.
_TURTLEBOT3 = {
    "mass": "1.00173292",
    "inertia": "0.00454313937",
    "half_track": "0.08",
    "wheel_radius": "0.033",
    "torque_limit": "1.4",
    "limits": {"speed": "0.22", "turn_rate": "2.84"},
}
_TURTLEBOT3_SOURCE = """\
# ROBOTIS TurtleBot3 Burger. mass, inertia (yaw, about the axle's centre), half_track and wheel_radius are what
# turtlebot3_description/urdf/turtlebot3_burger.urdf of ROBOTIS-GIT/turtlebot3 yields; torque_limit is the stall torque
# of its XL430-W250 wheel motors at 11.1 V; the limits are its maker's top speed and turn rate.
"""
_PSI_SOURCE = """\
# Tables 1 and 2 and Section 4 of the paper, with (2) as printed. psi belongs to the controller: it is left out here, so
# that the tool designs one. The paper's own psi is beside its gains in paper_gains.toml.
"""


def template_text(kind: str, vehicles: int | None = None) -> str:
    """The TOML text of a template: "paper", "turtlebot3" or one of SHAPES; `vehicles` is for all but the paper's."""
    if kind == "paper":
        if vehicles not in (None, 6):
            raise InputError(
                f"--vehicles {vehicles}: the paper's fleet has 6; use another --template, such as line or ring"
            )
        return _PSI_SOURCE + dumps(paper_fleet().model_copy(update={"excitation": None}))
    if kind == "turtlebot3":
        return _TURTLEBOT3_SOURCE + dumps(_line("turtlebot3 line", vehicles or 5, _TURTLEBOT3, Fraction(1, 2)))
    return dumps(SHAPES[kind](kind, vehicles or DEFAULT_VEHICLES, _ROBOT, Fraction(2)))


def _line(name: str, count: int, robot: dict[str, Any], spacing: Fraction) -> Fleet:
    """A column behind the leader's point; every vehicle is led, and weakly linked to the next two."""
    names = _names(count)
    edges = [[names[i], names[j], "0.2"] for i in range(count) for j in (i + 1, i + 2) if j < count]
    offsets = [(-spacing * i, Fraction(0)) for i in range(count)]
    starts = [(-spacing * i - 3 * spacing, spacing * (2 if i % 2 else -2)) for i in range(count)]
    return _fleet(name, names, edges, names, robot, offsets, starts)


def _ring(name: str, count: int, robot: dict[str, Any], spacing: Fraction) -> Fleet:
    """A circle around the leader's point, each vehicle linked to the next; every third one is led."""
    names = _names(count)
    edges = [[names[i], names[(i + 1) % count]] for i in range(count if count > 2 else count - 1)]
    radius = float(spacing) * max(count, 3) / (2 * math.pi)
    angles = [2 * math.pi * i / count for i in range(count)]
    offsets = [(_hundredths(radius * math.cos(a)), _hundredths(radius * math.sin(a))) for a in angles]
    starts = [(2 * x - 2 * spacing, 2 * y + spacing) for x, y in offsets]
    return _fleet(name, names, edges, names[::3], robot, offsets, starts)


def _star(name: str, count: int, robot: dict[str, Any], spacing: Fraction) -> Fleet:
    """One vehicle in the middle, which alone is led and to which all others, on a circle around it, are linked."""
    names = _names(count)
    edges = [[names[0], name] for name in names[1:]]
    radius = float(spacing) * max(1.0, (count - 1) / (2 * math.pi))
    angles = [2 * math.pi * i / max(1, count - 1) for i in range(count - 1)]
    around = [(_hundredths(radius * math.cos(a)), _hundredths(radius * math.sin(a))) for a in angles]
    offsets = [(Fraction(0), Fraction(0)), *around]
    starts = [(2 * x - 3 * spacing, 2 * y + spacing) for x, y in offsets]
    return _fleet(name, names, edges, names[:1], robot, offsets, starts)


def _grid(name: str, count: int, robot: dict[str, Any], spacing: Fraction) -> Fleet:
    """Rows as long as the grid is deep, each vehicle linked to those beside and behind it; the first row is led."""
    names, width = _names(count), math.ceil(math.sqrt(count))
    beside = [[names[i], names[i + 1]] for i in range(count - 1) if (i + 1) % width]
    behind = [[names[i], names[i + width]] for i in range(count - width)]
    offsets = [(-spacing * (i // width), spacing * (i % width) - spacing * (width - 1) / 2) for i in range(count)]
    starts = [(2 * x - 4 * spacing, 2 * y + spacing) for x, y in offsets]
    return _fleet(name, names, beside + behind, names[:width], robot, offsets, starts)


def _v(name: str, count: int, robot: dict[str, Any], spacing: Fraction) -> Fleet:
    """A V behind its first vehicle, which is led; on both sides each one is linked to the one before it."""
    names = _names(count)
    edges = [[names[max(0, i - 2)], names[i]] for i in range(1, count)]
    depth = [(i + 1) // 2 for i in range(count)]
    offsets = [(-spacing * d, spacing * (d if i % 2 else -d)) for i, d in enumerate(depth)]
    starts = [(2 * x - 3 * spacing, 2 * y + spacing) for x, y in offsets]
    return _fleet(name, names, edges, names[:1], robot, offsets, starts)


SHAPES: dict[str, Callable[[str, int, dict[str, Any], Fraction], Fleet]] = {
    "line": _line,
    "ring": _ring,
    "star": _star,
    "grid": _grid,
    "v": _v,
}


def _fleet(
    name: str,
    names: list[str],
    edges: list[list[str]],
    led: list[str],
    robot: dict[str, Any],
    offsets: list[tuple[Fraction, Fraction]],
    starts: list[tuple[Fraction, Fraction]],
) -> Fleet:
    vehicles = [
        {**robot, "name": own, "offset": offset, "start": {"position": start, "heading_deg": 30 * (i % 12)}}
        for i, (own, offset, start) in enumerate(zip(names, offsets, starts, strict=True))
    ]
    return Fleet.model_validate(
        {
            "name": name,
            "leader": {"position": [0, 0], "heading_deg": 0},
            "graph": {"edges": edges, "leader_links": dict.fromkeys(led, 1)},
            "vehicle": vehicles,
        }
    )


def _names(count: int) -> list[str]:
    return [f"v{i + 1}" for i in range(count)]


def _hundredths(value: float) -> Fraction:
    return Fraction(round(value * 100), 100)
