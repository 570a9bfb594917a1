"""Mutation testing of what carries the proof: `python benchmarks/mutation.py [MODULE ...]`, from the repository's root.

A mutant is one module with one small change. The fast tests of that module must fail on it; a mutant on which they pass
survives: a law that no test states, or a change that alters nothing (`ARGUED` says why). Exit code 1 where a survivor
is not argued, or where an argument is about a mutant that does not survive any more.

Not mutated: docstrings, annotations, decorators, texts with a blank in them, f-strings, the arguments of exceptions and
of refusals, `zip(strict=)` and blocks under `if __name__ == "__main__"`. Tests that read the module's source or start
a process of their own see no mutant and are left out. hypothesis draws the same examples in every run.

One process imports and collects the tests once and forks for every mutant: the change is put into the code of the
functions that are loaded already. A change outside a function takes a process that imports everything anew.
"""

from __future__ import annotations

import argparse
import ast
import copy
import gc
import importlib
import json
import mmap
import os
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parent.parent
MEMORY = 6 * 2**30  # bytes of address space of a mutant
PATIENCE = 6  # times what the tests take without a change: then a mutant counts as timed out
KILLED, SURVIVED, TIMED_OUT = "killed", "survived", "timed out"


class Target(NamedTuple):
    """A module and the fast tests that concern it."""

    module: str
    tests: tuple[str, ...]
    blind: str = ""  # tests that cannot see a mutant, or run too long for what they see; a pytest -k expression


TARGETS = {
    "limits": Target("models.limits", ("test_limits.py",)),
    "energy": Target("models.energy", ("test_equations.py",)),
    "kernel": Target(
        "verify.kernel",
        ("test_kernel.py", "test_kernel_review.py", "test_certificate_mutations.py"),
        "it_imports or it_has or every_division or every_function or runs_alone or the_work_on or flat_topped",
    ),
}

# What survives and why it may: (module, function, change): reason.
ARGUED: dict[tuple[str, str, str], str] = {}


# -- mutants ----------------------------------------------------------------------------------------------------------

COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
}
NAMES = {"min": "max", "max": "min", "any": "all", "all": "any", "floor": "ceil", "lower": "upper"}
REFUSALS = {"unreadable", "FalseError", "UnreadableError", "InputError", "_no_number"}  # their arguments are messages


@dataclass(frozen=True)
class Mutant:
    """One node in place of another."""

    parent: ast.AST
    field: str
    place: int | None  # where the field is a list
    new: ast.AST
    function: str  # the one around it that stands at the top or in a class; "" outside any
    inside: bool  # whether it is part of that function's code: no default of an argument or of a field
    line: int
    change: str

    def apply(self) -> None:
        """Put the new node into the tree, for good."""
        if self.place is None:
            setattr(self.parent, self.field, self.new)
        else:
            getattr(self.parent, self.field)[self.place] = self.new


def mutants(tree: ast.Module) -> list[Mutant]:
    """Every mutant of a module, in the order of its lines."""
    return sorted(_below(tree, "", inside=False), key=lambda mutant: mutant.line)


def _below(parent: ast.AST, function: str, *, inside: bool) -> Iterator[Mutant]:
    for field, place, node in _children(parent):
        own, within = function, inside or (isinstance(parent, ast.FunctionDef) and field == "body")
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not inside:
            own = f"{function}.{node.name}" if function else node.name
        for new in _others(node, condition=field in ("test", "ifs")):
            ast.fix_missing_locations(ast.copy_location(new, node))
            change = f"{_shown(node)} -> {_shown(new)}"
            yield Mutant(parent, field, place, new, own, within, getattr(node, "lineno", 0), change)
        yield from _below(node, own, inside=within)


def _children(parent: ast.AST) -> Iterator[tuple[str, int | None, ast.AST]]:
    """The nodes below one that are code: what is left out is in the docstring of this module."""
    for field, value in ast.iter_fields(parent):
        if field in ("annotation", "returns", "decorator_list") or isinstance(parent, ast.JoinedStr):
            continue
        if field == "args" and isinstance(parent, ast.Call) and _name(parent.func) in REFUSALS:
            continue
        entries: Iterable[Any] = enumerate(value) if isinstance(value, list) else [(None, value)]
        for place, node in entries:
            if isinstance(node, ast.AST) and not _left_out(parent, node):
                yield field, place, node


def _left_out(parent: ast.AST, node: ast.AST) -> bool:
    docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    program = isinstance(node, ast.If) and "__name__" in ast.unparse(node.test)
    lengths = isinstance(node, ast.keyword) and node.arg == "strict" and _name(getattr(parent, "func", None)) == "zip"
    typing = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    return docstring or program or lengths or typing or isinstance(node, (ast.Import, ast.ImportFrom))


def _name(node: ast.AST | None) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def _shown(node: ast.AST) -> str:
    return " ".join(ast.unparse(node).split()) if not isinstance(node, ast.Pass) else "nothing"


def _with(node: ast.AST, **changed: Any) -> Any:
    new = copy.copy(node)
    for field, value in changed.items():
        setattr(new, field, value)
    return new


def _others(node: ast.AST, *, condition: bool) -> Iterator[ast.AST]:
    """What may stand in place of a node."""
    if condition and isinstance(node, ast.expr) and not isinstance(node, (ast.Compare, ast.UnaryOp)):
        yield ast.UnaryOp(ast.Not(), node)
    match node:
        case ast.Compare():
            for place, operator in enumerate(node.ops):
                for other in COMPARISONS[type(operator)]:
                    yield _with(node, ops=[*node.ops[:place], other(), *node.ops[place + 1 :]])
        case ast.BinOp() | ast.AugAssign() if type(node.op) in ARITHMETIC:
            yield _with(node, op=ARITHMETIC[type(node.op)]())
        case ast.BoolOp():
            yield _with(node, op=ast.And() if isinstance(node.op, ast.Or) else ast.Or())
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield node.operand
        case ast.Constant():
            yield from map(ast.Constant, _other_constants(node.value))
        case ast.Name(id=name) if name in NAMES:
            yield _with(node, id=NAMES[name])
        case ast.Attribute(attr=name) if name in NAMES:
            yield _with(node, attr=NAMES[name])
        case ast.Call(args=[ast.expr() as argument], keywords=[]) if not isinstance(argument, ast.Starred):
            yield argument
        case ast.Return() if node.value is not None and not _is_none(node.value):
            yield ast.Return(ast.Constant(None))
        case ast.Expr(value=ast.Call()) | ast.Raise() | ast.Continue() | ast.Break():
            yield ast.Pass()
    if isinstance(node, ast.AugAssign):
        yield ast.Pass()


def _is_none(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _other_constants(value: Any) -> list[Any]:
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, (int, float)):
        return [value + 1, value - 1]
    if isinstance(value, str) and " " not in value:
        return [value + "X"]
    return []


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
    """Those that the module's own text defines, at its top level or in its classes."""
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
    """What becomes of a mutant: `work`, in a process of its own, says whether the tests pass."""
    child = os.fork()
    if child == 0:
        signal.alarm(max(1, round(seconds)))  # whoever does not end by then is ended by SIGALRM
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        passed = False
        try:
            passed = work()
        finally:
            os._exit(0 if passed else 1)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGALRM:
        return TIMED_OUT
    return SURVIVED if status == 0 else KILLED


class ForEachMutant:
    """A pytest plugin that runs the collected tests once as they are, then once for each mutant, in forks."""

    def __init__(self, name: str, tree: ast.Module, chosen: list[Mutant], report: Callable[[Any], None]) -> None:
        self.name, self.tree, self.chosen, self.report = name, tree, chosen, report
        self.failed = mmap.mmap(-1, 4)  # shared with the forks: which test has failed

    def pytest_runtestloop(self, session: Any) -> bool:
        module = importlib.import_module(self.name)
        assert Path(str(module.__file__)).resolve().is_relative_to(ROOT), f"{module.__file__} is tested"
        gc.freeze()  # so that no fork copies what it does not change
        session.items[:] = _one_of_each_first(session.items)
        begin = time.monotonic()
        assert outcome(partial(self.passes, session), 600) == SURVIVED, f"the tests of {self.name} fail as they are"
        limit = PATIENCE * (time.monotonic() - begin)
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


def outcomes(target: Target, tree: ast.Module, found: list[Mutant], said: Callable[[str], None]) -> list[str]:
    """What becomes of each mutant."""
    name = f"gaincert.{target.module}"
    inside, outside = ([mutant for mutant in found if mutant.inside == kind] for kind in (True, False))
    results: dict[int, str] = {}
    with tempfile.TemporaryDirectory() as folder:
        limit, *words = _from_child(
            lambda report: run_pytest(target, folder, ForEachMutant(name, tree, inside, report)), said
        )
        assert len(words) == len(inside), f"the tests of {name} could not be run"
        results |= {id(mutant): word for mutant, word in zip(inside, words, strict=True)}
        for mutant in outside:
            results[id(mutant)] = outcome(partial(anew, target, name, tree, mutant, folder), limit + 60)
            said(results[id(mutant)])
    return [results[id(mutant)] for mutant in found]


def _from_child(work: Callable[[Callable[[Any], None]], Any], said: Callable[[str], None]) -> list[Any]:
    """What `work`, in a process of its own, reports: so that nothing that it imports stays here."""
    receive, send = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(receive)
        try:
            work(lambda word: os.write(send, json.dumps(word).encode() + b"\n") and None)
        finally:
            os._exit(0)
    os.close(send)
    words = []
    with os.fdopen(receive) as lines:
        for line in lines:
            words.append(json.loads(line))
            said(str(words[-1]))
    os.waitpid(child, 0)
    return words


# -- the table --------------------------------------------------------------------------------------------------------


def measure(key: str) -> tuple[str, list[tuple[Mutant, str]]]:
    """A row of the table, and the survivors of a module with what is argued for each ("" where nothing is)."""
    target = TARGETS[key]
    path = ROOT / (target.module.replace(".", "/") + ".py")
    tree = ast.parse(path.read_text())
    found = mutants(tree)
    heard: list[str] = []

    def said(word: str) -> None:
        heard.append(word)
        if sys.stderr.isatty():
            sys.stderr.write(f"\r{key}: {len(heard)} of {len(found)}, {heard.count(SURVIVED)} survive ")

    begin = time.monotonic()
    words = outcomes(target, tree, found, said)
    counts = " | ".join(str(words.count(word)) for word in (KILLED, TIMED_OUT, SURVIVED))
    row = f"| `{path.relative_to(ROOT)}` | {len(found)} | {counts} | {time.monotonic() - begin:.0f} s |"
    survivors = [mutant for mutant, word in zip(found, words, strict=True) if word == SURVIVED]
    return row, [(mutant, ARGUED.get((key, mutant.function, mutant.change), "")) for mutant in survivors]


def main() -> int:
    """Print the table; 1 where a survivor is not argued or an argument has no survivor."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "modules", nargs="*", metavar="MODULE", help=f"of {', '.join(TARGETS)}; all where none is given"
    )
    chosen = parser.parse_args().modules or list(TARGETS)
    measured = {key: measure(key) for key in chosen}
    print("| module | mutants | killed | timed out | survived | time |\n|---|---|---|---|---|---|")
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
