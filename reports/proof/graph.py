"""The dependency graph of the claims as SVG: what rests on what, coloured by verdict."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from ...verify.proof.claim import Claim, Status
from .words import place_of

COLOURS = {
    Status.PROVED: "#2f7d4f",
    Status.FORMAL: "#2f5f9d",
    Status.CITED: "#5b4b8a",
    Status.CORRECTED: "#b7791f",
    Status.REFUTED: "#b3322e",
    Status.OPEN: "#6b6b6b",
}
WIDTH, HEIGHT, GAP_X, GAP_Y, MARGIN = 136, 22, 56, 8, 24
SHOWN = 22  # characters of a label


def draw(claims: Iterable[Claim], root: str = "theorem") -> str:
    """Layers from left (rests on nothing) to right; the support of the theorem in heavier lines."""
    by_id = {claim.id: claim for claim in claims}
    linked = {need for claim in by_id.values() for need in claim.rests_on} | {
        c.id for c in by_id.values() if c.rests_on
    }
    shown = {id_: claim for id_, claim in by_id.items() if id_ in linked}
    layers = _layers(shown)
    place = _places(shown, layers)
    heavy = _support(shown, root) | {root}
    edges = [_edge(place[need], place[id_], id_ in heavy) for id_, claim in shown.items() for need in claim.rests_on]
    nodes = [_node(claim, *place[id_], heavy=id_ in heavy) for id_, claim in shown.items()]
    right = max(x for x, _ in place.values()) + WIDTH + MARGIN
    bottom = max(y for _, y in place.values()) + HEIGHT + MARGIN
    return _document(right, bottom, [*sorted(edges), *nodes, *_legend()])


def _layers(claims: dict[str, Claim]) -> dict[str, int]:
    depth: dict[str, int] = {}

    def visit(id_: str) -> int:
        if id_ not in depth:
            depth[id_] = 1 + max((visit(need) for need in claims[id_].rests_on), default=-1)
        return depth[id_]

    for id_ in claims:
        visit(id_)
    return depth


def _places(claims: dict[str, Claim], layers: dict[str, int]) -> dict[str, tuple[float, float]]:
    """Within a layer, each claim near the mean height of what it needs."""
    columns: dict[int, list[str]] = {}
    for id_, layer in layers.items():
        columns.setdefault(layer, []).append(id_)
    tallest = max(map(len, columns.values()))
    place: dict[str, tuple[float, float]] = {}
    for layer in sorted(columns):
        ids = sorted(columns[layer], key=lambda id_: _mean_height(claims[id_], place))
        top = MARGIN + 40 + (tallest - len(ids)) * (HEIGHT + GAP_Y) / 2
        for row, id_ in enumerate(ids):
            place[id_] = (MARGIN + layer * (WIDTH + GAP_X), top + row * (HEIGHT + GAP_Y))
    return place


def _mean_height(claim: Claim, place: dict[str, tuple[float, float]]) -> float:
    heights = [place[need][1] for need in claim.rests_on if need in place]
    return sum(heights) / len(heights) if heights else 0.0


def _support(claims: dict[str, Claim], root: str) -> set[str]:
    found: set[str] = set()
    waiting = list(claims[root].rests_on) if root in claims else []
    while waiting:
        need = waiting.pop()
        if need not in found:
            found.add(need)
            waiting.extend(claims[need].rests_on)
    return found


def _edge(start: tuple[float, float], end: tuple[float, float], heavy: bool) -> str:
    x1, y1, x2, y2 = start[0] + WIDTH, start[1] + HEIGHT / 2, end[0], end[1] + HEIGHT / 2
    bend = max(24.0, (x2 - x1) / 2)
    style = ("#3c3c3c", 1.1, 0.75) if heavy else ("#9a9a9a", 0.8, 0.45)
    return (
        f'<path d="M{x1:.0f} {y1:.0f} C{x1 + bend:.0f} {y1:.0f} {x2 - bend:.0f} {y2:.0f} {x2:.0f} {y2:.0f}" '
        f'fill="none" '
        f'stroke="{style[0]}" stroke-width="{style[1]}" stroke-opacity="{style[2]}"/>'
    )


def _node(claim: Claim, x: float, y: float, heavy: bool) -> str:
    colour = COLOURS[claim.status]
    place = place_of(claim)
    text = place if len(place) <= SHOWN else place[: SHOWN - 1] + "…"
    return (
        f"<g><title>{escape(place_of(claim))}: {claim.status.name}</title>"
        f'<rect x="{x:.0f}" y="{y:.0f}" width="{WIDTH}" height="{HEIGHT}" rx="4" fill="{colour}" '
        f'fill-opacity="{1 if heavy else 0.78}" stroke="{"#111" if heavy else "none"}"/>'
        f'<text x="{x + WIDTH / 2:.0f}" y="{y + 15:.0f}" fill="white" text-anchor="middle">{escape(text)}</text></g>'
    )


def _legend() -> list[str]:
    parts = []
    for number, (status, colour) in enumerate(COLOURS.items()):
        x = MARGIN + number * 110
        parts.append(f'<rect x="{x}" y="{MARGIN - 6}" width="12" height="12" fill="{colour}"/>')
        parts.append(f'<text x="{x + 18}" y="{MARGIN + 5}" fill="#222">{status.name.lower()}</text>')
    x = MARGIN + len(COLOURS) * 110
    return [*parts, f'<text x="{x}" y="{MARGIN + 5}" fill="#222">outlined: beneath the corrected theorem</text>']


def _document(width: float, height: float, parts: list[str]) -> str:
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" '
        f'height="{height:.0f}" font-family="Helvetica, Arial, sans-serif" font-size="11">'
    )
    return "\n".join([head, '<rect width="100%" height="100%" fill="white"/>', *parts, "</svg>\n"])
