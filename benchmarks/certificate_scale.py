"""How long certifying and verifying takes, and the memory it needs.

    python -m benchmarks.certificate_scale [N ...] [--json]

A fleet of N robots on a ring with chords: five kinds of robots, every tenth one led, gains scaled from (16*).
Times are wall-clock and, as cpu, of the processor; what other programs on the machine take is in the first alone.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path
from typing import Any

from gaincert.models.arrays import column
from gaincert.models.fleet import Fleet
from gaincert.models.gains import Gains
from gaincert.verify.certificates.certify import certify

KINDS = [  # mass kg, inertia kg m^2, half track m, wheel radius m, torque limit N m
    ("10", "3", "0.3", "0.05", "55"),
    ("36", "15.625", "0.35", "0.15", "160"),
    ("23", "9.3125", "0.225", "0.1", "56"),
    ("1.8", "0.02", "0.08", "0.033", "1.5"),
    ("1.2", "0.011", "0.0725", "0.0325", "1.1"),
]


def large_fleet(n: int) -> Fleet:
    """A ring of n vehicles with a chord from every seventh vehicle to the one 20 further on."""
    keys = ("mass", "inertia", "half_track", "wheel_radius", "torque_limit")
    vehicles: list[dict[str, Any]] = [
        {"name": f"v{i}", **dict(zip(keys, KINDS[i % 5], strict=True)), "offset": [str(i % 1000), str(i // 1000)]}
        for i in range(n)
    ]
    edges = [[f"v{i}", f"v{(i + 1) % n}", "1"] for i in range(n)]
    edges += [[f"v{i}", f"v{(i + 20) % n}", "0.5"] for i in range(0, n, 7)]
    return Fleet.model_validate(
        {
            "name": "large",
            "leader": {"position": [0, 0], "heading": 0},
            "excitation": {"family": "harmonics", "frequency": "0.7", "sin": ["1.2071", "0", "0.2803", "0", "0.0732"]},
            "graph": {"edges": edges, "leader_links": {f"v{i}": "2" for i in range(0, n, 10)}},
            "vehicle": vehicles,
        }
    )


def scaled_gains(fleet: Fleet) -> Gains:
    """Gains with heading and speed damped and 70 to 90 % of the torque used, rounded to four digits."""
    rows = []
    for i, (vehicle, degree) in enumerate(zip(fleet.vehicles, fleet.graph.degree, strict=True)):
        arm, force = float(vehicle.half_track), 2 * float(vehicle.torque_limit.left) / float(vehicle.wheel_radius)
        share = force * (0.7 + 0.2 * (i % 101) / 101) / 4
        d = float(degree)
        kinds = (share / (1.5 * d), share, share * arm / d, share * arm, 0.3 * share * arm / d)
        rows.append([Fraction(f"{gain:.4g}") for gain in kinds])
    return Gains(*(column(entries) for entries in zip(*rows, strict=True)))


def clock() -> tuple[float, float]:
    """Seconds of the wall clock, and of the processor for this process and those that it has waited for."""
    spent = os.times()
    return time.perf_counter(), sum(spent[:4])


def elapsed(name: str, begin: tuple[float, float], end: tuple[float, float]) -> dict[str, float]:
    """Both times that a step has taken."""
    return {f"{name}_s": round(end[0] - begin[0], 2), f"{name}_cpu_s": round(end[1] - begin[1], 2)}


def measure(n: int) -> dict[str, Any]:
    """Times in s and memory in GB for one N."""
    start = clock()
    fleet = large_fleet(n)
    gains = scaled_gains(fleet)
    built = clock()
    certificate = certify(fleet, fleet.psi, gains, "corrected", seed=0)  # type: ignore[arg-type]
    certified = clock()
    rates = {name: rate and float(rate) for name, rate in certificate.rates.items()}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "certificate.json"
        certificate.write(path)
        size = path.stat().st_size
        written = clock()
        child = subprocess.run([sys.executable, "-c", CHILD, str(path)], capture_output=True, text=True)
        verified = clock()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return {
        "vehicles": n,
        "valid": certificate.valid and child.returncode == 0,
        **elapsed("build_fleet", start, built),
        **elapsed("certify", built, certified),
        **elapsed("write", certified, written),
        **elapsed("verify", written, verified),
        "certify_GB": round(peak, 2),
        "verify_GB": round(float(child.stdout or "nan"), 2),
        "file_MB": round(size / 1e6, 1),
        "rates": rates,
        "verdict": str(certificate.verdict)[:200] if not certificate.valid else child.stderr,
    }


CHILD = """
import re, sys
from pathlib import Path
from gaincert.verify import kernel
verdict = kernel.check_data(kernel.read(sys.argv[1]))
print(int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1]) / 2**20)
sys.exit(not verdict.valid)
"""

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("vehicles", nargs="*", type=int, default=[1000, 10_000, 100_000])
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    for n in options.vehicles:
        found = measure(n)
        print(json.dumps(found) if options.json else "  ".join(f"{key} {value}" for key, value in found.items()))
