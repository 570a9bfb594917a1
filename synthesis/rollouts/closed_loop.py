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
    symbol, each, item, column = ca.SX.sym, At.EACH, At.ITEM, At.COLUMN
    ops = single_ops()
    weight, leader_weight, turns, psi = (symbol(name) for name in ("weight", "leader_weight", "turns", "psi"))
    numbers, gains, rows = symbol("plant", len(PLANT)), symbol("gains", len(GAIN_NAMES)), symbol("state", 5)
    nobody = np.zeros(0, dtype=np.int64)
    plant = Plant(Graph(nobody, nobody, weight, leader_weight), *ca.vertsplit(numbers))
    vehicle_scales, network_scales = symbol("vehicle_scales", 2), symbol("network_scales", 2)
    saturation = Saturation(*ca.vertsplit(network_scales), *ca.vertsplit(vehicle_scales))
    state, scales = State(*ca.vertsplit(rows)), coordinate_scales(saturation)
    sums, z_tail, z_head = (symbol(name, COORDINATES) for name in ("sums", "z_tail", "z_head"))
    at_tail, at_head = symbol("sums_tail", COORDINATES), symbol("sums_head", COORDINATES)
    columns = dict(zip(GAIN_NAMES, ca.vertsplit(gains), strict=True))
    coordinates = formation_coordinates(plant, state)
    distances = [z - leader for z, leader in zip(coordinates, leader_coordinates(plant), strict=True)]
    to_leader = [pull(ops, leader_weight, *pair) for pair in zip(scales, distances, strict=True)]
    errors = Errors(*(ca.vertcat(*to_leader) + sums).elements())
    rates = closed_loop(ops, plant, Gains(**columns, saturation=saturation), psi, state, errors)
    between = (z_tail - z_head).elements()
    force = ca.vertcat(*(pull(ops, weight, *pair) for pair in zip(scales, between, strict=True)))
    return compiled(
        {
            "excitation": LoopNest(
                ca.Function("f", [turns], [excitation.value(ops, 2 * math.pi * turns)]),
                [("turns", column)],
                [("psi", column)],
            ),
            "coordinates": LoopNest(
                ca.Function("f", [rows, numbers], [ca.vertcat(*coordinates)]),
                [("state", each), ("plant", item)],
                [("z", each)],
            ),
            "edges": LoopNest(
                ca.Function(
                    "f",
                    [z_tail, z_head, weight, network_scales, at_tail, at_head],
                    [at_tail + force, at_head - force],
                ),
                [
                    ("z", At.TAIL),
                    ("z", At.HEAD),
                    ("weight", item),
                    ("network_scales", column),
                    ("sums", At.TAIL),
                    ("sums", At.HEAD),
                ],
                [("sums", At.TAIL), ("sums", At.HEAD)],
            ),
            "vehicles": LoopNest(
                ca.Function(
                    "f",
                    [rows, numbers, leader_weight, gains, vehicle_scales, network_scales, psi, sums],
                    [ca.vertcat(*rates)],
                ),
                [
                    ("state", each),
                    ("plant", item),
                    ("leader_weight", item),
                    ("gains", each),
                    ("vehicle_scales", each),
                    ("network_scales", column),
                    ("psi", column),
                    ("sums", each),
                ],
                [("rates", each)],
            ),
        }
    )
