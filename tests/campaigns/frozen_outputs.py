"""Writes the outputs that a change of structure must not change, and compares two such folders.

`python tests/campaigns/frozen_outputs.py write DIR` runs the command line: designs of the examples at seed 0 under
every condition set, their certificates, the proof check, a simulation of the paper's own gains, and the exported C.
`python tests/campaigns/frozen_outputs.py compare BEFORE AFTER` compares numbers, ids, verdicts and generated code byte
for byte; versions, timings and wording are left out. It exits with 1 and names the files that differ.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
DESIGNS = [
    ("paper", "paper"),
    ("paper", "corrected"),
    ("paper", "rate-bounded"),
    ("mixed_ring", "paper"),
    ("turtlebot3_line", "corrected"),
]
# Keys whose values are versions or sentences: they may change with the program.
WORDING = {"versions", "provenance", "notes", "statement", "reason", "steps", "witness", "source", "method", "title"}


def gaincert(*arguments: object) -> None:
    """Run a verb; exit codes of verdicts are part of what is frozen, so they are not errors here."""
    subprocess.run([sys.executable, "-m", "gaincert", *map(str, arguments), "-q"], check=False)


def write(folder: Path) -> None:
    """Run all verbs and leave their files in `folder`."""
    for fleet, conditions in DESIGNS:
        place, path = folder / f"{fleet}-{conditions}", EXAMPLES / f"{fleet}.toml"
        gaincert("design", path, "-o", place, "--conditions", conditions)
        gaincert("certify", path, "--gains", place / "design.json", "-o", place)
    gaincert("export", folder / "paper-paper", "--format", "c")
    gaincert("prove", "-o", folder / "proof")
    own = ("--gains", EXAMPLES / "paper_gains.toml", "--horizon", 300, "-o", folder / "own")
    gaincert("simulate", EXAMPLES / "paper.toml", *own)
    gaincert("certify", EXAMPLES / "paper.toml", "--gains", EXAMPLES / "paper_gains.toml", "-o", folder / "own")


def compared(folder: Path) -> dict[str, Any]:
    """The compared content, by file: JSON without wording; code and tables unchanged."""
    found: dict[str, Any] = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.suffix == ".json":
            found[name] = without_wording(json.loads(path.read_text()))
        elif path.suffix in (".csv", ".c", ".h"):
            found[name] = path.read_text()
    return found


def without_wording(content: Any) -> Any:
    """The JSON document without the keys of WORDING, on every level."""
    if isinstance(content, dict):
        return {key: without_wording(value) for key, value in content.items() if key not in WORDING}
    return [without_wording(item) for item in content] if isinstance(content, list) else content


def main() -> int:
    """Write or compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("write").add_argument("folder", type=Path)
    comparison = verbs.add_parser("compare")
    comparison.add_argument("before", type=Path)
    comparison.add_argument("after", type=Path)
    options = parser.parse_args()
    if options.verb == "write":
        write(options.folder)
        return 0
    before, after = compared(options.before), compared(options.after)
    differing = [name for name in sorted(before | after) if before.get(name) != after.get(name)]
    print("\n".join(f"differs: {name}" for name in differing) or f"the same: {len(before)} files")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
