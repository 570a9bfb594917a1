"""What the trusted checker is made of."""

from __future__ import annotations

import ast
import io
import sys
import tokenize
from pathlib import Path

from gaincert.verify import kernel

SOURCE = Path(kernel.__file__)
TREE = ast.parse(SOURCE.read_text())


def test_it_imports_the_standard_library_alone() -> None:
    imported = {alias.name for node in ast.walk(TREE) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {str(node.module) for node in ast.walk(TREE) if isinstance(node, ast.ImportFrom)}
    assert {name.partition(".")[0] for name in imported} <= sys.stdlib_module_names | {"__future__"}
    assert not any(node.level for node in ast.walk(TREE) if isinstance(node, ast.ImportFrom))


def test_it_has_integers_alone() -> None:
    """No floating point, no division but by `//`, and of the module math only functions of integers."""
    constants = [node.value for node in ast.walk(TREE) if isinstance(node, ast.Constant)]
    assert not any(isinstance(value, (float, complex)) for value in constants)
    names = {node.id for node in ast.walk(TREE) if isinstance(node, ast.Name)}
    assert not names & {"float", "Fraction", "round", "divmod"}
    assert not any(isinstance(node, ast.Div) for node in ast.walk(TREE))
    from_math = [node for node in ast.walk(TREE) if isinstance(node, ast.ImportFrom) and node.module == "math"]
    assert {alias.name for node in from_math for alias in node.names} <= {"isqrt", "lcm", "gcd"}


def test_it_has_no_cache() -> None:
    """A cache keyed by numbers can be filled with keys of one hash: every look-up is then as long as the cache."""
    assert "functools" not in SOURCE.read_text()


def test_decimals_are_for_people() -> None:
    """Where decimals are computed, only text comes out."""
    users = [
        node.name
        for node in TREE.body
        if isinstance(node, ast.FunctionDef) and "Context" in {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
    ]
    assert users == ["shown", "exact"]


def test_it_has_fewer_than_480_lines_of_code() -> None:
    texts = {
        line
        for node in ast.walk(TREE)
        if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node)
        for line in range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1)
    }
    quiet = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
    tokens = tokenize.generate_tokens(io.StringIO(SOURCE.read_text()).readline)
    code = {line for t in tokens if t.type not in quiet for line in range(t.start[0], t.end[0] + 1)} - texts
    assert len(code) < 480


def test_every_function_says_what_it_does() -> None:
    public = [n for n in TREE.body if isinstance(n, (ast.FunctionDef, ast.ClassDef)) and not n.name.startswith("_")]
    assert all(ast.get_docstring(node) for node in public)
