"""A part of a large fleet, which the search runs on in place of the whole."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from ...models.fleet import Fleet
from ...models.fleet_tables import Links
from ...models.graph import Graph
from ..starts import slowest_pattern
from ..task import Task, prepare


def part_of(task: Task) -> Task:
    """The task for the vehicles around the one whose error falls most slowly.

    Scalars mean the same for the part and for the whole, and many more of them can be tried on the part. It is the task
    itself for a small fleet, and where no vehicle of the part hears the leader.
    """
    settings, graph = task.settings, task.plant.graph
    if len(task.fleet) <= settings.roles_vehicles:
        return task
    chosen = _around(graph, int(np.argmax(slowest_pattern(graph))), settings.part_vehicles)
    if not np.any(graph.leader_weight[chosen]):
        return task
    return prepare(_among(task.fleet, chosen), replace(task.options, box=2 * task.half_width), settings)


def _around(graph: Graph, centre: int, count: int) -> list[int]:
    """The vehicles that are nearest over links, `count` at most, in the order of the fleet."""
    neighbours: list[list[int]] = [[] for _ in range(graph.vehicles)]
    for i, j in zip(graph.tail.tolist(), graph.head.tolist(), strict=True):
        neighbours[i].append(j)
        neighbours[j].append(i)
    found, waiting = {centre}, deque([centre])
    while waiting and len(found) < count:
        for near in neighbours[waiting.popleft()]:
            if near not in found and len(found) < count:
                found.add(near)
                waiting.append(near)
    return sorted(found)


def _among(fleet: Fleet, chosen: list[int]) -> Fleet:
    """The fleet of some vehicles with the links among them and to the leader."""
    vehicles = tuple(fleet.vehicles[i] for i in chosen)
    names = {vehicle.name for vehicle in vehicles}
    links = Links(
        edges=tuple(edge for edge in fleet.links.edges if names.issuperset(edge[:2])),
        leader_links={name: weight for name, weight in fleet.links.leader_links.items() if name in names},
    )
    same = {name: getattr(fleet, name) for name in type(fleet).model_fields if name not in ("links", "vehicles")}
    return Fleet(links=links, vehicles=vehicles, **same)
