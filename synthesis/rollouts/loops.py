"""Loops over items and columns, as data: which function, which arrays; and programs of such loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum
from typing import NamedTuple

import casadi as ca


class At(Enum):
    """The last axes of an array, by item and column. The first axis of the array counts the values read together."""

    EACH = "(items, columns)"
    ITEM = "(items,)"
    COLUMN = "(columns,)"
    TAIL = "(others, columns), in the row that is the tail of the item"
    HEAD = "(others, columns), in the row that is its head"


ENDS = At.TAIL, At.HEAD


class LoopNest(NamedTuple):
    """A function of vectors, the arrays it reads its arguments from and those it writes its results to, by name."""

    function: ca.Function
    reads: Sequence[tuple[str, At]]
    writes: Sequence[tuple[str, At]]


class Part(NamedTuple):
    """A loop of a program."""

    loop: str
    items: str  # the name of how many items it has
    renamed: tuple[tuple[str, str], ...] = ()  # arrays of the loop, and which ones of the program they are
    moving: tuple[
        str, ...
    ] = ()  # arrays At.ITEM of the loop of which every step reads the next: (steps, values, items)

    def name(self, array: str) -> str:
        """The array of the program that an array of the loop is."""
        return dict(self.renamed).get(array, array)


def arrays_of(loop: LoopNest) -> list[str]:
    """The names of the arrays of a loop."""
    return list(dict.fromkeys(name for name, _ in (*loop.reads, *loop.writes)))


def program_arrays(loops: Mapping[str, LoopNest], parts: Sequence[Part]) -> list[str]:
    """The names of the arrays of a program."""
    return list(dict.fromkeys(part.name(name) for part in parts for name in arrays_of(loops[part.loop])))


def program_sizes(parts: Sequence[Part]) -> list[str]:
    """The kinds of items of a program."""
    return list(dict.fromkeys(["vehicles", *(part.items for part in parts)]))
