"""The proof check mutated: `python -m tests.campaigns.proof_mutation [--sample N]`, from the repository's root.

A mutant is the proof check with one small change in `verify/proof` or in a function of `models` that it uses: a number,
a sign, an operator, a name, a text, or an entry that is left out. It is killed where the check raises, where `prove`
reports another verdict, number, witness or support of any claim, of the paper's fleet or of one that breaks limits,
where a letter is used that the report does not explain, or where a planted error (`proof_mutants.py`) or an inference
that does not follow (`proof_rules.py`) is judged otherwise. A change in a rule or in the model is killed by another
formula in the report, too; a change in a claim is not, since the formula may be what was changed.

What survives changes no more than the wording of a formula. `proof_survivors.py` says why it may.

Every mutant has a process of its own, which imports anew the changed module and all that import it.
"""

from __future__ import annotations

import argparse
import ast
import os
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from itertools import zip_longest
from pathlib import Path
from typing import NamedTuple, TypeVar

from tests.campaigns import code_mutation
from tests.campaigns.code_mutants import Mutant, mutants
from tests.campaigns.code_mutation import KILLED, SURVIVED, TIMED_OUT
from tests.campaigns.proof_survivors import ALIKE, ARGUED
from tests.test_layers import IMPORTS, module_of

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 60  # of processor time that a mutant may take
PROOF = sorted(path for path in (ROOT / "verify/proof").rglob("*.py") if path.name != "trajectories.py")
# The functions of models that the proof check evaluates, by file; all of a file where none are named.
MODELS = {
    "models/equations.py": (),
    "models/energy.py": (),
    "models/saturation.py": ("Saturation.columns",),
    "models/graph.py": ("Graph.degree", "Graph.leader_tree", "Graph.ldl_pivots"),
    "models/conditions.py": (
        "excitation_bound", "turning_bound", "pulling_bound", "condition_15", "condition_15_prime", "condition_16",
        "torque_room", "torque_bound", "condition_16_star", "speed_condition", "turn_rate_condition",
        "wheel_speed_condition", "acceleration_condition", "turn_acceleration_condition", "Inequality.margin",
        "Inequality.holds", "_squares",
    ),
}  # fmt: skip
CLAIMS = {"lemmas", "printed", "this_fleet", "constants.py"}
USERS = (
    "tests.campaigns.proof_mutants", "tests.campaigns.proof_rules", "tests.campaigns.proof_verdicts",
    "tests.verify.light_fleets",
)  # fmt: skip
# Names that may be taken for each other.
FAMILIES = (
    ("p_v", "d_v"), ("p_w", "d_w"), ("p_omega", "d_omega"), ("m", "I"), ("m", "inertia"), ("v", "w"), ("v", "omega"),
    ("psi", "psi_dot"), ("psi_dot", "psi_ddot"), ("psi_bar", "psi1"), ("psi0", "psi1"), ("psi1", "psi2"), ("q", "b"),
    ("cos", "sin"), ("e_x", "e_y"), ("e_along", "e_across"), ("along", "across"), ("s", "o"), ("length", "angle"),
    ("tau_l", "tau_r"), ("u_v", "u_omega"), ("v_dot", "w_dot"), ("position", "heading"), ("speed", "turn_rate"),
    ("weight", "leader_weight"), ("left", "right"), ("tail", "head"), ("degree", "coupling"), ("arm", "r"),
    ("translational", "rotational"), ("x", "y"), ("i", "j"), ("facts", "truth"), ("generic", "generic_unit"),
    ("ROOT2", "PERIOD"), ("pull_rate", "heading_rate"), ("acceleration_bound", "turn_acceleration_bound"),
)  # fmt: skip
SWAPPED: dict[str, list[str]] = {}
for _one, _other in FAMILIES:
    SWAPPED.setdefault(_one, []).append(_other)
    SWAPPED.setdefault(_other, []).append(_one)


class Changed(NamedTuple):
    """A mutant and the file that it is in."""

    path: Path
    number: int  # among the mutants of that file
    mutant: Mutant

    def trees(self) -> dict[Path, ast.Module]:
        """The changed file."""
        tree = _tree(self.path)
        mutants(tree, more)[self.number].apply()
        return {self.path: tree}

    @property
    def judges(self) -> bool:
        """Whether it is in what judges claims or in what they are about, not in a claim."""
        return not CLAIMS & set(self.path.relative_to(ROOT).parts)

    @property
    def key(self) -> tuple[str, str, str]:
        """File, function and change."""
        return self.path.relative_to(ROOT).as_posix(), self.mutant.function, self.mutant.change

    @property
    def place(self) -> str:
        """The same in one line."""
        return ": ".join(filter(None, self.key))


class Planted(NamedTuple):
    """An error in one or more files: (file, old text, new text)."""

    name: str
    edits: tuple[tuple[str, str, str], ...]

    judges = False

    def trees(self) -> dict[Path, ast.Module]:
        """The changed files."""
        sources: dict[Path, str] = {}
        for name, old, new in self.edits:
            path = ROOT / name
            source = sources.get(path) or path.read_text(encoding="utf-8")
            assert source.count(old) == 1, f"{name} has {old!r} {source.count(old)} times"
            sources[path] = source.replace(old, new)
        return {path: ast.parse(source) for path, source in sources.items()}


def more(node: ast.AST) -> Iterator[ast.AST]:
    """Changes besides those of `mutants.py`: names for each other, texts with blanks, entries left out."""
    match node:
        case ast.Attribute(attr=name) | ast.Name(id=name) if name in SWAPPED:
            for other in SWAPPED[name]:
                yield (
                    ast.Attribute(node.value, other, node.ctx)
                    if isinstance(node, ast.Attribute)
                    else ast.Name(other, node.ctx)
                )
        case ast.Constant(value=str() as text) if " " in text:
            yield ast.Constant(f"not {text}")
        case ast.Tuple(elts=elements) | ast.List(elts=elements) if len(elements) > 1 and isinstance(node.ctx, ast.Load):
            for place in range(len(elements)):
                yield type(node)([*elements[:place], *elements[place + 1 :]], node.ctx)


def every_mutant() -> list[Changed]:
    """All mutants, file by file."""
    found = [Changed(path, n, mutant) for path in PROOF for n, mutant in enumerate(mutants(_tree(path), more))]
    for name, functions in MODELS.items():
        path = ROOT / name
        for number, mutant in enumerate(mutants(_tree(path), more)):
            # what a condition is called and which gains its message names is not the proof's
            named = "Inequality(" in mutant.change or mutant.change.startswith(("('", "(*_"))
            if (not functions or mutant.function in functions) and not named:
                found.append(Changed(path, number, mutant))
    return found


def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def outcome(change: Changed | Planted, expected: Expected) -> str:
    """What becomes of a change."""
    return code_mutation.outcome(lambda: _same(change, expected[change.judges]), SECONDS)


def _same(change: Changed | Planted, expected: Sequence[str]) -> bool:
    """Whether the check says the same with the change in it; runs in a process of its own, up to a difference."""
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    for path, tree in change.trees().items():
        module = module_of(path)
        for name in _dependents(module):
            _forget(".".join(("gaincert", *name)))
        code_mutation.import_instead(".".join(("gaincert", *module)), tree)
    for name in USERS:
        _forget(name)
    return all(one == other for one, other in zip_longest(verdicts(formulas=change.judges), expected))


def verdicts(*, formulas: bool) -> Iterator[str]:
    """What the check says now, from modules that are imported anew where they were forgotten."""
    from tests.campaigns.proof_verdicts import parts

    yield from parts(formulas=formulas)


def _dependents(module: tuple[str, ...]) -> set[tuple[str, ...]]:
    """A module and all that import it, directly or not: what has to be imported anew."""
    found, waiting = {module}, [module]
    while waiting:
        imported = waiting.pop()
        new = {name for name, imports in IMPORTS.items() if imported in imports} - found
        found |= new
        waiting += new
    return found


def _forget(name: str) -> None:
    """Take a module out of those that are loaded, and out of its package."""
    module = sys.modules.pop(name, None)
    package, _, last = name.rpartition(".")
    if module is not None and hasattr(sys.modules.get(package), last):
        delattr(sys.modules[package], last)


Change = TypeVar("Change", "Changed", "Planted")
Expected = dict[bool, tuple[str, ...]]  # what the check says as it is, with formulas and without


def outcomes(chosen: Sequence[Change], workers: int = 2) -> Iterator[tuple[Change, str]]:
    """What becomes of each change, in order."""
    expected = {formulas: tuple(verdicts(formulas=formulas)) for formulas in (False, True)}
    assert '["proved", true]' in expected[True], "the check does not prove the theorem as it is"
    with ThreadPoolExecutor(workers) as pool:
        yield from zip(chosen, pool.map(lambda change: outcome(change, expected), chosen), strict=True)


def sample(count: int, seed: int = 0) -> list[Changed]:
    """Some mutants in an order by chance, in which those of other functions stay where they are when one is changed."""
    return sorted(every_mutant(), key=lambda changed: sha256(f"{seed}: {changed.place}".encode()).digest())[:count]


def main() -> int:
    """Print the table and the survivors; 1 where one is not argued."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sample", type=int, help="only so many mutants")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--file", action="append", default=[], help="only of files whose path has this in it")
    options = parser.parse_args()
    chosen = sample(options.sample, options.seed) if options.sample else every_mutant()
    chosen = [c for c in chosen if not options.file or any(word in c.place for word in options.file)]
    counts: dict[str, Counter[str]] = {}
    survivors = []
    begin = time.monotonic()
    for changed, word in outcomes(chosen, options.workers):
        counts.setdefault(str(changed.path.relative_to(ROOT)), Counter())[word] += 1
        if word == SURVIVED:
            survivors.append(changed)
            sys.stderr.write(f"survives: {changed.place} (line {changed.mutant.line})\n")
    print("| module | mutants | killed | timed out | survived |\n|---|---|---|---|---|")
    for name, count in counts.items():
        print(f"| `{name}` | {count.total()} | {count[KILLED]} | {count[TIMED_OUT]} | {count[SURVIVED]} |")
    total = sum(counts.values(), Counter())
    print(f"| all | {total.total()} | {total[KILLED]} | {total[TIMED_OUT]} | {total[SURVIVED]} |")
    print(f"\n{100 * total[SURVIVED] / total.total():.1f} % survive; {time.monotonic() - begin:.0f} s")
    unargued = [c for c in survivors if argument(c) is None]
    for changed in survivors:
        print(f"- {changed.place}: {argument(changed) or 'NOT ARGUED'}")
    return int(bool(unargued))


def argument(changed: Changed) -> str | None:
    """Why a survivor may."""
    before, _, after = changed.mutant.change.partition(" -> ")
    alike = (reason for name, reason in ALIKE.items() if before == f"{name}({after})")
    return ARGUED.get(changed.key) or next(alike, None)


if __name__ == "__main__":
    sys.exit(main())
