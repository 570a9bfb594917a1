"""All benchmarks: `make bench`, or `python -m benchmarks [--plots DIR] [--large]`, from the repository's root."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path


def main() -> None:
    """Run each benchmark in a process of its own, so that none sees another's memory."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plots", type=Path, default=Path("out/bench"), help="where the plots go")
    parser.add_argument("--large", action="store_true", help="also simulate fleets of 100 000: some minutes")
    options = parser.parse_args()
    options.plots.mkdir(parents=True, exist_ok=True)
    large = ["100000"] if options.large else []
    for module, *arguments in (
        ["integrators", "--plot", str(options.plots / "integrators.svg")],
        ["rollouts"],
        ["scale", "100", "1000", "10000", *large],
        ["certificate_scale", "10000", "100000", "1000000"],
    ):
        print(f"\n== {module} ==", flush=True)
        subprocess.run([sys.executable, "-m", f"benchmarks.{module}", *arguments], check=True)
    print(f"\nplots: {options.plots}")


if __name__ == "__main__":
    main()
