"""The arcs over which the kernel bounds |psi|: found by halving, with exact values."""

from __future__ import annotations

from typing import Any

from ...models.errors import InputError
from .. import kernel


def arcs(psi: dict[str, Any], psi_bar: str) -> dict[str, str]:
    """The depths of arcs that cover both halves of a period, from left to right, for psi as a certificate states it.

    Raises InputError where psi_bar is too close to the supremum of |psi|, or below it.
    """
    reader = kernel.Reader(kernel.places_of([psi, psi_bar]), 1)
    wave, (bar,) = kernel.read_psi(reader, psi), reader.column(psi_bar, "psi_bar", 1)
    if not wave.terms:
        raise InputError("excitation: psi is constant; give at least one sin or cos that is not 0")
    halves = (half_arcs(wave, bar, half_turn) for half_turn in (0, 1))
    return {name: " ".join(map(str, depths)) for name, depths in zip(("here", "opposite"), halves, strict=True)}


def half_arcs(psi: kernel.Psi, bar: int, half_turn: int) -> list[int]:
    """The depths for x = 2 atan(t) + pi half_turn, t in [-1, 1]; see `kernel.bounded_on_half`."""

    def slack(p: int, q: int) -> tuple[int, int]:
        return kernel.slack(psi, bar, half_turn, p, q)

    depths = []
    arcs = [(0, 0, slack(0, 1), slack(1, 1)), (-1, 0, slack(-1, 1), slack(0, 1))]  # from p / 2^k to (p + 1) / 2^k
    while arcs:
        place, depth, left, right = arcs.pop()
        if kernel.settled(psi, depth, left, right):
            depths.append(depth)
            continue
        if depth == kernel.MAX_DEPTH - 1 or min(left[0], right[0]) < 0:
            raise InputError("excitation: psi_bar is too close to the supremum of |psi| to be certified")
        middle = slack(2 * place + 1, 2 << depth)
        arcs += [(2 * place + 1, depth + 1, middle, right), (2 * place, depth + 1, left, middle)]
    return depths
