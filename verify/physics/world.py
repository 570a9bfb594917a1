"""One run in MuJoCo: torques of the controller at sample times, held on the wheels, and how the wheels roll."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from ...models.arrays import column, floats
from ...models.equations import State
from ...models.errors import InputError, UndecidedError
from ...models.fleet import Fleet
from ...models.numbers import nominal
from ..simulation.closed_loop import Floats
from ..simulation.disturbance import Disturbance
from ..simulation.sampled_loop import Sample, measured_state
from .scene import TIME_STEP, scene_xml

Torques = Callable[[float, State], tuple[Floats, Floats]]
_POSE, _MOTION = 9, 8  # numbers of one robot in qpos (position, quaternion, two wheels) and in qvel


@dataclass
class Slip:
    """How far wheels slide instead of rolling, over a run."""

    speed: float = 0.0  # m/s, the largest, of a wheel's contact point on the floor
    distance: float = 0.0  # m, of the robot whose wheels slide farthest
    share: float = 0.0  # of the distance that its wheels roll


class World:
    """A fleet in MuJoCo under a disturbance. Sampling, delay, noise and friction are simulated; nothing else is."""

    def __init__(self, fleet: Fleet, disturbance: Disturbance) -> None:
        """Build the model. Raises InputError for what it cannot be built of, and where MuJoCo is missing."""
        if find_spec("mujoco") is None:
            raise InputError("the plant mujoco needs the package mujoco: pip install 'gaincert[robots]'")
        if fleet.drive != "physical":
            raise InputError('the plant mujoco is of wheels on a floor: it needs drive = "physical" in the fleet file')
        if disturbance.mismatch or disturbance.lost_link:
            raise InputError("the plant mujoco knows no mismatch and no lost link; leave them out")
        import mujoco

        self._mujoco = mujoco
        self.disturbance = disturbance
        self.steps = max(1, math.ceil(disturbance.sample_time / TIME_STEP))  # of MuJoCo in a sample
        step = disturbance.sample_time / self.steps
        self.model: Any = mujoco.MjModel.from_xml_string(
            scene_xml(fleet, disturbance.coulomb, disturbance.viscous, step)
        )
        self.R = floats(column(nominal(vehicle.half_track) for vehicle in fleet.vehicles))
        self.r = floats(column(nominal(vehicle.wheel_radius) for vehicle in fleet.vehicles))
        self.slip = Slip()

    def samples(self, start: State, torques: Torques, horizon: float) -> Iterator[Sample]:
        """The motion from a state, (N,) each, sample by sample; `self.slip` grows with it.

        Raises UndecidedError where the engine gives up.
        """
        disturbance, data = self.disturbance, self._data_at(start)
        random = np.random.default_rng(disturbance.seed)
        waiting = deque([np.zeros((2, len(self.r)))] * round(disturbance.delay / disturbance.sample_time))
        rolled = slid = np.zeros(len(self.r))
        before = start
        for number in range(math.ceil(horizon / disturbance.sample_time)):
            t = number * disturbance.sample_time
            commanded = np.stack(torques(t, measured_state(before, disturbance, random)))
            waiting.append(commanded)
            data.ctrl[:] = waiting.popleft().T.ravel()
            self._mujoco.mj_step(self.model, data, nstep=self.steps)
            after, sliding, rolling = self._read(data, before.theta)
            if not np.isfinite(after.v).all() or data.warning.number.any():
                raise UndecidedError(f"MuJoCo gave up at {t:.3g} s; shorten the sample time")
            self.slip.speed = max(self.slip.speed, float(sliding.max()))
            slid, rolled = slid + sliding * disturbance.sample_time, rolled + rolling * disturbance.sample_time
            yield Sample(t, _row(before), _row(after), commanded[0][None], commanded[1][None])
            before = after
        worst = int(slid.argmax())
        self.slip.distance, self.slip.share = float(slid[worst]), float(slid[worst] / max(rolled[worst], 1e-9))

    def _data_at(self, start: State) -> Any:
        data = self._mujoco.MjData(self.model)
        pose, motion = data.qpos.reshape(-1, _POSE), data.qvel.reshape(-1, _MOTION)
        pose[:, 0], pose[:, 1], pose[:, 2] = start.x, start.y, self.r
        pose[:, 3], pose[:, 6] = np.cos(start.theta / 2), np.sin(start.theta / 2)
        motion[:, 0], motion[:, 1] = start.v * np.cos(start.theta), start.v * np.sin(start.theta)
        motion[:, 5] = start.omega
        motion[:, 6], motion[:, 7] = ((start.v + side * self.R * start.omega) / self.r for side in (-1, 1))
        return data

    def _read(self, data: Any, theta: Floats) -> tuple[State, Floats, Floats]:
        """The state, (N,) each, with headings on the real line; how fast wheels slide and roll, m/s, (N,)."""
        pose, motion = data.qpos.reshape(-1, _POSE), data.qvel.reshape(-1, _MOTION)
        w, x, y, z = pose[:, 3:7].T
        yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y**2 + z**2))
        heading = theta + np.remainder(yaw - theta + math.pi, math.tau) - math.pi
        cos, sin = np.cos(heading), np.sin(heading)
        v, across, omega = (
            cos * motion[:, 0] + sin * motion[:, 1],
            cos * motion[:, 1] - sin * motion[:, 0],
            motion[:, 5],
        )
        rims = self.r * motion[:, 6], self.r * motion[:, 7]
        along = [v + side * self.R * omega - rim for side, rim in zip((-1, 1), rims, strict=True)]
        sliding = np.maximum(*(np.hypot(each, across) for each in along))
        state = State(pose[:, 0].copy(), pose[:, 1].copy(), heading, v, omega)
        return state, sliding, np.maximum(*map(np.abs, rims))


def _row(state: State) -> State:
    return State(*(column[None] for column in state))
