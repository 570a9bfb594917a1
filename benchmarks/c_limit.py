"""Compiles dopri5.c and calls it: the limit that the other integrators are measured against."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from gaincert.models.equations import State
from gaincert.verify.simulation.closed_loop import ClosedLoop

ARRAYS = ("weight", "leader_weight", "m", "inertia", "offset_x", "offset_y")
GAINS = ("p_v", "d_v", "p_omega", "d_omega", "k_alpha")
TONES = ("frequency", "sine", "cosine")


class _Loop(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_long) for name in ("n", "edges", "tones")),
        *((name, ctypes.c_void_p) for name in ("tail", "head", *ARRAYS, *GAINS, *TONES)),
        *((name, ctypes.c_double) for name in ("leader_x", "leader_y", "leader_theta")),
    ]


def compile_library() -> Any:
    """The compiled library, None if there is no C compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    folder = Path(tempfile.mkdtemp(prefix="gaincert-bench-"))
    source, library = Path(__file__).with_name("dopri5.c"), folder / "dopri5.so"
    # -ffast-math lets the compiler call the vector versions of tanh, sin and cos.
    flags = ["-O3", "-march=native", "-ffast-math", "-fopenmp-simd", "-shared", "-fPIC"]
    subprocess.run([compiler, *flags, str(source), "-o", str(library), "-lm"], check=True)
    found = ctypes.CDLL(str(library))
    found.integrate.restype = ctypes.c_long
    found.integrate.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_void_p, ctypes.c_double]
    found.rate.restype = None
    found.rate.argtypes = [ctypes.c_void_p, ctypes.c_double, *[ctypes.c_void_p] * 3]
    return found


class Compiled:
    """One loop, ready to be integrated in C."""

    def __init__(self, library: Any, loop: ClosedLoop) -> None:
        plant, graph, gains = loop.plant, loop.plant.graph, loop.gains
        tones = loop.excitation.phasors()
        values = {
            "tail": graph.tail,
            "head": graph.head,
            "weight": graph.weight,
            "leader_weight": graph.leader_weight,
            **{name: getattr(plant, name) for name in ARRAYS[2:]},
            **{name: getattr(gains, name) for name in GAINS},
            "frequency": [w for w, _ in tones],
            "sine": [a.real for _, a in tones],
            "cosine": [a.imag for _, a in tones],
        }
        kinds = {"tail": np.int64, "head": np.int64}
        self._kept = {name: np.ascontiguousarray(value, dtype=kinds.get(name, float)) for name, value in values.items()}
        pointers = {name: array.ctypes.data for name, array in self._kept.items()}
        place = {name: float(getattr(plant, name)) for name in ("leader_x", "leader_y", "leader_theta")}
        self._library, self._loop = library, loop
        self._struct = _Loop(n=graph.vehicles, edges=graph.edges, tones=len(tones), **pointers, **place)
        self._check()

    def rate(self, t: float, x: np.ndarray) -> np.ndarray:
        """The right-hand side."""
        out, n = np.empty_like(x), self._struct.n
        work = np.empty(4 * n + self._struct.edges)
        self._library.rate(ctypes.byref(self._struct), t, x.ctypes.data, out.ctypes.data, work.ctypes.data)
        return out

    def integrate(self, begin: float, end: float, start: np.ndarray, tolerance: float) -> tuple[np.ndarray, int]:
        """The state at the end and the number of steps."""
        x = start.copy()
        steps = self._library.integrate(ctypes.byref(self._struct), begin, end, x.ctypes.data, tolerance)
        return x, steps

    def _check(self) -> None:
        loop, x = self._loop, np.random.default_rng(0).normal(scale=3, size=5 * self._struct.n)
        state = State(*x.reshape(5, -1))
        rates = loop.rates(0.7, state)
        expected = np.concatenate(rates)
        assert np.abs(self.rate(0.7, x) - expected).max() <= 1e-10 * np.abs(expected).max()
