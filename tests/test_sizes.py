"""Files and functions stay small enough to read: CONTRIBUTING.md gives the limits."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = ("models", "synthesis", "verify", "reports", "workflows")
SOURCES = sorted([*ROOT.glob("*.py"), *(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))])
KERNEL = ROOT / "verify" / "kernel.py"  # one file on purpose; its own test limits it
LINES, FUNCTION_LINES, PARAMETERS = 300, 60, 7


def functions():
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield f"{path.relative_to(ROOT)}: {node.name}", node


def body_lines(function):
    """Lines of a function without its docstring."""
    first = function.body[0]
    documented = ast.get_docstring(function) is not None
    return function.end_lineno - function.lineno + 1 - documented * (first.end_lineno - first.lineno + 1)


def test_no_file_is_long():
    long = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in SOURCES if path != KERNEL}
    assert {name: lines for name, lines in long.items() if lines > LINES} == {}


def test_no_function_is_long():
    assert {name: body_lines(node) for name, node in functions() if body_lines(node) > FUNCTION_LINES} == {}


def test_no_function_takes_many_parameters():
    """Keyword-only options do not count: their names stand at every call."""
    counts = {name: len(node.args.posonlyargs) + len(node.args.args) for name, node in functions()}
    assert {name: count for name, count in counts.items() if count > PARAMETERS} == {}
