"""Kills and interrupts three commands, then checks files, processes and messages, and whether a rerun completes.

    python tests/campaigns/faults.py [--rounds N] [--seed K] [--commands run design validate]

Every round ends a command at a random moment (SIGKILL or SIGINT; to all its processes, to the parent or to one
worker), checks what is left, and runs the same command again in the same folder. Exit code 1 if any round is not
clean. Linux only: processes are found in /proc.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from gaincert.verify import kernel

ROOT = Path(__file__).parents[2]
VEHICLES = 2
ATTEMPTS = 5  # at a round, until the command is still running when the fault comes
PATIENCE = 8.0  # s in which the processes of an ended command have to be gone
LONGEST = 600.0  # s that any command may take
POLL = 0.1  # s
ARRAYS = ("x", "y", "theta", "v", "omega", "tau_left", "tau_right")
COMMANDS: dict[str, list[str]] = {
    "run": ["run", "{fleet}", "-o", "{folder}", "--conditions", "corrected", "--mode", "draft"],
    "design": [
        "design",
        "{fleet}",
        "-o",
        "{folder}",
        "--mode",
        "best",
        "--time-limit",
        "20",
        "--conditions",
        "corrected",
    ],
    "validate": ["validate", "{fleet}", "--gains", "{gains}", "-o", "{folder}", "--starts", "300", "--horizon", "300"],
}


@dataclass(frozen=True)
class Fault:
    """A signal, whom it reaches, and the exit codes that are documented for it; a command may also end before it."""

    name: str
    signal: signal.Signals
    whom: str  # all, parent or worker
    codes: tuple[int, ...]


FAULTS = (
    Fault("SIGKILL, all processes", signal.SIGKILL, "all", (-9,)),
    Fault("SIGKILL, the parent", signal.SIGKILL, "parent", (-9,)),
    Fault("SIGKILL, one worker", signal.SIGKILL, "worker", (0, 4)),  # 0: it had no more work
    # 0: the search keeps the best so far. -2 is what a shell calls 130: Python remembers an interrupt that came while
    # it ran code from a string, as dataclasses do, although it was answered.
    Fault("SIGINT, all processes", signal.SIGINT, "all", (130, -2, 0)),
    Fault("SIGINT, one worker", signal.SIGINT, "worker", (0,)),
)


@dataclass
class Round:
    """The result of one fault, with a list of everything that is wrong."""

    code: int = 0
    hit: bool = False  # the command was still running
    temporary: int = 0  # files that a killed process could not remove
    broken: list[str] = field(default_factory=list)
    rerun: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    words: list[str] = field(default_factory=list)  # tracebacks and wrong exit codes

    @property
    def clean(self) -> bool:
        """Whether nothing is wrong."""
        return not (self.broken or self.rerun or self.left or self.words)


@dataclass(frozen=True)
class Undisturbed:
    """How a command runs when nobody disturbs it."""

    seconds: float
    workers: tuple[float, float]  # s, when the first worker came and the last one went
    files: frozenset[str]
    validation: str


class Bench:
    """A folder with a small fleet, its gains, and the undisturbed runs to compare with."""

    def __init__(self, place: Path) -> None:
        """Write the fleet; the gains come from an undisturbed design."""
        self.place, self.fleet = place, place / "fleet.toml"
        self._known: dict[str, Undisturbed] = {}
        template = ["init", str(self.fleet), "--template", "line", "--vehicles", str(VEHICLES), "-q"]
        subprocess.run([sys.executable, "-m", "gaincert", *template], check=True, cwd=ROOT)

    def command(self, name: str, folder: Path) -> list[str]:
        """The command line of a job that writes into a folder."""
        gains = self.place / "gains" / "design.json"
        if name == "validate" and not gains.exists():
            options = ["-o", str(gains.parent), "--conditions", "corrected", "--mode", "draft", "-q"]
            design = ["design", str(self.fleet), *options]
            subprocess.run([sys.executable, "-m", "gaincert", *design], check=True, cwd=ROOT)
        words = [word.format(fleet=self.fleet, folder=folder, gains=gains) for word in COMMANDS[name]]
        return [sys.executable, "-m", "gaincert", *words]

    def undisturbed(self, name: str) -> Undisturbed:
        """Run a command once without a fault, and watch its workers come and go."""
        if name not in self._known:
            folder = self.place / f"{name}-undisturbed"
            begin, seen = time.monotonic(), []
            process = start(self.command(name, folder))
            while process.poll() is None:
                if workers(process.pid):
                    seen.append(time.monotonic() - begin)
                time.sleep(POLL)
            out, err = process.communicate()
            broken = broken_files(folder)
            if process.returncode or broken:
                raise SystemExit(f"{name} fails without any fault: {process.returncode} {broken} {out}{err}")
            names = frozenset(str(path.relative_to(folder)) for path in files(folder))
            span = (seen[0], seen[-1]) if seen else (0.0, 0.0)
            self._known[name] = Undisturbed(time.monotonic() - begin, span, names, validation(folder))
        return self._known[name]

    def hit(self, name: str, fault: Fault, share: float) -> Round:
        """A round that hits: if the command ended before, try again earlier."""
        found = self.round(name, fault, share)
        for _ in range(ATTEMPTS - 1):
            if found.hit or not found.clean:
                break
            share *= 0.6
            found = self.round(name, fault, share)
        return found

    def round(self, name: str, fault: Fault, share: float) -> Round:
        """One fault at a share (0 to 1) of the time that it can reach somebody, and a rerun."""
        usual = self.undisturbed(name)
        moment = (
            share * (usual.workers[1] - usual.workers[0]) if fault.whom == "worker" else 0.3 + share * usual.seconds
        )
        folder = Path(tempfile.mkdtemp(dir=self.place))
        found = Round()
        process = start(self.command(name, folder))
        victims = wait_for(process, fault.whom, moment)
        session = members(process.pid)
        for victim in victims:
            found.hit |= send(victim, fault.signal)
        out, err = process.communicate(timeout=LONGEST)
        found.code = process.returncode
        found.left = lingering(process.pid, session)
        found.words = wrong_words(found, fault, out, err)
        found.broken = broken_files(folder)
        found.temporary = sum(path.name.startswith(".") for path in files(folder))
        if found.temporary and fault.signal != signal.SIGKILL:
            found.broken.append("a temporary file is left")
        if found.code == 0:
            found.broken += [f"{missing} is missing" for missing in usual.files - stable(folder)]
        again = subprocess.run(
            self.command(name, folder), capture_output=True, text=True, check=False, cwd=ROOT, timeout=LONGEST
        )
        found.rerun = wrong_rerun(again, folder, usual)
        return found


def start(command: list[str]) -> subprocess.Popen[str]:
    """A command in a session of its own, so that a signal to its group does not reach us."""
    return subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # jobs in the background ignore it
        cwd=ROOT,
    )


def members(session: int) -> list[int]:
    """The processes of a session that are alive."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, own = path.read_text().rpartition(")")[2].split()[:4]
        except OSError:  # it has just ended
            continue
        if int(own) == session and state not in "ZX":
            found.append(int(path.parent.name))
    return found


def workers(parent: int) -> list[int]:
    """The pool's processes of a command."""
    return [pid for pid in members(parent) if "spawn_main" in line_of(pid)]


def line_of(pid: int) -> str:
    """The command line of a process, empty if it has ended."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    except OSError:
        return ""


def wait_for(process: subprocess.Popen[str], whom: str, moment: float) -> list[int]:
    """Wait for the moment (s), counted from the first worker if one is wanted. Returns the processes to hit."""
    while whom == "worker" and process.poll() is None and not workers(process.pid):
        time.sleep(POLL)
    end = time.monotonic() + moment
    while process.poll() is None:
        if time.monotonic() >= end:
            if whom == "parent":
                return [process.pid]
            found = members(process.pid) if whom == "all" else workers(process.pid)[:1]
            if found:
                return found
        time.sleep(POLL)
    return []


def send(pid: int, what: signal.Signals) -> bool:
    """Send a signal. Returns whether the process was still there."""
    try:
        os.kill(pid, what)
    except ProcessLookupError:
        return False
    return True


def lingering(session: int, known: list[int]) -> list[str]:
    """Processes still alive PATIENCE seconds after the command ended. This function kills them."""
    end = time.monotonic() + PATIENCE
    while members(session) and time.monotonic() < end:
        time.sleep(POLL)
    left = members(session)
    lines = [f"{pid} {'' if pid in known else '(new) '}{line_of(pid)[:120]}" for pid in left]
    for pid in left:
        send(pid, signal.SIGKILL)
    return lines


def wrong_words(found: Round, fault: Fault, out: str, err: str) -> list[str]:
    """Tracebacks, and an exit code that is not documented."""
    wrong = [f"{word}: ...{err[-500:]}" for word in ("Traceback", "Exception ignored") if word in err + out]
    codes = fault.codes if found.hit else (0,)
    if found.code not in (*codes, 0):
        wrong.append(f"exit code {found.code}, not {codes}: {err[-500:]}")
    if found.code == 4 and "error:" not in err:
        wrong.append("exit code 4 without a reason")
    return wrong


def wrong_rerun(again: subprocess.CompletedProcess[str], folder: Path, usual: Undisturbed) -> list[str]:
    """The mistakes after a rerun: its exit code, missing or broken files, other numbers."""
    wrong = broken_files(folder) + [f"{name} is missing" for name in usual.files - stable(folder)]
    if again.returncode or "Traceback" in again.stderr:
        wrong.append(f"exit code {again.returncode}: {again.stderr[-500:]}")
    if validation(folder) != usual.validation:
        wrong.append("validation.json has other numbers")
    return wrong


def validation(folder: Path) -> str:
    """The content of validation.json, empty without one."""
    path = folder / "validation.json"
    return path.read_text() if path.exists() else ""


# -- files that are whole ---------------------------------------------------------------------------------------------


def files(folder: Path) -> list[Path]:
    """All files in a folder."""
    return [path for path in folder.rglob("*") if path.is_file()]


def stable(folder: Path) -> frozenset[str]:
    """The names of all results in a folder."""
    return frozenset(str(path.relative_to(folder)) for path in files(folder) if not path.name.startswith("."))


def broken_files(folder: Path) -> list[str]:
    """Every result that is not whole. Temporary files begin with a dot and do not count."""
    broken = []
    for path in files(folder):
        if path.name.startswith("."):
            continue
        try:
            if not CHECKS[path.suffix](path):
                broken.append(f"{path.name} is not whole")
        except Exception as error:
            broken.append(f"{path.name}: {type(error).__name__}: {error}")
    return broken


def whole_json(path: Path) -> bool:
    """It parses; a certificate verifies."""
    json.loads(path.read_text())
    return path.name != "certificate.json" or kernel.check_data(kernel.read(path)).valid


def whole_results_file(path: Path) -> bool:
    """All lines parse but one that is not finished, which the next run cuts off."""
    lines = path.read_bytes().split(b"\n")[:-1]
    return all(isinstance(json.loads(line), dict) for line in lines)


def whole_arrays(path: Path) -> bool:
    """All arrays of the contract, of the same length."""
    with np.load(path, allow_pickle=False) as run:
        count = len(run["t"])
        return all(run[name].shape == (count, VEHICLES) for name in ARRAYS) and len(run["V"]) == len(run["W"]) == count


def whole_table(path: Path) -> bool:
    """A row for every vehicle, each as long as the header."""
    head, *rows = csv.reader(path.read_text().splitlines())
    return len(rows) == VEHICLES and all(len(row) == len(head) for row in rows)


def ends_with(end: bytes) -> Callable[[Path], bool]:
    """A check that a file ends as its kind has to."""
    return lambda path: path.read_bytes().rstrip().endswith(end)


CHECKS: dict[str, Callable[[Path], bool]] = {
    ".json": whole_json,
    ".jsonl": whole_results_file,
    ".npz": whole_arrays,
    ".csv": whole_table,
    ".toml": lambda path: bool(tomllib.loads(path.read_text())),
    ".svg": ends_with(b"</svg>"),
    ".html": ends_with(b"</html>"),
    ".tex": ends_with(b"\\end{document}"),
    ".pdf": ends_with(b"%%EOF"),
    ".png": ends_with(b"IEND\xaeB`\x82"),
    ".md": lambda path: path.read_bytes().endswith(b"\n"),
}


# -- the table --------------------------------------------------------------------------------------------------------


def main() -> int:
    """Run all rounds and print the table; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=2, metavar="N", help="of every command and fault")
    parser.add_argument("--seed", type=int, default=0, metavar="K", help="of the moments")
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS))
    options = parser.parse_args()
    # A shell's background job ignores SIGINT, and its children would inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    moments, clean = random.Random(options.seed), True  # noqa: S311 -- no secret
    heads = ("command", "fault", "rounds", "hit", "exit codes", "files whole", "reruns completed", "processes left")
    print(f"| {' | '.join((*heads, 'tracebacks'))} |\n{'|---' * (len(heads) + 1)}|", flush=True)
    with tempfile.TemporaryDirectory() as place:
        bench = Bench(Path(place))
        for name in options.commands:
            for fault in FAULTS:
                found = [bench.hit(name, fault, moments.random()) for _ in range(options.rounds)]
                print(row(name, fault, found), flush=True)
                for number, one in enumerate(found):
                    clean &= one.clean
                    for what in (*one.broken, *one.rerun, *one.left, *one.words):
                        print(f"round {number}: {what}", file=sys.stderr, flush=True)
    return 0 if clean else 1


def row(name: str, fault: Fault, found: list[Round]) -> str:
    """A line of the table."""
    codes = ", ".join(f"{code} x{count}" for code, count in sorted(Counter(one.code for one in found).items()))
    temporary = sum(one.temporary for one in found)
    whole = f"{sum(not one.broken for one in found)}" + (f" ({temporary} temporary left)" if temporary else "")
    cells = [
        COMMANDS[name][0],
        fault.name,
        len(found),
        sum(one.hit for one in found),
        codes,
        whole,
        sum(not one.rerun for one in found),
        sum(len(one.left) for one in found),
        sum(bool(one.words) for one in found),
    ]
    return f"| {' | '.join(map(str, cells))} |"


if __name__ == "__main__":
    sys.exit(main())
