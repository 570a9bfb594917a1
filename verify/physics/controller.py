"""The exported C controller, called through its header."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np

from ...models.equations import State
from ..simulation.closed_loop import Floats


class CController:
    """A compiled gaincert_controller, as a robot would load it."""

    def __init__(self, library: Path, vehicles: int) -> None:
        """Load the shared library of a fleet of so many vehicles."""
        self._torques = ctypes.CDLL(str(library)).gaincert_torques
        self._torques.restype = None
        self._vehicles = vehicles
        self._arrays = [(ctypes.c_double * vehicles)() for _ in State._fields]
        self._left, self._right = ctypes.c_double(), ctypes.c_double()

    def torques(self, t: float, state: State) -> tuple[Floats, Floats]:
        """Left and right torque of every vehicle, N m, (N,), at time t (s) in a measured state, (N,) each."""
        for array, column in zip(self._arrays, state, strict=True):
            array[:] = column.tolist()
        found = np.empty((2, self._vehicles))
        for vehicle in range(self._vehicles):
            self._torques(
                vehicle, ctypes.c_double(t), *self._arrays, ctypes.byref(self._left), ctypes.byref(self._right)
            )
            found[:, vehicle] = self._left.value, self._right.value
        return found[0], found[1]
