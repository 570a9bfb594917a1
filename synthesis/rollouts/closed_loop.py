"""The closed loop (13)-(14), compiled: many fleets side by side, each with its own gains and frequency of psi."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from ...models.equations import (
    Errors,
    Plant,
    State,
    closed_loop,
    coordinate_scales,
    formation_coordinates,
    leader_coordinates,
    pull,
)
from ...models.excitation import Excitation
from ...models.gains import GAIN_NAMES, Gains
from ...models.graph import Graph
from ...models.saturation import SCALE_NAMES, Saturation
from .compiler import At, Compiled, LoopNest, Single, compiled, pointer, single_ops
from .runge_kutta import Array, Problem, Rate

PLANT = tuple(field.name for field in fields(Plant) if field.name != "graph")
COORDINATES = 3  # x, y and theta, of which the graph compares those of neighbours
NETWORK_SCALES, VEHICLE_SCALES = SCALE_NAMES[:2], SCALE_NAMES[2:]


class Controls(NamedTuple):
    """The controller's numbers of many fleets side by side, as singles."""

    gains: Array  # (5, N, B), in the order of GAIN_NAMES
    vehicle_scales: Array  # (2, N, B), speed and turn rate
    network_scales: Array  # (2, B), position and heading
    frequency: Array  # (B,), doubles, rad/s, of psi

    @classmethod
    def of(cls, gains: Sequence[Gains], frequency: Sequence[float]) -> Controls:
        """Those of several fleets of equal size."""
        vehicles = len(gains[0].p_v)
        scales = [one.saturation.columns(vehicles) for one in gains]
        return cls(
            stacked([[getattr(one, name) for name in GAIN_NAMES] for one in gains]),
            stacked([[one[name] for name in VEHICLE_SCALES] for one in scales]),
            np.ascontiguousarray(stacked([[one[name] for name in NETWORK_SCALES] for one in scales])[:, 0]),
            np.array(frequency, dtype=float),
        )

    def take(self, numbers: Array) -> Controls:
        """Those of the fleets with these numbers."""
        return Controls(*(np.ascontiguousarray(array[..., numbers]) for array in self))


class ClosedLoop:
    """(13)-(14) for one plant and psi of any frequency."""

    def __init__(self, plant: Plant, excitation: Excitation) -> None:
        self._graph = plant.graph.map(lambda weights: np.asarray(weights, dtype=Single))
        self._numbers = rows([getattr(plant, name) for name in PLANT], plant.graph.vehicles)
        self._loops = _loops(replace(excitation, frequency=Fraction(1)))

    def problem(self, controls: Controls) -> Problem:
        """The rates (5, N, B) of states (5, N, B)."""
        graph, (vehicles, width) = self._graph, controls.gains.shape[1:]
        turns, sums = np.empty(width, Single), np.empty((COORDINATES, vehicles, width), Single)
        turning = controls.frequency / (2 * math.pi)
        shared = {
            "gains": controls.gains,
            "vehicle_scales": controls.vehicle_scales,
            "network_scales": controls.network_scales,
            "plant": self._numbers,
            "weight": graph.weight,
            "leader_weight": graph.leader_weight,
            "turns": turns,
            "psi": np.empty(width, Single),
            "z": np.empty_like(sums),
            "sums": sums,
        }
        pointers = {name: pointer(array) for name, array in shared.items()}
        ends = [pointer(row, np.int64) for row in (graph.tail, graph.head)]

        def problem(state: Array, rates: Array) -> Rate:
            arrays = {**pointers, "state": pointer(state), "rates": pointer(rates)}
            excite = self._loops["excitation"].bind(1, width, arrays)
            place = self._loops["coordinates"].bind(vehicles, width, arrays)
            couple = self._loops["edges"].bind(graph.edges, width, arrays, ends, vehicles)
            move = self._loops["vehicles"].bind(vehicles, width, arrays)

            def rate(t: Array) -> None:
                # Many turns have no digits left in single precision.
                periods = t * turning
                turns[...] = periods - np.floor(periods)
                sums[...] = 0
                excite(), place(), couple(), move()

            return rate

        return problem


def rows(values: Sequence[Any], items: int) -> Array:
    """Numbers of every item, or one for all, as singles (values, items)."""
    return np.array([np.broadcast_to(value, items) for value in values], dtype=Single)


def stacked(values: Sequence[Sequence[Any]]) -> Array:
    """Columns (N,) of several fleets, (fleets, columns), as singles (columns, N, fleets)."""
    return np.ascontiguousarray(np.moveaxis(np.array(values, dtype=Single), 0, 2))


@lru_cache(maxsize=16)
def _loops(excitation: Excitation) -> dict[str, Compiled]:
    """(13)-(14) in loops over the columns, the vehicles and the edges."""
    return compiled({"excitation": _excitation_loop(excitation), "edges": _edge_loop(), **_vehicle_loops()})


def _excitation_loop(excitation: Excitation) -> LoopNest:
    """psi of every column, from the share of its period that has passed."""
    turns = ca.SX.sym("turns")
    value = excitation.value(single_ops(), 2 * math.pi * turns)
    return LoopNest(ca.Function("f", [turns], [value]), [("turns", At.COLUMN)], [("psi", At.COLUMN)])


def _edge_loop() -> LoopNest:
    """The pull of every edge in (8) and (10), added to the sum at its tail and subtracted from that at its head."""
    weight, scales = ca.SX.sym("weight"), ca.SX.sym("network_scales", 2)
    ends = z_tail, z_head, at_tail, at_head = [
        ca.SX.sym(name, COORDINATES) for name in ("z_tail", "z_head", "sums_tail", "sums_head")
    ]
    pairs = zip(coordinate_scales(Saturation(*ca.vertsplit(scales))), (z_tail - z_head).elements(), strict=True)
    force = ca.vertcat(*(pull(single_ops(), weight, *pair) for pair in pairs))
    return LoopNest(
        ca.Function("f", [*ends, weight, scales], [at_tail + force, at_head - force]),
        [
            ("z", At.TAIL),
            ("z", At.HEAD),
            ("sums", At.TAIL),
            ("sums", At.HEAD),
            ("weight", At.ITEM),
            ("network_scales", At.COLUMN),
        ],
        [("sums", At.TAIL), ("sums", At.HEAD)],
    )


def _vehicle_loops() -> dict[str, LoopNest]:
    """The formation coordinates of every vehicle, and its rates once the pulls of its edges are summed up."""
    symbol, ops = ca.SX.sym, single_ops()
    leader_weight, psi, sums = symbol("leader_weight"), symbol("psi"), symbol("sums", COORDINATES)
    numbers, gains, rows = symbol("plant", len(PLANT)), symbol("gains", len(GAIN_NAMES)), symbol("state", 5)
    nobody = np.zeros(0, dtype=np.int64)
    plant = Plant(Graph(nobody, nobody, symbol("no_edge"), leader_weight), *ca.vertsplit(numbers))
    vehicle_scales, network_scales = symbol("vehicle_scales", 2), symbol("network_scales", 2)
    saturation = Saturation(*ca.vertsplit(network_scales), *ca.vertsplit(vehicle_scales))
    columns = dict(zip(GAIN_NAMES, ca.vertsplit(gains), strict=True))
    state = State(*ca.vertsplit(rows))
    coordinates = formation_coordinates(plant, state)
    distances = [z - leader for z, leader in zip(coordinates, leader_coordinates(plant), strict=True)]
    pairs = zip(coordinate_scales(saturation), distances, strict=True)
    to_leader = ca.vertcat(*(pull(ops, leader_weight, *pair) for pair in pairs))
    errors = Errors(*(to_leader + sums).elements())
    rates = closed_loop(ops, plant, Gains(**columns, saturation=saturation), psi, state, errors)
    arguments = {
        "state": (rows, At.EACH),
        "plant": (numbers, At.ITEM),
        "leader_weight": (leader_weight, At.ITEM),
        "gains": (gains, At.EACH),
        "vehicle_scales": (vehicle_scales, At.EACH),
        "network_scales": (network_scales, At.COLUMN),
        "psi": (psi, At.COLUMN),
        "sums": (sums, At.EACH),
    }
    return {
        "coordinates": LoopNest(
            ca.Function("f", [rows, numbers], [ca.vertcat(*coordinates)]),
            [("state", At.EACH), ("plant", At.ITEM)],
            [("z", At.EACH)],
        ),
        "vehicles": LoopNest(
            ca.Function("f", [symbols for symbols, _ in arguments.values()], [ca.vertcat(*rates)]),
            [(name, at) for name, (_, at) in arguments.items()],
            [("rates", At.EACH)],
        ),
    }
