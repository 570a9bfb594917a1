"""The ranking integrator of `design`: the closed loop of many candidates side by side, compiled and over NumPy.

    python -m benchmarks.rollouts [FLEET.toml ...]

Both evaluate the same equations in single precision over the same arrays, in one thread and in turn.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
from gaincert.models.algebra.ops import sparse_ops
from gaincert.models.equations import State, closed_loop
from gaincert.models.files.fleet_file import load_fleet as load
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.synthesis.programs.excitation import flat_tones
from gaincert.synthesis.rollouts.closed_loop import ClosedLoop, Controls
from gaincert.synthesis.rollouts.compiler import Single
from gaincert.synthesis.settings import FAST

EXAMPLES = Path(__file__).parents[1] / "examples"
ROUNDS, REPEATS = 15, 20


def measure(fleet: Fleet) -> dict[str, float]:
    """Nanoseconds for the rates of one vehicle, by both, and how far they are apart, of the largest rate."""
    vehicles, columns = len(fleet), FAST.simulated_vehicles // len(fleet)
    random, psi = np.random.default_rng(0), flat_tones()
    state = random.normal(0, 4, (len(State._fields), vehicles, columns)).astype(Single)
    gains = random.uniform(0.5, 2, (len(GAIN_NAMES), vehicles, columns)).astype(Single)
    times, rates = random.uniform(0, 6, columns), np.empty_like(state)
    controls = Controls.of([Gains(*gains[..., k]) for k in range(columns)], [1.0] * columns)
    fill = ClosedLoop(fleet.plant(), psi).problem(controls)(state, rates)

    single = fleet.plant().map(lambda values: np.asarray(values, dtype=Single))
    ops, wave = sparse_ops(single.graph, Single), psi.map(Single)
    # As large as the states: NumPy is slower where it broadcasts.
    plant = single.map(lambda values: np.repeat(values[:, None], columns, axis=1).T if values.ndim else values)
    own, states, phase = Gains(*(row.T for row in gains)), State(*(row.T for row in state)), times.astype(Single)

    def plain() -> State:
        return closed_loop(ops, plant, own, wave.value(ops, phase[:, None]), states)

    assert psi.frequency == Fraction(1)
    fill(times)
    pairs = list(zip(rates, plain(), strict=True))
    apart = float(max(np.abs(row.T - other).max() / np.abs(other).max() for row, other in pairs))
    runs = [(_seconds(lambda: fill(times)), _seconds(plain)) for _ in range(ROUNDS)]
    compiled, numpy = (1e9 * statistics.median(column) / state[0].size for column in zip(*runs, strict=True))
    return {"compiled_ns": compiled, "numpy_ns": numpy, "ratio": numpy / compiled, "apart": apart}


def _seconds(run: Callable[[], object]) -> float:
    begin = time.perf_counter()
    for _ in range(REPEATS):
        run()
    return (time.perf_counter() - begin) / REPEATS


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    examples = ("paper", "turtlebot3_line", "mixed_ring")
    parser.add_argument("fleets", nargs="*", type=Path, default=[EXAMPLES / f"{name}.toml" for name in examples])
    fleets = {path.stem: load(path) for path in parser.parse_args().fleets}
    begin = time.perf_counter()
    ClosedLoop(next(iter(fleets.values())).plant(), flat_tones())
    print(f"compiling the closed loop: {time.perf_counter() - begin:.2g} s")
    for name, fleet in fleets.items():
        found = measure(fleet)
        print(f"{name}: " + "  ".join(f"{key} {value:.3g}" for key, value in found.items()))
