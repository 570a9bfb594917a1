"""The drive wheels found by geometry: two continuous joints on one horizontal axis that reach the floor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from ...arrays import Array
from .rolling import Wheel, axis_of, parallel, wheel_at
from .tree import Joint, Tree
from .wheels import SIDE_SPREAD, UP, DriveWheels, Ignored

MAX_WHEELS = 64  # joints that may be wheels
FLOOR = 0.25  # share of a wheel's radius by which it may hang above the floor
_Pair = tuple[Wheel, Wheel]


def found_wheels(tree: Tree) -> DriveWheels:
    """The wheels found by geometry. Raises ValueError if that fails; its message says how to name them."""
    wheels = list(_candidates(tree, ("continuous", "revolute")))
    if len(wheels) > MAX_WHEELS:
        raise ValueError(f"has {len(wheels)} joints that may be wheels; name the drive wheels: {_how([], [])}")
    steady = [wheel for wheel in wheels if wheel.swivel is None]
    facing = [pair for pair in combinations(steady, 2) if pair[0].faces(pair[1])]
    pairs = _on_the_floor(facing)
    if len(pairs) != 1:
        raise ValueError(_several(tree, pairs) if pairs else _none(tree))
    (pair,) = pairs
    for wheel in pair:
        if wheel.joint.kind != "continuous":
            raise ValueError(_wrong_kind(pair))
    if steered := next((wheel for wheel in wheels if _is_steered(tree, wheel, pair)), None):
        swivel = steered.swivel.name if steered.swivel else ""
        raise ValueError(
            f"joint {swivel!r} steers the wheel of joint {steered.joint.name!r}: not a differential drive. A caster's "
            f"swivel has the type 'continuous'; correct it or name the drive wheels: {_how(*_sides(tree, [pair]))}"
        )
    left, right = _sides(tree, [pair])
    if not _forward_known(tree, pair):
        raise ValueError(
            f"the axle of joints {pair[0].joint.name!r} and {pair[1].joint.name!r} lies along the base's x axis, so "
            f"that it is open which way is ahead; {_either(left, right)}"
        )
    return DriveWheels(tuple(left), tuple(right), tuple(_others(tree, pair, facing)))


def _candidates(tree: Tree, kinds: Sequence[str]) -> Iterator[Wheel]:
    """Wheels at continuous joints, and at other joints of these kinds that carry a cylinder or sphere."""
    for joint in tree.joints:
        if joint.kind in kinds:
            wheel = wheel_at(tree, joint)
            if wheel and (joint.kind == "continuous" or wheel.radius):
                yield wheel


def _on_the_floor(pairs: list[_Pair]) -> list[_Pair]:
    """The pairs that reach the floor, or may because their radius is unknown."""
    lowest = min((wheel.bottom for pair in pairs for wheel in pair if wheel.bottom is not None), default=0.0)
    return [pair for pair in pairs if any(_reaches(wheel, lowest) for wheel in pair)]


def _reaches(wheel: Wheel, floor: float) -> bool:
    return wheel.radius is None or float(wheel.centre[2]) <= floor + (1 + FLOOR) * float(wheel.radius.value)


def _is_steered(tree: Tree, wheel: Wheel, pair: _Pair) -> bool:
    """Whether a joint with end stops and a vertical axis turns a wheel that reaches the floor, as in a car."""
    floor = min((other.bottom for other in pair if other.bottom is not None), default=None)
    return (
        wheel.swivel is not None
        and wheel.swivel.kind == "revolute"
        and parallel(axis_of(tree, wheel.swivel), UP)
        and wheel.bottom is not None
        and floor is not None
        and _reaches(wheel, floor)
    )


def _others(tree: Tree, pair: _Pair, facing: list[_Pair]) -> Iterator[Ignored]:
    """The other continuous joints, each with the reason why it is no drive wheel."""
    mirrored = {wheel.joint.name for other in facing for wheel in other}
    for joint in tree.joints:
        if joint.kind == "continuous" and joint not in (pair[0].joint, pair[1].joint):
            wheel = wheel_at(tree, joint)
            if wheel is None:
                yield Ignored(joint.name, "its axis is not horizontal")
            elif wheel.swivel:
                yield Ignored(joint.name, f"joint {wheel.swivel.name!r} above it turns its axis")
            elif joint.name in mirrored:
                yield Ignored(joint.name, "it does not reach the floor")
            else:
                yield Ignored(joint.name, "no other wheel turns about the same axis")


def _forward_known(tree: Tree, pair: _Pair) -> bool:
    across = pair[0].centre - pair[1].centre
    return abs(float(_towards_left(tree, pair) @ across)) > 0.5 * float(np.linalg.norm(across))


def _towards_left(tree: Tree, pair: _Pair) -> Array:
    """The y axis of the link that carries the wheels: ahead is its x axis (ROS REP 103)."""
    return tree.frames[tree.carrier([wheel.joint.child for wheel in pair])].turn[:, 1]


def _sides(tree: Tree, pairs: list[_Pair]) -> tuple[list[Wheel], list[Wheel]]:
    """The wheels of the pairs, left and right; by the carrying link's y axis."""
    left, right = [], []
    for pair in pairs:
        first = (pair[0].centre - pair[1].centre) @ _towards_left(tree, pair) >= 0
        left.append(pair[0] if first else pair[1])
        right.append(pair[1] if first else pair[0])
    return left, right


# -- messages ---------------------------------------------------------------------------------------------------------


def _how(left: Sequence[Wheel], right: Sequence[Wheel]) -> str:
    """The fleet file's line that names the wheels."""

    def names(side: Sequence[Wheel]) -> str:
        return ", ".join(f'"{wheel.joint.name}"' for wheel in side) or '"..."'

    return f'urdf = {{ file = "...", left_wheels = [{names(left)}], right_wheels = [{names(right)}] }}'


def _either(left: Sequence[Wheel], right: Sequence[Wheel]) -> str:
    return f"say which side is left: {_how(left, right)}, or the other way round"


def _several(tree: Tree, pairs: list[_Pair]) -> str:
    wheels = {wheel.joint.name: wheel for pair in pairs for wheel in pair}
    if len(wheels) == 2 * len(pairs) and all(wheel.joint.kind == "continuous" for wheel in wheels.values()):
        left, right = _sides(tree, pairs)
        lateral = [abs(float((wheel.centre - left[0].centre) @ left[0].axle)) for wheel in left]
        track = float(np.linalg.norm(pairs[0][0].centre - pairs[0][1].centre))
        if max(lateral) <= SIDE_SPREAD * track:
            remedy = f"name them: {_how(left, right)}" if _forward_known(tree, pairs[0]) else _either(left, right)
            return f"has {len(left)} driven wheels a side (skid steer); {remedy}"
    described = "; ".join(_described(pair) for pair in pairs[:4])
    return f"has {len(pairs)} pairs that may be the drive wheels: {described}; name the drive wheels: {_how([], [])}"


def _described(pair: _Pair) -> str:
    sizes = {f"{float(wheel.radius.value):g} m" if wheel.radius else "not known" for wheel in pair}
    kinds = {wheel.joint.kind for wheel in pair}
    return (
        f"{pair[0].joint.name!r} and {pair[1].joint.name!r} (type {' and '.join(sorted(kinds))}, "
        f"radius {' and '.join(sorted(sizes))})"
    )


def _wrong_kind(pair: _Pair) -> str:
    names = " and ".join(repr(wheel.joint.name) for wheel in pair)
    kinds = " and ".join(sorted({repr(wheel.joint.kind) for wheel in pair}))
    return f"joints {names} look like the drive wheels and have the type {kinds}; a drive wheel has type 'continuous'"


def _none(tree: Tree) -> str:
    fixed = list(_candidates(tree, ("fixed",)))[:MAX_WHEELS]
    if pair := next((pair for pair in combinations(fixed, 2) if pair[0].faces(pair[1])), None):
        return _wrong_kind(pair)
    turning: list[Joint] = [joint for joint in tree.joints if joint.kind == "continuous"]
    names = ", ".join(repr(joint.name) for joint in turning[:6]) or "none"
    return (
        "has no drive wheels: two continuous joints on one horizontal axis that no joint swivels (continuous joints: "
        f"{names}); correct the joints or name the wheels: {_how([], [])}"
    )
