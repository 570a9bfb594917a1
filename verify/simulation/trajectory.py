"""A trajectory as arrays, written to trajectory.npz and read back."""

from __future__ import annotations

import struct
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tokenize import TokenError
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...models.equations import State
from ...models.errors import InputError
from ...models.files.text import write_whole

if TYPE_CHECKING:
    from .integrators import Integrator

Floats = NDArray[np.float64]
_UNREADABLE = (  # errors of a damaged or hostile file
    *(OSError, ValueError, KeyError, EOFError, RuntimeError, MemoryError),
    *(zipfile.BadZipFile, zlib.error, struct.error, TokenError),
)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """One run of a fleet: times (K,), arrays (K, N)."""

    t: Floats  # s
    state: State
    tau_left: Floats  # N m
    tau_right: Floats  # N m
    V: Floats  # (K,), (17)
    W: Floats  # (K,), (19)
    integrator: Integrator | None = None  # the run's integrator; None for a disturbed run and for one read from a file

    @property
    def start(self) -> State:
        """The first state, each (N,)."""
        return State(*(column[0] for column in self.state))

    @property
    def made_by(self) -> Integrator:
        """The integrator. Raises ValueError if it is not known: then the run cannot be refined between its points."""
        if self.integrator is None:
            raise ValueError("this trajectory was read from a file or disturbed; only one of simulate can be refined")
        return self.integrator

    def write(self, path: Path, labels: Mapping[str, str] | None = None) -> None:
        """trajectory.npz, written whole or not at all; `labels` are texts beside the arrays, for example digests."""
        torques = {"tau_left": self.tau_left, "tau_right": self.tau_right}
        arrays: dict[str, Any] = {**self.state._asdict(), **torques, "V": self.V, "W": self.W}
        arrays |= {name: np.array(text) for name, text in (labels or {}).items()}
        write_whole(path, lambda file: np.savez_compressed(file, t=self.t, **arrays))


def read_labels(path: Path, names: Iterable[str]) -> dict[str, str]:
    """The labels of these names in a trajectory.npz; missing ones are left out. Raises InputError."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            return {name: str(stored[name]) for name in names if name in stored}
    except _UNREADABLE as error:
        raise InputError(f"{path}: is no trajectory.npz ({error}); simulate again") from None


def read_trajectory(path: Path) -> Trajectory:
    """The run in a trajectory.npz. Raises InputError for any other file."""
    names = ("t", *State._fields, "tau_left", "tau_right", "V", "W")
    try:
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: np.asarray(stored[name], dtype=float) for name in names}
    except _UNREADABLE as error:
        raise InputError(f"{path}: is no trajectory.npz ({error}); simulate again") from None
    t, fleet_wide = arrays["t"], [arrays[name] for name in names[1:-2]]
    shape = fleet_wide[0].shape
    consistent = (
        t.ndim == 1
        and len(t) > 0
        and len(shape) == 2
        and shape[0] == len(t)
        and shape[1] > 0
        and all(a.shape == shape for a in fleet_wide)
        and all(arrays[name].shape == t.shape for name in "VW")
    )
    if not consistent:
        raise InputError(f"{path}: its arrays do not have one row per time; simulate again")
    state = State(*fleet_wide[:5])
    return Trajectory(t, state, arrays["tau_left"], arrays["tau_right"], arrays["V"], arrays["W"])
