"""The closed loop (13)-(14) in loops over columns, vehicles and edges.

Each column is a fleet of its own, with its own gains, scales and frequency of psi; all are copies of one plant.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from ...models.algebra.ops import Ops
from ...models.equations import (
    Errors,
    Plant,
    State,
    control,
    coordinate_scales,
    formation_coordinates,
    leader_coordinates,
    motion,
    pull,
)
from ...models.excitation import Excitation
from ...models.gains import GAIN_NAMES, Gains
from ...models.graph import Graph
from ...models.saturation import SCALE_NAMES, Saturation
from .compiler import Pointer, Single, pointer
from .loops import At, LoopNest, Part
from .runge_kutta import Array
from .single_functions import single_ops

PLANT = tuple(field.name for field in fields(Plant) if field.name != "graph")
COORDINATES = 3  # x, y and theta, of which the graph compares those of neighbours
NETWORK_SCALES, VEHICLE_SCALES = SCALE_NAMES[:2], SCALE_NAMES[2:]


class Controls(NamedTuple):
    """The controller's numbers of many fleets side by side, as singles: equal numbers on every processor."""

    gains: Array  # (5, N, B), in the order of GAIN_NAMES
    vehicle_scales: Array  # (2, N, B), speed and turn rate
    network_scales: Array  # (2, B), position and heading
    frequency: Array  # (B,), rad/s, of psi

    @classmethod
    def of(cls, gains: Sequence[Gains], frequency: Sequence[float]) -> Controls:
        """Those of several fleets of equal size."""
        vehicles = len(gains[0].p_v)
        scales = [one.saturation.columns(vehicles) for one in gains]
        return cls(
            stacked([[getattr(one, name) for name in GAIN_NAMES] for one in gains]),
            stacked([[one[name] for name in VEHICLE_SCALES] for one in scales]),
            np.ascontiguousarray(stacked([[one[name] for name in NETWORK_SCALES] for one in scales])[:, 0]),
            np.array(frequency, dtype=Single),
        )

    def take(self, numbers: Any) -> Controls:
        """Those of the fleets with these numbers."""
        return Controls(*(np.ascontiguousarray(array[..., numbers]) for array in self))


def stacked(values: Sequence[Sequence[Any]]) -> Array:
    """Columns (N,) of several fleets, (fleets, columns), as singles (columns, N, fleets)."""
    return np.ascontiguousarray(np.moveaxis(np.array(values, dtype=Single), 0, 2))


def rows(values: Sequence[Any], items: int) -> Array:
    """Numbers of every item, or one for all, as singles (values, items)."""
    return np.array([np.broadcast_to(value, items) for value in values], dtype=Single)


def phases(frequency: Array, t: Array) -> Array:
    """How much of a turn psi has made since its last full one, (B,) singles: many turns would leave no digits."""
    turns = frequency.astype(float) * t / (2 * math.pi)
    return np.asarray(turns - np.floor(turns), dtype=Single)


def controller_arrays(plant: Plant, controls: Controls) -> dict[str, Array]:
    """The arrays that the loops of the controller read and write, by name; beside them `measured` and the results."""
    vehicles, width = controls.gains.shape[1:]
    graph = plant.graph.map(lambda weights: np.asarray(weights, dtype=Single))
    return {
        "gains": controls.gains,
        "vehicle_scales": controls.vehicle_scales,
        "network_scales": controls.network_scales,
        "plant": rows([getattr(plant, name) for name in PLANT], vehicles),
        "weight": graph.weight,
        "leader_weight": graph.leader_weight,
        "losable": np.zeros(graph.edges, Single),  # 1 for the edges that a column may lose
        "connected": np.ones(width, Single),  # 0 for columns that have lost them
        "phase": np.zeros(width, Single),
        "psi": np.empty(width, Single),
        "z": np.empty((COORDINATES, vehicles, width), Single),
        "sums": np.empty((COORDINATES, vehicles, width), Single),
    }


def edge_ends(graph: Graph) -> list[Pointer]:
    """The ends of the edges, as programs take them."""
    return [pointer(ends, np.int64) for ends in (graph.tail, graph.head)]


def controller_parts(measured: str, phase: str, result: str, into: str) -> list[Part]:
    """The parts of a program that evaluate `result` ("torques" or "rates") into an array.

    They read states from the array `measured` and phases of psi from `phase`.
    """
    read = (("measured", measured),)
    return [
        Part("psi", "one", (("phase", phase),)),
        Part("coordinates", "vehicles", read),
        Part("clear", "vehicles"),
        Part("edges", "edges"),
        Part(result, "vehicles", (*read, (result, into))),
    ]


def controller_loops(excitation: Excitation) -> dict[str, LoopNest]:
    """The loops of the controller for psi of a shape, and of the closed loop."""
    each, item, column = At.EACH, At.ITEM, At.COLUMN
    ops, symbols = single_ops(), _Symbols()
    leader_weight, psi = symbols.vector("leader_weight", 1), symbols.vector("psi", 1)
    sums, state = symbols.vector("sums", COORDINATES), symbols.state
    plant = replace(symbols.plant, graph=replace(symbols.plant.graph, leader_weight=leader_weight))
    scales = coordinate_scales(symbols.gains.saturation)
    coordinates = formation_coordinates(plant, state)
    distances = [z - leader for z, leader in zip(coordinates, leader_coordinates(plant), strict=True)]
    to_leader = [pull(ops, leader_weight, *pair) for pair in zip(scales, distances, strict=True)]
    errors = Errors(*(ca.vertcat(*to_leader) + sums).elements())
    torques = control(ops, plant, symbols.gains, psi, state, errors)
    places = {
        "measured": each,
        "plant": item,
        "leader_weight": item,
        "gains": each,
        "vehicle_scales": each,
        "network_scales": column,
        "psi": column,
        "sums": each,
    }
    return {
        "psi": _excitation(ops, replace(excitation, frequency=Fraction(1))),
        "coordinates": symbols.loop({"measured": each, "plant": item}, coordinates, "z"),
        "clear": LoopNest(ca.Function("clear", [], [ca.SX.zeros(COORDINATES)]), [], [("sums", each)]),
        "edges": _edges(ops),
        "torques": symbols.loop(places, torques, "torques"),
        "rates": symbols.loop(places, motion(ops, plant, state, *torques), "rates"),
    }


class _Symbols:
    """The vectors that loops over vehicles read, by name."""

    def __init__(self) -> None:
        self._vectors: dict[str, Any] = {}
        state = self.vector("measured", len(State._fields))
        numbers, gains = self.vector("plant", len(PLANT)), self.vector("gains", len(GAIN_NAMES))
        network, vehicle = self.vector("network_scales", 2), self.vector("vehicle_scales", 2)
        self.state, self.plant = State(*ca.vertsplit(state)), symbolic_plant(numbers)
        saturation = Saturation(*ca.vertsplit(network), *ca.vertsplit(vehicle))
        self.gains = Gains(**dict(zip(GAIN_NAMES, ca.vertsplit(gains), strict=True)), saturation=saturation)

    def vector(self, name: str, count: int) -> Any:
        """A vector of symbols."""
        self._vectors[name] = ca.SX.sym(name, count)
        return self._vectors[name]

    def loop(self, places: dict[str, At], results: Sequence[Any], into: str) -> LoopNest:
        """The loop that reads the vectors of `places` and writes the results."""
        function = ca.Function(into, [self._vectors[name] for name in places], [ca.vertcat(*results)])
        return LoopNest(function, list(places.items()), [(into, At.EACH)])


def symbolic_plant(numbers: Any) -> Plant:
    """The plant of one vehicle, without links, from its numbers in the order of PLANT."""
    nobody = np.zeros(0, dtype=np.int64)
    return Plant(Graph(nobody, nobody, ca.SX(0), ca.SX(0)), *ca.vertsplit(numbers))


def _excitation(ops: Ops, excitation: Excitation) -> LoopNest:
    phase = ca.SX.sym("phase")
    function = ca.Function("psi", [phase], [excitation.value(ops, 2 * math.pi * phase)])
    return LoopNest(function, [("phase", At.COLUMN)], [("psi", At.COLUMN)])


def _edges(ops: Ops) -> LoopNest:
    """The pulls of every edge, added up at both of its ends."""
    weight, losable, connected, network = (
        ca.SX.sym(name, count) for name, count in (("weight", 1), ("losable", 1), ("connected", 1), ("network", 2))
    )
    z_tail, z_head, at_tail, at_head = (ca.SX.sym(f"edge{k}", COORDINATES) for k in range(4))
    present = weight * (1 - losable * (1 - connected))
    scales = coordinate_scales(Saturation(*ca.vertsplit(network)))
    between = zip(scales, (z_tail - z_head).elements(), strict=True)
    force = ca.vertcat(*(pull(ops, present, *pair) for pair in between))
    sums = [("sums", At.TAIL), ("sums", At.HEAD)]
    reads = [
        ("z", At.TAIL),
        ("z", At.HEAD),
        ("weight", At.ITEM),
        ("losable", At.ITEM),
        ("connected", At.COLUMN),
        ("network_scales", At.COLUMN),
        *sums,
    ]
    arguments = [z_tail, z_head, weight, losable, connected, network, at_tail, at_head]
    return LoopNest(ca.Function("edges", arguments, [at_tail + force, at_head - force]), reads, sums)
