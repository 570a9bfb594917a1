"""Our integrators against their peers: the paper's fleet, 300 s, at a matched global error, in one interleaved run.

    python -m benchmarks.integrators [--horizon S] [--rounds N] [--plot FILE.svg] [--json]

Every peer gets the loosest tolerance at which its end is within 1e-6 (m, rad) of a reference at 1e-13. Then all run in
turn, several rounds, and the least processor time of each counts, so that a busy machine does not decide. Peers that
are not installed are left out by name.
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from gaincert.models.algebra.ops import numpy_ops, sympy_ops
from gaincert.models.equations import Plant, State, closed_loop
from gaincert.models.gains import Gains
from gaincert.models.paper import paper_fleet, paper_gains
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.integrators import Adams, Cvodes, Dop853
from gaincert.verify.simulation.large_fleet import Dopri5

from benchmarks.c_limit import Compiled, compile_library

ERROR = 1e-6  # m, rad
TOLERANCES = [10.0**-k for k in np.arange(6, 13.1, 0.5)]
SPENT = 30.0  # s of processor time that one run may take

Run = Callable[[float], np.ndarray]  # tolerance -> the state at the end, (5 N,)
LIMIT, OURS = "C DOPRI5 (limit)", "gaincert CVODES, BDF"


def of_ours(kind: Any, loop: ClosedLoop, start: State, horizon: float) -> Run:
    """One of our integrators, built once per tolerance as in use."""
    built: dict[float, Any] = {}

    def run(tolerance: float) -> np.ndarray:
        if tolerance not in built:
            built[tolerance] = kind(loop, step=horizon, piece=horizon, tolerance=tolerance)
        _, states = next(built[tolerance].pieces(start))
        return np.concatenate([column[-1] for column in states])

    return run


def compiled(loop: ClosedLoop, start: State, horizon: float) -> Run:
    """The limit; raises ImportError where there is no C compiler."""
    library = compile_library()
    if library is None:
        raise ImportError("no C compiler")
    limit = Compiled(library, loop)
    return lambda tolerance: limit.integrate(0.0, horizon, np.concatenate(start), tolerance)[0]


def scipy(method: str, rate: Callable[..., Any], start: State, horizon: float) -> Run:
    """solve_ivp of SciPy."""
    from scipy.integrate import solve_ivp

    x = np.concatenate(start)
    return lambda tol: solve_ivp(rate, (0, horizon), x, method, [horizon], rtol=tol, atol=tol).y[:, -1]


def numpy_rate(loop: ClosedLoop) -> Callable[..., Any]:
    """The vectorised right-hand side that a Python user would write."""
    return lambda t, x: np.concatenate(loop.rates(t, State(*x.reshape(5, -1))))


def numba_rate(loop: ClosedLoop) -> Callable[..., Any]:
    """The same equations through SymPy to scalar code with common parts shared, compiled by numba."""
    import sympy as sp
    from numba import njit
    from numba.np.unsafe.ndarray import to_fixed_tuple

    size = 5 * loop.vehicles
    t, x = sp.Symbol("t"), sp.symbols(f"x:{size}")
    exact = np.frompyfunc(sp.Float, 1, 1)
    plant: Plant = loop.plant.map(exact)
    gains: Gains = loop.gains.map(exact)
    state = State(*np.array(x, dtype=object).reshape(5, -1))
    psi = loop.excitation.value(sympy_ops(), np.array([t]))
    rates = np.concatenate(closed_loop(sympy_ops(), plant, gains, psi, state))
    inner = njit(sp.lambdify([t, x], list(rates), modules="math", cse=True))

    @njit
    def rate(t, x):
        return np.array(inner(t, to_fixed_tuple(x, size)))

    rate(0.0, np.zeros(size))
    return rate


def diffrax_run(loop: ClosedLoop, start: State, horizon: float) -> Run:
    """Diffrax's Dopri8 with its own step control, compiled once."""
    import diffrax
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    graph = loop.plant.graph

    def edge_sum(_graph: Any, f: Any) -> Any:
        return jnp.zeros(graph.vehicles).at[graph.tail].add(f).at[graph.head].add(-f)

    ops = replace(numpy_ops(), sin=jnp.sin, cos=jnp.cos, tanh=jnp.tanh, edge_sum=edge_sum)

    def rate(t: Any, x: Any, _: Any) -> Any:
        return jnp.concatenate(
            closed_loop(ops, loop.plant, loop.gains, loop.excitation.value(ops, t), State(*x.reshape(5, -1)))
        )

    @jax.jit
    def solve(x: Any, tolerance: Any) -> Any:
        control = diffrax.PIDController(rtol=tolerance, atol=tolerance)
        return diffrax.diffeqsolve(
            diffrax.ODETerm(rate), diffrax.Dopri8(), 0.0, horizon, 1e-4, x, stepsize_controller=control, max_steps=None
        ).ys[-1]

    x = jnp.asarray(np.concatenate(start))
    return lambda tolerance: np.asarray(solve(x, tolerance))


def numbalsoda_run(loop: ClosedLoop, start: State, horizon: float) -> Run:
    """LSODA without Python between the steps."""
    from numba import carray, cfunc
    from numbalsoda import lsoda, lsoda_sig

    rate, size = numba_rate(loop), 5 * loop.vehicles

    @cfunc(lsoda_sig)
    def called(t, u, du, _):
        out = rate(t, carray(u, (size,)))
        for i in range(size):
            du[i] = out[i]

    x, ends = np.concatenate(start), np.array([0.0, horizon])
    return lambda tolerance: lsoda(called.address, x, ends, rtol=tolerance, atol=tolerance)[0][-1]


def peers(loop: ClosedLoop, start: State, horizon: float) -> tuple[dict[str, Run], list[str]]:
    """The runs by name, and why some are missing."""
    makers: dict[str, Callable[[], Run]] = {
        LIMIT: lambda: compiled(loop, start, horizon),
        OURS: lambda: of_ours(Cvodes, loop, start, horizon),
        "gaincert CVODES, Adams": lambda: of_ours(Adams, loop, start, horizon),
        "gaincert scale (NumPy)": lambda: of_ours(Dopri5, loop, start, horizon),
        "numbalsoda": lambda: numbalsoda_run(loop, start, horizon),
        "SciPy LSODA + numba": lambda: scipy("LSODA", numba_rate(loop), start, horizon),
        "SciPy DOP853 + numba": lambda: scipy("DOP853", numba_rate(loop), start, horizon),
        "diffrax Dopri8": lambda: diffrax_run(loop, start, horizon),
        "SciPy LSODA + NumPy": lambda: scipy("LSODA", numpy_rate(loop), start, horizon),
    }
    runs, missing = {}, []
    for name, make in makers.items():
        try:
            runs[name] = make()
        except ImportError as error:
            missing.append(f"{name}: left out ({error})")
    return runs, missing


def matched(run: Run, reference: np.ndarray) -> tuple[float, float] | None:
    """(tolerance, error) of the loosest tolerance with an error below ERROR; None if none is in time."""
    for tolerance in TOLERANCES:
        begin = time.process_time()
        error = float(np.abs(run(tolerance) - reference).max())
        if error <= ERROR:
            return tolerance, error
        if time.process_time() - begin > SPENT:
            return None
    return None


def measure(horizon: float = 300.0, rounds: int = 5) -> dict[str, Any]:
    """Processor time of every peer at the matched error, and its ratio to the limit and to ours."""
    fleet = paper_fleet()
    loop, start = ClosedLoop.of(fleet, paper_gains(), fleet.psi), fleet.start()  # type: ignore[arg-type]
    assert start is not None
    reference = of_ours(Dop853, loop, start, horizon)(1e-13)
    runs, missing = peers(loop, start, horizon)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        chosen = {name: found for name, run in runs.items() if (found := matched(run, reference))}
        missing += [f"{name}: does not reach {ERROR:g}" for name in runs if name not in chosen]
        times: dict[str, list[float]] = {name: [] for name in chosen}
        for _ in range(rounds):
            for name, (tolerance, _error) in chosen.items():
                begin = time.process_time()
                runs[name](tolerance)
                times[name].append(time.process_time() - begin)
    base = min(times.get(LIMIT, [float("nan")]))
    ours = min(min(times[name]) for name in times if name.startswith("gaincert CVODES"))
    rows = [
        {"name": name, "tolerance": tolerance, "error": error, "seconds": min(times[name])}
        for name, (tolerance, error) in chosen.items()
    ]
    for row in rows:
        row |= {"to_limit": row["seconds"] / base, "to_ours": row["seconds"] / ours}
    return {"horizon_s": horizon, "rows": sorted(rows, key=lambda row: row["seconds"]), "missing": missing}


def table(found: dict[str, Any]) -> str:
    """The measurement as text."""
    lines = [f"paper's fleet, {found['horizon_s']:g} s, end within {ERROR:g}; least processor time of the rounds"]
    lines.append(f"{'':26}{'tolerance':>10}{'error':>10}{'ms':>10}{'x limit':>9}{'x ours':>9}")
    for row in found["rows"]:
        lines.append(
            f"{row['name']:26}{row['tolerance']:10.1e}{row['error']:10.1e}{1e3 * row['seconds']:10.1f}"
            f"{row['to_limit']:9.2f}{row['to_ours']:9.2f}"
        )
    return "\n".join([*lines, *found["missing"]])


def plot(found: dict[str, Any], path: Path) -> None:
    """The ratios to the limit as bars."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib.figure import Figure

    rows = found["rows"][::-1]
    figure = Figure(figsize=(7, 0.4 * len(rows) + 1.2), layout="constrained")
    axis = figure.subplots()
    bars = axis.barh([row["name"] for row in rows], [row["to_limit"] for row in rows], color="tab:blue")
    axis.bar_label(bars, fmt="%.3g", padding=3)
    axis.set(xscale="log", xlabel=f"processor time over that of compiled C, error {ERROR:g} after 300 s")
    figure.savefig(path)


def main(arguments: list[str] | None = None) -> None:
    """Measure, print, plot."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--horizon", type=float, default=300.0)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(arguments)
    found = measure(options.horizon, options.rounds)
    print(json.dumps(found) if options.json else table(found))
    if options.plot:
        plot(found, options.plot)


if __name__ == "__main__":
    main()
