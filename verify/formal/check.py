"""Checks the proof of the theorem with Coq and records what each claim rests on; standard library only.

    python3 -I verify/formal/check.py               # what `make formal` runs
    python3 -I verify/formal/check.py --libraries   # coqchk goes through the libraries of Coq, too: a minute more

What is claimed stands in `Statement.v`, `Definitions.v` and `Claims.v`, word for word: a change of them is a change of
the claim, and is refused here until `CLAIM` has its digest. The sources are looked through for words that would leave a
gap and compiled afresh; the axioms that Coq prints for each claim are read; and `coqchk` checks all that was compiled
once more, without tactics. Then `checked.json` is written. Nothing is installed.
Exit codes: 0 proved; 1 not proved, with the reason; 2 Coq or one of its libraries is missing.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
RECORD = FOLDER / "checked.json"
CLAIM = {
    "Statement": "sha256:362fc641e2001a45d686406003aeda235efddd07845de419d913ede6beddd926",
    "Definitions": "sha256:49926fc4c3495cafcf10c16cce3859086972671a3f7bc09eed5fd49492dcf0a6",
    "Claims": "sha256:f5a5097f058febce36a0e87175701d2dc832f86dbdcb09731768dcbd6948efbc",
}
# What the standard real numbers, classical logic and functional extensionality bring; nothing else may be assumed.
STANDARD_AXIOMS = frozenset(
    {
        "ClassicalDedekindReals.sig_forall_dec",
        "ClassicalDedekindReals.sig_not_dec",
        "Classical_Prop.classic",
        "FunctionalExtensionality.functional_extensionality_dep",
    }
)
# Words, also in comments, of commands that assume a statement, leave a proof open, switch a check off, hide in a module
# of their own what coqchk would list, or bring in what is not among the sources.
GAPS = re.compile(
    r"(?<![A-Za-z_'])(Admitted|admit|give_up|Axioms?|Parameters?|Conjectures?|Primitive|Checking|bypass_check|ML|Load"
    r"|Module(?! [A-Z]\w* := [\w. ]+\.\s))(?![\w'])",
    re.ASCII,
)
LIBRARIES = ("Coquelicot.Coquelicot", "Interval.Tactic")
COQ = ["-q", "-Q", ".", "Gaincert"]
SECONDS = 1800  # that one file or one check may take
MISSING = """{} not found. The proof check needs Coq (known to pass: 8.16), Coquelicot and Interval; install them first:
  Debian, Ubuntu: apt-get install coq libcoq-coquelicot libcoq-interval
  opam:           opam repo add coq-released https://coq.inria.fr/opam/released
                  opam install coq coq-coquelicot coq-interval"""


class NotProvedError(Exception):
    """The sources do not prove what is claimed; the message says why."""


class MissingToolError(Exception):
    """Coq or a library is not installed; the message says which packages to install."""


def sources(folder: Path = FOLDER) -> dict[str, str]:
    """The text of every source by its name without .v. Raises NotProvedError for other names and other files."""
    found = {}
    for path in sorted(folder.glob("*.v")):
        if not path.is_file() or not re.fullmatch(r"[A-Za-z]\w*", path.stem, re.ASCII):
            raise NotProvedError(f"{path.name!r}: a source is a file named by letters, digits and _")
        try:
            found[path.stem] = path.read_text(encoding="utf-8")
        except (OSError, UnicodeError) as error:
            raise NotProvedError(f"{path.name} cannot be read: {error}") from error
    return found


def digest(texts: Mapping[str, str]) -> str:
    """SHA-256 over name and content of every source, each ended by a zero byte, in the order of the names."""
    total = hashlib.sha256()
    for name, text in sorted(texts.items()):
        total.update(f"{name}.v\0{text}\0".encode())
    return f"sha256:{total.hexdigest()}"


def without_comments(text: str) -> str:
    """The source without its comments (which nest) and without what its strings say."""
    kept, depth = [], 0
    for part in re.split(r'(\(\*|\*\)|"[^"]*")', text):
        if part == "(*":
            depth += 1
        elif part == "*)" and depth:
            depth -= 1
            kept.append(" ")
        elif depth == 0:
            kept.append('""' if part.startswith('"') else part)
    return "".join(kept)


def gaps(texts: Mapping[str, str]) -> list[str]:
    """Every place that assumes a statement instead of proving it: "File.v: Admitted"."""
    return [f"{name}.v: {found.group()}" for name in texts for found in GAPS.finditer(texts[name])]


def claims(texts: Mapping[str, str]) -> list[str]:
    """The theorems of Claims.v, in order. Raises NotProvedError where what is claimed is not what CLAIM has."""
    for name, expected in CLAIM.items():
        if name not in texts:
            raise NotProvedError(f"{name}.v is missing: it says what is claimed")
        found = f"sha256:{hashlib.sha256(texts[name].encode()).hexdigest()}"
        if found != expected:
            raise NotProvedError(f"{name}.v has {found}, another claim than that of {expected} (CLAIM in check.py)")
    return re.findall(r"^Print Assumptions (\w+)\.$", without_comments(texts["Claims"]), re.MULTILINE)


def assumptions(answer: str) -> list[list[str]]:
    """For every `Print Assumptions`, in order: the names that Coq lists, sorted."""
    blocks: list[list[str]] = []
    for line in answer.split("\n"):
        if line in ("Closed under the global context", "Axioms:"):
            blocks.append([])
        elif line and not line.startswith("  ") and blocks:
            blocks[-1].append(line.split(" ")[0])  # a name may hold any sign but a blank
    return [sorted(block) for block in blocks]


def run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """A command that succeeded, in an environment without settings of Coq.

    Raises NotProvedError, with the end of what it said, where it fails or does not end.
    """
    environment = {"PATH": os.environ.get("PATH", ""), "HOME": str(folder), "LC_ALL": "C.UTF-8"}
    try:
        done = subprocess.run(  # noqa: S603
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=SECONDS, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise NotProvedError(f"{' '.join(command[:2])} ... did not end within {SECONDS} s") from error
    if done.returncode != 0:
        said = "\n".join((done.stdout + done.stderr).splitlines()[-20:])
        raise NotProvedError(f"{' '.join(command)} failed:\n{said}")
    return done


def coq_version(folder: Path) -> str:
    """The version of Coq. Raises MissingToolError where one of its programs or libraries is not there."""
    for tool in ("coqc", "coqdep", "coqchk"):
        if shutil.which(tool) is None:
            raise MissingToolError(MISSING.format(tool))
    for library in LIBRARIES:
        (folder / "Library.v").write_text(f"Require {library}.\n")
        try:
            run(["coqc", "-q", "Library.v"], folder)
        except NotProvedError as error:
            raise MissingToolError(MISSING.format(f"Coq library {library}")) from error
    return run(["coqc", "--print-version"], folder).stdout.split()[0]


def compiled(texts: Mapping[str, str], work: Path) -> str:
    """Compiles the sources in a folder of their own, each after those that it needs; what Coq prints for Claims.v."""
    for name, text in texts.items():
        (work / f"{name}.v").write_text(text, encoding="utf-8")
    lines = run(["coqdep", *COQ[1:], *(f"{name}.v" for name in texts)], work).stdout.splitlines()
    rules = [line.split(":", 1) for line in lines if ".vo " in line]  # Theorem.vo ...: Theorem.v Statement.vo ...
    needed = {file.split(".")[0]: re.findall(r"(?<!\S)(?:\./)?(\w+)\.vo(?!\S)", on) for file, on in rules}
    order, running, said = TopologicalSorter(needed), dict[Future[subprocess.CompletedProcess[str]], str](), {}
    try:
        order.prepare()
    except CycleError as error:
        raise NotProvedError(f"these files need each other: {', '.join(error.args[1])}") from error
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        while order.is_active():
            for name in order.get_ready():
                running[pool.submit(run, ["coqc", *COQ, f"{name}.v"], work)] = name
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                name = running.pop(future)
                said[name] = future.result().stdout
                order.done(name)
    return said["Claims"]


def checked_again(texts: Mapping[str, str], work: Path, *, libraries: bool) -> None:
    """Has coqchk check the compiled files. Raises NotProvedError where it refuses or lists an axiom of ours.

    Without `libraries` it takes those of Coq as they are and lists, besides axioms, what their modules hide.
    """
    modules = [f"Gaincert.{name}" for name in texts]
    if not libraries:
        modules = [word for module in modules for word in ("-norec", module)]
    done = run(["coqchk", "-silent", "-o", *COQ[1:], *modules], work)
    said = done.stdout + done.stderr
    _, _, listed = said.partition("* Axioms:")
    axioms, _, unsafe = listed.partition("* Constants/Inductives relying on type-in-type:")
    names = [name for name in axioms.split() if name != "<none>"]
    ours = [name for name in names if name.startswith("Gaincert.")]
    other = [name for name in names if not name.endswith(tuple(f".{axiom}" for axiom in STANDARD_AXIOMS))]
    if "Set is predicative" not in said or unsafe.count("<none>") != 3 or ours or (libraries and other):
        raise NotProvedError(f"coqchk finds an assumption that is not one of the standard axioms:\n{said}")


def check(folder: Path = FOLDER, *, libraries: bool = False) -> dict[str, object]:
    """The record of a complete proof. Raises NotProvedError or MissingToolError."""
    texts = sources(folder)
    names = claims(texts)
    if found := gaps(texts):
        raise NotProvedError("these assume instead of proving: " + ", ".join(found))
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary)
        version = coq_version(work)
        axioms = assumptions(compiled(texts, work))
        if len(axioms) != len(names):
            raise NotProvedError(f"Coq answered for {len(axioms)} of {len(names)} theorems")
        record = dict(zip(names, axioms, strict=True))
        for name, assumed in record.items():
            if more := set(assumed) - STANDARD_AXIOMS:
                raise NotProvedError(
                    f"{name} assumes {', '.join(sorted(more))}, which is not one of the standard axioms"
                )
        checked_again(texts, work, libraries=libraries)
    return {"digest": digest(texts), "coq": version, "theorems": record}


def as_text(record: dict[str, object]) -> str:
    """The record as its file has it."""
    return json.dumps(record, indent=1) + "\n"


def main() -> int:
    """Check, print and record; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--libraries", action="store_true", help="check the libraries of Coq, too")
    try:
        record = check(libraries=parser.parse_args().libraries)
    except MissingToolError as error:
        print(error, file=sys.stderr)  # noqa: T201
        return 2
    except NotProvedError as error:
        print(f"not proved: {error}", file=sys.stderr)  # noqa: T201
        return 1
    try:
        RECORD.write_text(as_text(record))
    except OSError as error:
        print(f"{RECORD} cannot be written: {error}", file=sys.stderr)  # noqa: T201
        return 1
    for name, axioms in record["theorems"].items():  # type: ignore[attr-defined]
        print(f"{name}: {', '.join(axioms) or 'no assumption'}")  # noqa: T201
    print(f"proved with Coq {record['coq']}, sources {record['digest']}; recorded in {RECORD.name}")  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main())
