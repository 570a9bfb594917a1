"""The links and joints of a URDF as a tree, with the frame of every link when all joints are at zero."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ...arrays import Array
from ...errors import InputError
from ...numbers import exact

MAX_DEPTH = 100  # joints from the root to a link
_Read = TypeVar("_Read")


class Frame(NamedTuple):
    """A pose: the point x of the frame is `place + turn @ x` in the outer frame."""

    turn: Array  # (3, 3)
    place: Array  # (3,), m

    def then(self, inner: Frame) -> Frame:
        """The pose of a frame inside this one."""
        return Frame(self.turn @ inner.turn, self.place + self.turn @ inner.place)


ORIGIN = Frame(np.eye(3), np.zeros(3))
_X = np.array([1.0, 0.0, 0.0])  # default axis of a joint


@dataclass(frozen=True)
class Joint:
    """A joint; its frame is that of its child link."""

    name: str
    kind: str  # fixed, continuous, revolute, prismatic, ...
    parent: str
    child: str
    origin: Frame  # in the parent link
    axis: Array  # (3,), of length 1, in the joint's frame
    effort: Fraction | None  # N m for a joint that turns
    velocity: Fraction | None  # rad/s for a joint that turns


@dataclass(frozen=True)
class Tree:
    """A connected robot: one root link, and one joint above every other link."""

    links: dict[str, Any]  # name -> <link> element
    joints: tuple[Joint, ...]  # in file order
    frames: dict[str, Frame]  # of every link, in the root link's frame

    def above(self, link: str) -> list[Joint]:
        """The joints between a link and the root, the nearest first."""
        chain = []
        while link in self._above:
            chain.append(self._above[link])
            link = chain[-1].parent
        return chain

    @cached_property
    def _above(self) -> dict[str, Joint]:
        return {joint.child: joint for joint in self.joints}

    def rigid_with(self, link: str) -> set[str]:
        """The link and all links that fixed joints tie to it."""
        body, before = {link}, 0
        while len(body) > before:
            before = len(body)
            ends = [{joint.parent, joint.child} for joint in self.joints if joint.kind == "fixed"]
            body = body.union(*(pair for pair in ends if pair & body))
        return body

    def carrier(self, links: list[str]) -> str:
        """The lowest link above all of these."""
        chains = [[joint.parent for joint in self.above(link)] for link in links]
        return next(link for link in chains[0] if all(link in chain for chain in chains))


def read_tree(root: Any) -> Tree:
    """The links and joints of a <robot>. Raises InputError with a line for every mistake."""
    mistakes: list[str] = []
    names = list(_each(root.findall("link"), _link_name, mistakes))
    joints = tuple(_each(root.findall("joint"), _joint, mistakes))
    for what, counted in (("link", names), ("joint", [joint.name for joint in joints])):
        mistakes += [
            f"{what} {name!r} is listed {count} times; give each {what} a name of its own"
            for name, count in Counter(counted).items()
            if count > 1
        ]
    if mistakes or (mistakes := _loose_ends(names, joints)):
        raise InputError(*mistakes)
    links = dict(zip(names, root.findall("link"), strict=True))
    return Tree(links, joints, _frames(names, joints))


def _loose_ends(names: list[str], joints: tuple[Joint, ...]) -> list[str]:
    """The mistakes that keep links and joints from being one tree."""
    known = set(names)
    mistakes = [
        f"joint {joint.name!r}: its {role} link {link!r} is not in the file; add the link or correct the name"
        for joint in joints
        for role, link in (("parent", joint.parent), ("child", joint.child))
        if link not in known
    ]
    parents = Counter(joint.child for joint in joints)
    mistakes += [
        f"link {name!r} is the child of {count} joints; a link has one parent: remove the others"
        for name, count in parents.items()
        if count > 1
    ]
    return mistakes or _root_mistakes(names, [name for name in names if name not in parents])


def _root_mistakes(names: list[str], roots: list[str]) -> list[str]:
    if not names:
        return ["has no <link>; a robot description needs a base and its wheels"]
    if not roots:
        return [f"link {names[0]!r} and the joints above it form a loop; a robot has one root link"]
    if len(roots) > 1:
        shown = ", ".join(map(repr, roots[:6])) + (", ..." if len(roots) > 6 else "")
        return [f"links {shown} have no parent; one root is needed: join the others to it by fixed joints"]
    return []


def _frames(names: list[str], joints: tuple[Joint, ...]) -> dict[str, Frame]:
    children: dict[str, list[Joint]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint)
    below = {joint.child for joint in joints}
    level = {name: ORIGIN for name in names if name not in below}
    frames: dict[str, Frame] = {}
    for _ in range(MAX_DEPTH + 1):
        frames |= level
        level = {
            joint.child: frame.then(joint.origin) for name, frame in level.items() for joint in children.get(name, ())
        }
    if len(frames) < len(names):
        left_out = next(name for name in names if name not in frames)
        raise InputError(f"the joints above link {left_out!r} form a loop or a chain of more than {MAX_DEPTH}")
    return frames


def _each(elements: list[Any], read: Callable[[Any], _Read], mistakes: list[str]) -> Iterator[_Read]:
    for element in elements:
        try:
            yield read(element)
        except ValueError as error:
            mistakes.append(str(error))


def _link_name(link: Any) -> str:
    if not link.get("name"):
        raise ValueError("a <link> has no name; give it one")
    return str(link.get("name"))


def _joint(element: Any) -> Joint:
    name = element.get("name")
    if not name:
        raise ValueError("a <joint> has no name; give it one")
    where = f"joint {name!r}"
    parent, child = (_end(element, role, where) for role in ("parent", "child"))
    if not element.get("type"):
        raise ValueError(f'{where} has no type; a wheel has type="continuous", a rigid joint type="fixed"')
    limit = element.find("limit")
    effort, velocity = (
        None if limit is None or limit.get(key) is None else number(limit, key, f"{where}: <limit>")
        for key in ("effort", "velocity")
    )
    axis = _axis(element, where)
    return Joint(name, element.get("type"), parent, child, origin(element, where), axis, effort, velocity)


def _end(joint: Any, role: str, where: str) -> str:
    end = joint.find(role)
    if end is None or not end.get("link"):
        raise ValueError(f'{where} has no <{role} link="..."/>; name the {role} link')
    return str(end.get("link"))


def _axis(joint: Any, where: str) -> Array:
    element = joint.find("axis")
    axis = _X if element is None else triple(element, "xyz", "1 0 0", f"{where}: <axis>")
    length = float(np.linalg.norm(axis))
    if length == 0 and joint.get("type") == "fixed":  # exporters write zeros if the axis has no meaning
        return _X
    if not 0 < length < math.inf:
        raise ValueError(f'{where}: its <axis> is {element.get("xyz")!r}; it must not be zero, as xyz="0 1 0"')
    return axis / length


def origin(element: Any, where: str) -> Frame:
    """The pose that the <origin> of a joint or an inertia gives. Raises ValueError."""
    found = element.find("origin")
    if found is None:
        return ORIGIN
    where = f"{where}: <origin>"
    return Frame(rotation(*triple(found, "rpy", "0 0 0", where)), triple(found, "xyz", "0 0 0", where))


def rotation(roll: float, pitch: float, yaw: float) -> Array:
    """Rz(yaw) Ry(pitch) Rx(roll), as URDF defines rpy. (3, 3)."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def number(element: Any, key: str, where: str) -> Fraction:
    """An attribute that must be a number. Raises ValueError, which names it and its value."""
    text = element.get(key)
    if text is None:
        raise ValueError(f'{where} has no {key}; give {key}="..."')
    try:
        return exact(text.strip())
    except ValueError as error:
        raise ValueError(f"{where}: {key} = {text[:60]!r} {error}; it must be a finite number") from None


def triple(element: Any, key: str, default: str, where: str) -> Array:
    """An attribute of three numbers between spaces, (3,). Raises ValueError, which names it and its value."""
    text = element.get(key, default)
    words = text.split()
    try:
        if len(words) == 3:
            return np.array([float(exact(word)) for word in words])
    except ValueError:
        pass
    hint = "; write spaces for commas" if "," in text else ""
    raise ValueError(f"{where}: {key} = {text[:60]!r} must be three finite numbers between spaces{hint}")
