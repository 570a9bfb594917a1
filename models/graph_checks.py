"""The mistakes in the names and links of a fleet: (A1) of the theorem and a well-formed graph."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from .errors import did_you_mean

SUGGESTED = 100  # above so many mistakes no similar names are suggested: the search takes long


def graph_mistakes(names: Sequence[str], edges: Iterable[Any], leader_links: Mapping[str, Any]) -> list[str]:
    """One line for every mistake in names and links: (A1) of the theorem and a well-formed graph. O(N + E)."""
    if not names:
        return ["the fleet has no vehicles; add a [[vehicle]] table"]
    mistakes: list[str] = []

    def meant(word: str) -> str:
        return did_you_mean(word, names) if len(mistakes) < SUGGESTED else ""

    neighbours: dict[str, list[str]] = {}
    for name in names:
        if name in neighbours:
            mistakes.append(f"vehicle {name!r}: two vehicles have this name; names must differ")
        neighbours[name] = []
    seen = set()
    for a, b, *_ in edges:
        pair = (min(a, b), max(a, b))
        for end in pair:
            if end not in neighbours:
                mistakes.append(f"graph: edge {a!r} - {b!r}: there is no vehicle {end!r}{meant(end)}")
        if a == b:
            mistakes.append(f"graph: edge {a!r} - {b!r} joins a vehicle to itself; remove it")
        elif pair in seen:
            mistakes.append(f"graph: edge {a!r} - {b!r} is listed twice; keep one, with the sum of the weights")
        seen.add(pair)
        if a in neighbours and b in neighbours:
            neighbours[a].append(b)
            neighbours[b].append(a)
    led = []
    for name, weight in leader_links.items():
        if name not in neighbours:
            mistakes.append(f"graph: leader link of {name!r}: there is no such vehicle{meant(name)}")
        elif weight != 0:
            led.append(name)
    return mistakes or _unled(neighbours, led)


def _unled(neighbours: dict[str, list[str]], led: list[str]) -> list[str]:
    """(A1): every connected component of the followers has a leader link."""
    reached, frontier = set(led), list(led)
    while frontier:
        new = [b for b in neighbours[frontier.pop()] if b not in reached]
        reached.update(new)
        frontier += new
    lost = [name for name in neighbours if name not in reached]
    if not lost:
        return []
    shown = ", ".join(repr(name) for name in lost[:5]) + (f" and {len(lost) - 5} more" if len(lost) > 5 else "")
    return [f"graph: no path joins {shown} to the leader, so L_l is singular (Lemma 1); add an edge or a leader link"]
