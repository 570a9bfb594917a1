"""The controller as C99: gaincert_controller.c and .h, a test program and its make file."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.algebra.ops import numpy_ops
from ...models.arrays import floats
from ...models.equations import Plant, State, accelerations, control
from ...models.gains import GAIN_NAMES
from ..deployment import Deployment
from ..rendering import render
from ..tables.gain_table import CONTROLLER, rows
from ..tables.neighbours import neighbours
from .casadi_source import ROBOT, control_source

NAME = "gaincert_controller"
LISTED = 200  # the header lists the gains of at most so many vehicles
TEST_NUMBERS = 12_000  # expected torques in the test program
TEST_CASES = 100
LARGEST_TIME = 1000.0  # s, in the test program
SPREAD = State(50.0, 50.0, 10.0, 5.0, 5.0)  # of its random states: m, m, rad, m/s, rad/s


def c_files(deployed: Deployment) -> dict[str, str]:
    """File name -> text of the C export."""
    plant = deployed.fleet.plant()
    near = neighbours(plant.graph)
    links = np.column_stack([near.weight, plant.offset_x[near.vehicle], plant.offset_y[near.vehicle]])
    table = rows(deployed.fleet, deployed.excitation, deployed.gains)
    common: dict[str, Any] = {
        "name": NAME,
        "fleet": deployed.fleet,
        "evidence": deployed.evidence,
        "vehicles": len(deployed.fleet),
        "leader": [_number(v) for v in (plant.leader_x, plant.leader_y, plant.leader_theta)],
        "table": table if len(table) <= LISTED else [],
        "columns": CONTROLLER,
    }
    robots = [_row(row) for row in _robots(deployed, plant)]
    degrees = np.diff(near.first)
    source = render(
        "controller.c",
        control=control_source(deployed.excitation, degrees.tolist()),
        degrees=sorted(set(degrees.tolist())),
        most=max(1, int(degrees.max())),
        robots=robots,
        robot_size=len(ROBOT),
        first=near.first.tolist(),
        neighbours=near.vehicle.tolist() or [0],
        links=[_row(row) for row in links] or ["{0.0, 0.0, 0.0}"],
        inertias=[_row(row) for row in _inertias(plant)],
        bounds=[_number(float(bound)) for bound in deployed.torque_bounds],
        limits=[_number(float(limit)) for limit in deployed.fleet.condition_data(deployed.excitation).torque],
        **common,
    )
    return {
        f"{NAME}.h": render("controller.h", **common),
        f"{NAME}.c": source,
        f"{NAME}_test.c": render("controller_test.c", **common, **_test_cases(deployed, plant)),
        f"{NAME}.mk": render("controller.mk", name=NAME),
    }


def _robots(deployed: Deployment, plant: Plant) -> NDArray[np.float64]:
    """One row per vehicle, in the order of `casadi_source.ROBOT`."""
    gains = [floats(getattr(deployed.gains, name)) for name in GAIN_NAMES]
    scales = [floats(column) for column in deployed.gains.saturation.columns(len(deployed.fleet)).values()]
    return np.column_stack(
        [*gains, *scales, plant.r, plant.arm, plant.offset_x, plant.offset_y, plant.graph.leader_weight]
    )


def _inertias(plant: Plant) -> NDArray[np.float64]:
    """(v' over the sum of the torques, omega' over their difference) of (2), one row per vehicle."""
    ones, zeros = np.ones_like(plant.r), np.zeros_like(plant.r)
    return np.column_stack([accelerations(plant, ones, zeros)[k] for k in range(2)])


def _row(values: Any) -> str:
    return "{" + ", ".join(map(_number, values)) + "}"


def _number(value: Any) -> str:
    """The shortest C literal that reads back as the same double."""
    return repr(float(value))


def _test_cases(deployed: Deployment, plant: Plant) -> dict[str, Any]:
    """Random states, drawn as the C program draws them, and the torques that Python computes for them."""
    count = len(deployed.fleet)
    cases = max(1, min(TEST_CASES, TEST_NUMBERS // (2 * count)))
    t, state = sample_states(count, cases)
    left, right = control(
        numpy_ops(), plant, deployed.gains.map(floats), deployed.excitation.value(numpy_ops(), t[:, None]), state
    )
    return {
        "cases": cases,
        "largest_time": _number(LARGEST_TIME),
        "spread": [_number(value) for value in SPREAD],
        "expected": [_row(pair) for pair in zip(left.ravel(), right.ravel(), strict=True)],
    }


def sample_states(count: int, cases: int) -> tuple[NDArray[np.float64], State]:
    """Times (cases,) and states (cases, count) from a linear congruential generator modulo 2^32."""
    seed = 1
    draws = np.empty((cases, 1 + 5 * count))
    for position in np.ndindex(draws.shape):
        seed = (1664525 * seed + 1013904223) % 2**32
        draws[position] = seed / 2**32
    parts = draws[:, 1:].reshape(cases, count, 5)
    return LARGEST_TIME * draws[:, 0], State(*(SPREAD[k] * (2 * parts[:, :, k] - 1) for k in range(5)))
