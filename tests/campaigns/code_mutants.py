"""Mutants of a module: its syntax tree with one small change, described in words that identify it.

Changes: comparisons, arithmetic, and/or, not, minus, numbers (by one), truth values, texts, conditions, min/max,
any/all and their like, f(x) to x, returned values to None; calls, raise, continue and break are removed.

Not changed: docstrings, annotations, decorators, texts with a blank in them, f-strings, the arguments of exceptions and
of refusals, `zip(strict=)`, imports, and blocks under `if __name__ == "__main__"` and `if TYPE_CHECKING`.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any

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
        _put(self.parent, self.field, self.place, self.new)


More = Callable[[ast.AST], Iterator[ast.AST]]  # what else may stand in place of a node


def mutants(tree: ast.Module, more: More = lambda _node: iter(())) -> list[Mutant]:
    """Every mutant of a module, in the order of its lines; `more` adds kinds of change."""
    return sorted(_below(tree, "", more, inside=False), key=lambda mutant: mutant.line)


def _below(parent: ast.AST, function: str, more: More, *, inside: bool) -> Iterator[Mutant]:
    for field, place, node in _children(parent):
        own, within = function, inside or (isinstance(parent, ast.FunctionDef) and field == "body")
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not inside:
            own = f"{function}.{node.name}" if function else node.name
        for new in chain(_others(node, condition=field in ("test", "ifs")), more(node)):
            ast.fix_missing_locations(ast.copy_location(new, node))
            change = _change(parent, field, place, node, new)
            yield Mutant(parent, field, place, new, own, within, getattr(node, "lineno", 0), change)
        yield from _below(node, own, more, inside=within)


def _children(parent: ast.AST) -> Iterator[tuple[str, int | None, ast.AST]]:
    """The child nodes that are changed; the docstring of this module lists the others."""
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


def _put(parent: ast.AST, field: str, place: int | None, node: ast.AST) -> None:
    if place is None:
        setattr(parent, field, node)
    else:
        getattr(parent, field)[place] = node


def _change(parent: ast.AST, field: str, place: int | None, node: ast.AST, new: ast.AST) -> str:
    """The change in words: a constant or a name together with its expression, to identify it."""
    if not isinstance(node, (ast.Constant, ast.Name)):
        return f"{_shown(node)} -> {_shown(new)}"
    before = _shown(parent)
    _put(parent, field, place, new)
    after = _shown(parent)
    _put(parent, field, place, node)
    return f"{before} -> {after}"


def _shown(node: ast.AST) -> str:
    return " ".join(ast.unparse(node).split()) if not isinstance(node, ast.Pass) else "nothing"


def _with(node: ast.AST, **changed: Any) -> Any:
    new = copy.copy(node)
    for field, value in changed.items():
        setattr(new, field, value)
    return new


def _others(node: ast.AST, *, condition: bool) -> Iterator[ast.AST]:
    """The replacements for a node."""
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
