"""The engine for large fleets against compiled C doing the same work: time, growth with N + E, memory.

    python -m benchmarks.scale [N ...] [--seconds S] [--json]

Both take the same steps of the same method (Dormand and Prince, order 5) from the same start; processor time of one
thread. The fleet is that of certificate_scale.py.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from typing import Any

import numpy as np
from gaincert.models.starts import random_starts
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.integrators import Adams
from gaincert.verify.simulation.large_fleet import Dopri5

from benchmarks.c_limit import Compiled, compile_library
from benchmarks.certificate_scale import large_fleet, scaled_gains

TOLERANCE = 1e-8
CVODES_UP_TO = 1000  # vehicles; up to this size the result is compared with CVODES


def measure(n: int, seconds: float) -> dict[str, Any]:
    """Times in s for `seconds` s of motion of n vehicles."""
    fleet = large_fleet(n)
    loop = ClosedLoop.of(fleet, scaled_gains(fleet), fleet.psi)  # type: ignore[arg-type]
    start = random_starts(fleet, 1, 0)[0]
    x, library, row = np.concatenate(start), compile_library(), {"vehicles": n, "edges": loop.plant.graph.edges}
    # Run both alternately, a quarter each, so that machine load affects both alike.
    ours, limit, spent, spent_limit = x, x, 0.0, 0.0
    engine = Dopri5(loop, step=seconds, piece=seconds, tolerance=TOLERANCE)
    compiled = Compiled(library, loop) if library else None
    for quarter in range(4):
        begin, end = seconds * quarter / 4, seconds * (quarter + 1) / 4
        clock = time.process_time()
        ours = engine.solve(begin, ours, np.array([end]))[-1]
        spent += time.process_time() - clock
        if compiled:
            clock = time.process_time()
            limit, _ = compiled.integrate(begin, end, limit, TOLERANCE)
            spent_limit += time.process_time() - clock
    row |= {"steps": engine.steps, "ours_s": spent, "limit_s": spent_limit if compiled else None}
    row |= {"ratio": spent / spent_limit, "difference": float(np.abs(ours - limit).max())} if compiled else {}
    if n <= CVODES_UP_TO:
        _, states = next(Adams(loop, step=seconds, piece=seconds, tolerance=1e-12).pieces(start))
        row["to_cvodes"] = float(np.abs(np.concatenate([column[-1] for column in states]) - ours).max())
    row["memory_GB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return row


def exponent(rows: list[dict[str, Any]]) -> float:
    """The slope of log(time per step) against log(N + E) over the sizes from 1000 on."""
    large = [row for row in rows if row["vehicles"] >= 1000] if len(rows) > 2 else rows
    size = np.log([row["vehicles"] + row["edges"] for row in large])
    return float(np.polyfit(size, np.log([row["ours_s"] / row["steps"] for row in large]), 1)[0])


def table(rows: list[dict[str, Any]], seconds: float) -> str:
    """The measurement as text."""
    lines = [f"large fleets, {seconds:g} s of motion at {TOLERANCE:g}; processor time of one thread"]
    lines.append(f"{'N':>8}{'steps':>7}{'ours s':>9}{'C s':>9}{'ratio':>7}{'to C':>10}{'to CVODES':>11}{'GB':>6}")
    for row in rows:
        limit, ratio, gap = (row.get(key) or float("nan") for key in ("limit_s", "ratio", "difference"))
        lines.append(
            f"{row['vehicles']:8}{row['steps']:7}{row['ours_s']:9.2f}{limit:9.2f}{ratio:7.2f}{gap:10.1e}"
            f"{row.get('to_cvodes', float('nan')):11.1e}{row['memory_GB']:6.2f}"
        )
    if len(rows) > 1:
        lines.append(f"time per step grows as (N + E)^{exponent(rows):.2f}")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("vehicles", nargs="*", type=int, default=[100, 1000, 10_000])
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(arguments)
    rows = [measure(n, options.seconds) for n in options.vehicles or [100, 1000, 10_000]]
    print(json.dumps(rows) if options.json else table(rows, options.seconds))


if __name__ == "__main__":
    main()
