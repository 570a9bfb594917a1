"""Checks the proof of the theorem with Coq and records what each statement rests on; standard library only.

    python verify/formal/check.py      # what `make formal` runs

It looks in the sources for words that would leave a gap, compiles all of them afresh, has Coq compare the five claims
with `Statement.v`, reads the assumptions that Coq prints, and writes `checked.json`. Nothing is installed.
Exit codes: 0 proved; 1 not proved, with the reason; 2 Coq or one of its libraries is missing.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
RECORD = FOLDER / "checked.json"
# What is claimed: the theorem, by file and name, and its statement in Statement.v.
CLAIMS = {
    ("Theorem", "corrected_theorem_holds"): "corrected_theorem",
    ("Existence", "existence_holds"): "existence",
    ("Uniqueness", "uniqueness_holds"): "uniqueness",
    ("TorqueSharp", "torque_sharp_holds"): "torque_sharp",
    ("NotExponential", "not_exponential_holds"): "not_exponential",
}
ASKED = ("Assumptions.v", "PaperAssumptions.v")  # the files that print what each theorem assumes
# What the standard real numbers, classical logic and functional extensionality bring; nothing else may be assumed.
STANDARD_AXIOMS = frozenset(
    {
        "ClassicalDedekindReals.sig_forall_dec",
        "ClassicalDedekindReals.sig_not_dec",
        "Classical_Prop.classic",
        "FunctionalExtensionality.functional_extensionality_dep",
    }
)
# Commands that assume a statement, leave a proof open or switch a check of Coq off.
GAPS = re.compile(
    r"\b(Admitted|admit|give_up|Axioms?|Parameters?|Conjectures?|Primitive|Unset\s+\w+\s+Checking|bypass_check)\b"
)
LIBRARIES = ("Coquelicot.Coquelicot", "Interval.Tactic")
MISSING = """{} not found. The proof check needs Coq 8.16 or later with Coquelicot and Interval; install them first:
  Debian, Ubuntu: apt-get install coq libcoq-coquelicot libcoq-interval
  opam:           opam repo add coq-released https://coq.inria.fr/opam/released
                  opam install coq coq-coquelicot coq-interval"""


class NotProvedError(Exception):
    """The sources do not prove what is claimed; the message says why."""


class MissingToolError(Exception):
    """Coq or a library is not installed; the message says which packages to install."""


def digest(folder: Path = FOLDER) -> str:
    """SHA-256 over name and content of every .v file, each ended by a zero byte, in the order of the names."""
    total = hashlib.sha256()
    for path in sorted(folder.glob("*.v")):
        total.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return f"sha256:{total.hexdigest()}"


def without_comments(text: str) -> str:
    """The source without its comments (which nest) and without what its strings say."""
    kept, depth = [], 0
    for part in re.split(r'(\(\*|\*\)|"[^"]*")', text):
        if part == "(*":
            depth += 1
        elif part == "*)":
            depth -= 1
        elif depth == 0:
            kept.append('""' if part.startswith('"') else part)
    return "".join(kept)


def gaps(folder: Path = FOLDER) -> list[str]:
    """Every place that assumes a statement instead of proving it: "File.v: Admitted"."""
    return [
        f"{path.name}: {found.group()}"
        for path in sorted(folder.glob("*.v"))
        for found in GAPS.finditer(without_comments(path.read_text()))
    ]


def theorems(folder: Path = FOLDER) -> list[str]:
    """The theorems whose assumptions are printed, in order. Raises NotProvedError where a claim is not among them."""
    texts = [without_comments((folder / name).read_text()) for name in ASKED if (folder / name).exists()]
    names = [name for text in texts for name in re.findall(r"Print Assumptions (\w+)\.", text)]
    if missing := [name for _, name in CLAIMS if name not in names]:
        raise NotProvedError(f"no Print Assumptions for {', '.join(missing)} in {' or '.join(ASKED)}")
    return names


def comparison() -> str:
    """A Coq file that compiles only if each claim is proved as Statement.v states it."""
    lines = [f"Require Gaincert.{module}." for module in ("Statement", *(module for module, _ in CLAIMS))]
    lines += [
        f"Definition claim_{name} : Gaincert.Statement.{statement} := Gaincert.{module}.{name}."
        for (module, name), statement in CLAIMS.items()
    ]
    return "\n".join(lines) + "\n"


def assumptions(answer: str) -> list[list[str]]:
    """For every `Print Assumptions`, in order: the names that Coq lists, sorted."""
    blocks: list[list[str]] = []
    for line in answer.splitlines():
        if line.startswith(("Closed under the global context", "Axioms:")):
            blocks.append([])
        elif line and not line[0].isspace() and blocks:
            blocks[-1].append(re.split(r"\s|:", line, maxsplit=1)[0])
    return [sorted(block) for block in blocks]


def run(command: list[str], folder: Path) -> str:
    """What a command prints. Raises NotProvedError, with the end of what it said, where it fails."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)  # noqa: S603
    if done.returncode != 0:
        said = "\n".join((done.stdout + done.stderr).splitlines()[-20:])
        raise NotProvedError(f"{' '.join(command)} failed:\n{said}")
    return done.stdout


def coq_version(folder: Path) -> str:
    """The version of Coq. Raises MissingToolError where Coq, make or one of the libraries is not there."""
    for tool in ("coqc", "coqdep", "make"):
        if shutil.which(tool) is None:
            raise MissingToolError(MISSING.format(tool))
    for library in LIBRARIES:
        (folder / "Library.v").write_text(f"Require {library}.\n")
        try:
            run(["coqc", "-q", "Library.v"], folder)
        except NotProvedError as error:
            raise MissingToolError(MISSING.format(f"Coq library {library}")) from error
    return run(["coqc", "--print-version"], folder).split()[0]


def check(folder: Path = FOLDER) -> dict[str, object]:
    """The record of a complete proof. Raises NotProvedError or MissingToolError."""
    if found := gaps(folder):
        raise NotProvedError("these assume instead of proving: " + ", ".join(found))
    names, sources = theorems(folder), digest(folder)
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary)
        version = coq_version(work)
        answer = compiled(folder, work / "formal")
    axioms = assumptions(answer)
    if len(axioms) != len(names):
        raise NotProvedError(f"Coq answered for {len(axioms)} of {len(names)} theorems")
    record = dict(zip(names, axioms, strict=True))
    for name, assumed in record.items():
        if more := set(assumed) - STANDARD_AXIOMS:
            raise NotProvedError(f"{name} assumes {', '.join(sorted(more))}, which is not one of the standard axioms")
    return {"digest": sources, "coq": version, "theorems": record}


def as_text(record: dict[str, object]) -> str:
    """The record as its file has it."""
    return json.dumps(record, indent=1) + "\n"


def compiled(folder: Path, work: Path) -> str:
    """Compiles a copy of the sources from nothing and compares the claims; what Coq prints of the assumptions."""
    coqc = ["coqc", "-q", "-Q", ".", "Gaincert"]
    sources = {path.name for path in folder.glob("*.v")} - set(ASKED) | {"Makefile"}
    shutil.copytree(folder, work, ignore=lambda _, names: set(names) - sources)
    run(["make", "--silent", f"-j{os.cpu_count() or 1}"], work)
    (work / "Comparison.v").write_text(comparison())
    run([*coqc, "Comparison.v"], work)
    asked = [name for name in ASKED if (folder / name).exists()]
    for name in asked:
        shutil.copy(folder / name, work)
    return "".join(run([*coqc, name], work) for name in asked)


def main() -> int:
    """Check, print and record; the exit code."""
    try:
        record = check()
    except MissingToolError as error:
        print(error, file=sys.stderr)  # noqa: T201
        return 2
    except NotProvedError as error:
        print(f"not proved: {error}", file=sys.stderr)  # noqa: T201
        return 1
    for name, axioms in record["theorems"].items():  # type: ignore[attr-defined]
        print(f"{name}: {', '.join(axioms) or 'no assumption'}")  # noqa: T201
    print(f"proved with Coq {record['coq']}, sources {record['digest']}; recorded in {RECORD.name}")  # noqa: T201
    RECORD.write_text(as_text(record))
    return 0


if __name__ == "__main__":
    sys.exit(main())
