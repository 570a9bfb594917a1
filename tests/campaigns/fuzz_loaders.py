"""Coverage-guided fuzzing of every loader: `python tests/campaigns/fuzz_loaders.py --seconds 60`; needs atheris.

Each loader runs in a process of its own, starting from good files, and may raise only its documented error.
Inputs that crash it are kept in --crashes DIR. pytest does not collect this file.
"""

from __future__ import annotations

import argparse
import contextlib
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

INSTALL = "fuzz_loaders.py needs atheris, a fuzzer for Python: install it with `pip install atheris`.\n"
LOADERS = ("fleet", "gains_toml", "gains_csv", "design_json", "starts", "urdf", "certificate")
DONE = re.compile(r"Done (\d+) runs|#(\d+)\s")


def seeds() -> dict[str, list[str]]:
    """Good files of each loader."""
    from tests.campaigns.certified_fleets import CASES
    from tests.cli.test_bad_input import FLEET, GAINS, STARTS, design
    from tests.models.robots.robot_files import ROBOT
    from tests.models.test_fleet_file import GOOD

    table = "vehicle,p_v,d_v,p_omega,d_omega,k_alpha\na,1,20,0.5,10,0.5\nb,1,20,0.5,10,0.5\n"
    certificates = [case().certificate.to_json() for case in CASES.values()]
    return {
        "fleet": [GOOD, FLEET],
        "gains_toml": [GAINS],
        "gains_csv": [table],
        "design_json": [design()],
        "starts": [STARTS],
        "urdf": [ROBOT],
        "certificate": certificates,
    }


def target(loader: str, folder: Path) -> Callable[[bytes], None]:
    """One input through a loader, from a file; documented errors are caught."""
    from gaincert.models.errors import InputError
    from gaincert.models.files.fleet_file import load_fleet as load
    from gaincert.models.files.gains_file import load_gains
    from gaincert.models.files.robots.description import read_robot
    from gaincert.models.files.starts_file import load_starts
    from gaincert.verify.kernel import UnreadableError, check_data, read

    from tests.cli.test_bad_input import good_fleet

    fleet = good_fleet()
    files: dict[str, tuple[str, Callable[[Path], Any]]] = {
        "fleet": ("fleet.toml", load),
        "gains_toml": ("gains.toml", lambda path: load_gains(path, fleet)),
        "gains_csv": ("gains.csv", lambda path: load_gains(path, fleet)),
        "design_json": ("design.json", lambda path: load_gains(path, fleet)),
        "starts": ("starts.csv", lambda path: load_starts(path, fleet)),
        "urdf": ("robot.urdf", read_robot),
        "certificate": ("certificate.json", lambda path: check_data(read(path))),
    }
    name, load_file = files[loader]
    path = folder / name

    def one_input(data: bytes) -> None:
        path.write_bytes(data)
        with contextlib.suppress(InputError, UnreadableError):
            load_file(path)

    return one_input


def fuzz(loader: str, folder: Path, options: list[str]) -> None:
    """Run one loader under atheris, which ends the process; its input file lies in a folder that the caller removes."""
    import atheris

    with atheris.instrument_imports(include=["gaincert.models", "gaincert.verify.kernel", "tomllib", "csv", "json"]):
        import gaincert.models.files.fleet_file
        import gaincert.models.files.gains_file
        import gaincert.models.files.robots.description
        import gaincert.models.starts
        import gaincert.verify.kernel  # noqa: F401
    atheris.Setup([sys.argv[0], *options], target(loader, folder))
    atheris.Fuzz()


def results(loader: str, seconds: int, crashes: Path) -> tuple[int, int]:
    """How many inputs were tried in a process of its own, and how many crashed it."""
    with tempfile.TemporaryDirectory() as folder:
        corpus = Path(folder) / "corpus"
        corpus.mkdir()
        for number, text in enumerate(seeds()[loader]):
            (corpus / str(number)).write_text(text)
        options = [f"-max_total_time={seconds}", "-timeout=30", "-rss_limit_mb=4096", "-print_final_stats=0"]
        options += [f"-artifact_prefix={crashes}/{loader}-", "-max_len=20000", str(corpus)]
        command = [sys.executable, __file__, "--loader", loader, "--folder", folder, "--", *options]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    tried = [int(a or b) for a, b in DONE.findall(done.stderr)]
    if done.returncode:
        sys.stderr.write(done.stderr[-3000:])
    return max(tried, default=0), int(done.returncode != 0)


def main() -> int:
    """Fuzz all loaders in turn and print the table; exit code 1 if one crashed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=int, default=60, help="of all loaders together")
    parser.add_argument("--crashes", type=Path, default=Path("build/fuzz"), help="where inputs that crash are kept")
    parser.add_argument("--loader", choices=LOADERS, help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("options", nargs="*", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    try:
        import atheris  # noqa: F401
    except ImportError:
        sys.stderr.write(INSTALL)
        return 2
    if arguments.loader:
        fuzz(arguments.loader, arguments.folder, arguments.options)
    arguments.crashes.mkdir(parents=True, exist_ok=True)
    rows = {}
    for loader in LOADERS:
        rows[loader] = results(loader, max(1, arguments.seconds // len(LOADERS)), arguments.crashes)
    print("| loader | inputs tried | crashes |\n|---|---|---|")
    print("\n".join(f"| {loader} | {tried} | {crashed} |" for loader, (tried, crashed) in rows.items()))
    return int(any(crashed for _, crashed in rows.values()))


if __name__ == "__main__":
    sys.exit(main())
