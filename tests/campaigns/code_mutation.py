"""Mutation tests of conditions, energies and kernel: `python -m tests.campaigns.code_mutation [MODULE ...]`.

A mutant is one module with one small change. The fast tests of that module must fail on it. If they pass, the mutant
survives: a test is missing, or the change alters nothing (`ARGUED` says why). Exit code 1 if a survivor is not argued,
or if an argued mutant does not survive any more.

`code_mutants.py` lists the changes. Tests that read the module's source or start a process of their own
see no mutant and are left out. hypothesis draws the same examples in every run.

One process imports and collects the tests once and forks for every mutant: the change is put into the code of the
functions that are loaded already. A change outside a function takes a process that imports everything anew.
"""

from __future__ import annotations

import argparse
import ast
import gc
import importlib
import json
import mmap
import os
import resource
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

from tests.campaigns.code_mutants import Mutant, mutants

ROOT = Path(__file__).resolve().parents[2]
MEMORY = 6 * 2**30  # bytes of address space of a mutant
PATIENCE = 6  # times the processor time of the tests without a change: then a mutant counts as timed out
KILLED, SURVIVED, TIMED_OUT = "killed", "survived", "timed out"


class Target(NamedTuple):
    """A module and the fast tests that concern it."""

    module: str
    tests: tuple[str, ...]
    blind: str = ""  # tests that cannot see a mutant, or run too long for what they see; a pytest -k expression


TARGETS = {
    "conditions": Target("models.conditions", ("models/test_conditions.py",)),
    "enclosures": Target("models.enclosures", ("models/test_conditions.py",)),
    "energy": Target("models.energy", ("models/test_equations.py",)),
    "kernel": Target(
        "verify.kernel",
        tuple(
            f"verify/test_kernel_{part}.py"
            for part in ("columns", "conditions", "program", "psi", "rates", "reading", "review", "verdict")
        ),
        "runs_alone or is_no_verdict or that_leaves or little_memory or flat_topped or near_the_supremum",
    ),
}

# What survives and why it may: (module, function, change): reason.
ONE_NUMBER = "the same number"
WORK = "a bound of the work, not of the truth: any near it serves"
SHOWN = "for people to read: more digits than are shown"
FINER = "finer, or coarser by as little: the enclosure holds all the same"
SHARED = "shared or not, the numbers are the same"
TWICE, SOME, ALL = "2 * len((distinct := set(texts)))", "len(chosen)", "len(self.columns[0])"
LAST_PLACE = "one unit in the last of some hundred places, where a side is irrational or is stated with slack"
_BOUNDS = (
    "(200, 80) -> (200, 81)", "(200, 80) -> (200, 79)", "10 ** 4 -> 10 * 4", "10 ** 4 -> 11 ** 4", "10 ** 4 -> 9 ** 4",
    "10 ** 4 -> 10 ** 5", "10 ** 4 -> 10 ** 3",
)  # fmt: skip
_UNITS = (
    "10 ** 15 -> 11 ** 15", "10 ** 15 -> 9 ** 15", "10 ** 15 -> 10 ** 16", "10 ** 15 -> 10 ** 14",
    "10 ** 80 -> 11 ** 80", "10 ** 80 -> 9 ** 80", "10 ** 80 -> 10 ** 81", "10 ** 80 -> 10 ** 79",
)  # fmt: skip
_HALVINGS = "(2 * p).bit_length() - q.bit_length() + 1"
_TANH = (
    "p < 100 * q -> p <= 100 * q", "100 * q -> 101 * q", "(100, 1) -> (99, 1)", "2 * p -> 3 * p", "2 * p -> 1 * p",
    f"max(0, {_HALVINGS}) -> max(1, {_HALVINGS})",
    *(f"{_HALVINGS} -> {_HALVINGS[:-3]}{end}" for end in ("- 1", "+ 2", "+ 0")),
)  # fmt: skip
_SINGLE = (
    ("read_claims", "column(psi_bar, 'psi_bar', 1)"),
    ("read_psi", "reader.column(mean, 'excitation: mean', 1, None)"),
    ("read_rates", "reader.column(rate, name, 1)"),
)
_TURN = ("2 * (v.k_alpha * c.psi_bar * v.degree * b) ** 2", "v.d_omega * a * c.unit ** 2, b * c.unit ** 2")
_PULL = ("2 * (v.p_v * v.degree * b) ** 2", "v.d_v * a * c.unit, b * c.unit")
_ROW = (
    "below * u2 * (p * s * row - gamma * d * scale * own) + gamma * gamma * least * scale * s * own",
    "rates",
)
_LAST = (
    *(("condition_15", f"({_TURN[0]}, 0, {_TURN[1]}) -> ({_TURN[0]}, {n}, {_TURN[1]})") for n in (1, -1)),
    *(("speed", f"({_PULL[0]}, 0, {_PULL[1]}) -> ({_PULL[0]}, {n}, {_PULL[1]})") for n in (1, -1)),
    (_ROW[1], f"{_ROW[0]} < 0 -> {_ROW[0]} < -1"),
)
_VEHICLE = (
    "namedtuple('Vehicle', 'degree mass_low mass_high inertia_low inertia_high arm_low arm_high r_low r_high wheel_low "
    "wheel_high torque position_scale speed_scale p_v d_v heading_scale turn_rate_scale p_omega d_omega k_alpha')"
)
ARGUED: dict[tuple[str, str, str], str] = {
    ("conditions", "", "NEVER_BINDS = 1000000.0 -> NEVER_BINDS = 1000001.0"): "any number beyond all N and N m serves",
    ("conditions", "", "NEVER_BINDS = 1000000.0 -> NEVER_BINDS = 999999.0"): "any number beyond all N and N m serves",
    ("conditions", "casadi_numbers.tanh", "ca.DM(constant(ca.DM(q).full())) -> constant(ca.DM(q).full())"): (
        "CasADi multiplies by a NumPy column as by its own"
    ),
    ("kernel", "Claims.vehicles", "self.columns[0] -> self.columns[1]"): "all columns have one length",
    ("kernel", "Claims.vehicles", "self.columns[0] -> self.columns[-1]"): "all columns have one length",
    ("kernel", "Claims.vehicles", f"{SOME} < {ALL} -> {SOME} <= {ALL}"): "the same vehicles, taken one by one",
    ("kernel", "integers", f"{TWICE} < len(texts) -> {TWICE} <= len(texts)"): SHARED,
    ("kernel", "integers", f"{TWICE} -> {TWICE.replace('*', '/')}"): SHARED,
    ("kernel", "integers", f"{TWICE} -> {TWICE.replace('2', '1')}"): SHARED,
    ("kernel", "", "10 ** 6 -> 11 ** 6"): WORK,
    ("kernel", "", "10 ** 6 -> 9 ** 6"): WORK,
    ("kernel", "", "10 ** 6 -> 10 ** 7"): WORK,
    ("kernel", "theorem", "weight > 0 -> weight > 1"): "no weight is the smallest unit of the file",
    ("kernel", "bounded_on_half", "default=0 -> default=1"): "there is an arc",
    ("kernel", "wheel_speed", "max(left, 0) -> max(left, -1)"): "a limit of 0 or less holds for nothing",
    **{("kernel", "", change): WORK for change in _BOUNDS},
    **{("kernel", "", change): FINER for change in _UNITS},
    **{("kernel", "tanh_below", change): FINER for change in _TANH},
    **{("kernel", function, f"{column}[0] -> {column}[-1]"): ONE_NUMBER for function, column in _SINGLE},
    **{("kernel", function, change): LAST_PLACE for function, change in _LAST},
    ("kernel", "read_rates", "10 ** MAX_WHOLE -> 11 ** MAX_WHOLE"): WORK,
    ("kernel", "", f"{_VEHICLE} -> {_VEHICLE.replace('Vehicle', 'VehicleX', 1)}"): SHOWN,
}


# -- a mutant at work -------------------------------------------------------------------------------------------------


def exchange(module: ModuleType, tree: ast.Module) -> None:
    """Give the functions and methods of a loaded module the code that a tree has for them."""
    fresh = {(code.co_name, code.co_firstlineno): code for code in _codes(compile(tree, str(module.__file__), "exec"))}
    for function in _functions(module):
        function.__code__ = fresh[function.__code__.co_name, function.__code__.co_firstlineno]
    for value in vars(module).values():
        if hasattr(value, "cache_clear"):
            value.cache_clear()


def _codes(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _codes(constant)


def _functions(module: ModuleType) -> Iterator[FunctionType]:
    """The functions that the module itself defines, at its top level or in its classes."""
    for owner in (module, *(value for value in vars(module).values() if isinstance(value, type))):
        for value in vars(owner).values():
            function = getattr(value, "fget", value)
            function = getattr(function, "__wrapped__", function)
            if isinstance(function, FunctionType) and function.__code__.co_filename == module.__file__:
                yield function


def import_instead(name: str, tree: ast.Module) -> None:
    """Let a module be imported from a tree."""
    original = SourceFileLoader.get_code

    def get_code(loader: SourceFileLoader, fullname: str) -> CodeType | None:
        return compile(tree, loader.path, "exec") if fullname == name else original(loader, fullname)

    SourceFileLoader.get_code = get_code  # type: ignore[assignment, method-assign]


def outcome(work: Callable[[], bool], seconds: float) -> str:
    """The outcome for a mutant: `work` runs in its own process and returns whether the tests pass.

    The seconds are of processor time, so that other programs on the machine change no outcome.
    """
    child = os.fork()
    if child == 0:
        signal.setitimer(signal.ITIMER_PROF, seconds)  # whoever does not end by then is ended by SIGPROF
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        passed = False
        try:
            passed = work()
        finally:
            os._exit(0 if passed else 1)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGPROF:
        return TIMED_OUT
    return SURVIVED if status == 0 else KILLED


def worked() -> float:
    """Seconds of processor time of the processes that this one has waited for."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


class ForEachMutant:
    """A pytest plugin that runs the collected tests once as they are, then once for each mutant, in forks."""

    def __init__(self, name: str, tree: ast.Module, chosen: list[Mutant], report: Callable[[Any], Any]) -> None:
        self.name, self.tree, self.chosen, self.report = name, tree, chosen, report
        self.failed = mmap.mmap(-1, 4)  # shared with the forks: which test has failed

    def pytest_runtestloop(self, session: Any) -> bool:
        module = importlib.import_module(self.name)
        assert Path(str(module.__file__)).resolve().is_relative_to(ROOT), f"{module.__file__} is tested"
        gc.freeze()  # so that no fork copies what it does not change
        session.items[:] = _one_of_each_first(session.items)
        begin = worked()
        assert outcome(partial(self.passes, session), 600) == SURVIVED, f"the tests of {self.name} fail as they are"
        limit = PATIENCE * (worked() - begin)
        self.report(limit)
        for mutant in self.chosen:
            word = outcome(partial(self.work, module, mutant, session), limit)
            if word == KILLED:  # what has killed one mutant is likely to kill the next
                session.items.insert(0, session.items.pop(int.from_bytes(self.failed[:4])))
            self.report(word)
        return True

    def work(self, module: ModuleType, mutant: Mutant, session: Any) -> bool:
        mutant.apply()
        exchange(module, self.tree)
        return self.passes(session)

    def passes(self, session: Any) -> bool:
        for place, item in enumerate(session.items):
            self.failed[:4] = place.to_bytes(4)
            following = session.items[place + 1] if place + 1 < len(session.items) else None
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
            if session.testsfailed:
                return False
        return True


def _one_of_each_first(items: list[Any]) -> list[Any]:
    """One case of each test, then another of each, and so on."""
    seen: Counter[Any] = Counter()
    order = []
    for item in items:
        order.append(seen[item.function])
        seen[item.function] += 1
    return [item for _, _, item in sorted(zip(order, range(len(items)), items, strict=True), key=lambda row: row[:2])]


def run_pytest(target: Target, folder: str, *plugins: Any) -> bool:
    """Whether the tests of a target pass."""
    import pytest
    from hypothesis import settings

    settings.register_profile("mutation", derandomize=True, database=None)
    settings.load_profile("mutation")
    os.chdir(ROOT)
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    blind = ["-k", f"not ({target.blind})"] if target.blind else []
    paths = [f"tests/{name}" for name in target.tests]
    options = ["-x", "-q", "-p", "no:cacheprovider", "--tb=no", f"--basetemp={folder}/tests", "-m", "not slow"]
    return pytest.main([*options, *blind, *paths], plugins=plugins) == 0


def anew(target: Target, name: str, tree: ast.Module, mutant: Mutant, folder: str) -> bool:
    """Whether the tests pass where the module is imported with the mutant in it."""
    mutant.apply()
    import_instead(name, tree)
    return run_pytest(target, folder)


def outcomes(target: Target, tree: ast.Module, found: list[Mutant]) -> Iterator[tuple[Mutant, str]]:
    """The outcome for each mutant, as soon as it is known."""
    name = f"gaincert.{target.module}"
    inside, outside = ([mutant for mutant in found if mutant.inside == kind] for kind in (True, False))
    with tempfile.TemporaryDirectory() as folder:
        words = _from_child(lambda report: run_pytest(target, folder, ForEachMutant(name, tree, inside, report)))
        limit = next(words)
        yield from zip(inside, words, strict=True)
        for mutant in outside:
            yield mutant, outcome(partial(anew, target, name, tree, mutant, folder), limit + 60)


def _from_child(work: Callable[[Callable[[Any], Any]], Any]) -> Iterator[Any]:
    """The reports of `work`, which runs in its own process so that its imports do not stay here."""
    receive, send = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(receive)
        try:
            work(lambda word: os.write(send, json.dumps(word).encode() + b"\n"))
        finally:
            os._exit(0)
    os.close(send)
    with os.fdopen(receive) as lines:
        yield from map(json.loads, lines)
    os.waitpid(child, 0)


# -- the table --------------------------------------------------------------------------------------------------------


def measure(key: str) -> tuple[str, list[tuple[Mutant, str]]]:
    """A row of the table, and the survivors of a module with the argument for each ("" without one)."""
    target = TARGETS[key]
    path = ROOT / (target.module.replace(".", "/") + ".py")
    tree = ast.parse(path.read_text())
    found = mutants(tree)
    counts: Counter[str] = Counter()
    survivors = []
    begin = worked()
    for mutant, word in outcomes(target, tree, found):
        counts[word] += 1
        if word == SURVIVED:
            survivors.append(mutant)
            sys.stderr.write(f"{key}, {counts.total()} of {len(found)}: {mutant.line}: {mutant.change} survives\n")
    words = " | ".join(str(counts[word]) for word in (KILLED, TIMED_OUT, SURVIVED))
    row = f"| `{path.relative_to(ROOT)}` | {len(found)} | {words} | {worked() - begin:.0f} s |"
    survivors.sort(key=lambda mutant: mutant.line)
    return row, [(mutant, ARGUED.get((key, mutant.function, mutant.change), "")) for mutant in survivors]


def main() -> int:
    """Print the table. Returns 1 if a survivor is not argued or an argument has no survivor."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "modules", nargs="*", metavar="MODULE", help=f"of {', '.join(TARGETS)}; all where none is given"
    )
    chosen = parser.parse_args().modules or list(TARGETS)
    measured = {key: measure(key) for key in chosen}
    print("| module | mutants | killed | timed out | survived | processor time |\n|---|---|---|---|---|---|")
    print(*(row for row, _ in measured.values()), sep="\n")
    failed = False
    for key, (_, survivors) in measured.items():
        alive = {(key, mutant.function, mutant.change) for mutant, _ in survivors}
        idle = [argued for argued in ARGUED if argued[0] == key and argued not in alive]
        for mutant, argument in survivors:
            failed |= not argument
            where = f"{TARGETS[key].module}:{mutant.line}"
            print(f"- {where}: {mutant.function}: `{mutant.change}`: {argument or 'NOT ARGUED'}")
        for _, function, change in idle:
            print(f"- {key}: {function}: `{change}`: is argued, but does not survive")
        failed |= bool(idle)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
