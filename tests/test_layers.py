"""Imports run one way, without a circle: models <- parallel <- synthesis <- verify <- reports <- workflows <- cli."""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LAYERS = [
    "models",
    "parallel",
    "synthesis",
    "verify",
    "reports",
    "console",
    "workflows",
    "cli_options",
    "cli_app",
    "cli",
]
FOLDERS = ["models", "synthesis", "verify", "reports", "workflows"]
SOURCES = [
    path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py")) if "templates" not in path.parts
]
SOURCES += [ROOT / f"{module}.py" for module in LAYERS if module not in FOLDERS]


def module_of(path: Path, root: Path = ROOT) -> tuple[str, ...]:
    parts = path.relative_to(root).with_suffix("").parts
    return parts[:-1] if parts[-1] == "__init__" else parts


def imports_of(path: Path, modules: set[tuple[str, ...]], root: Path = ROOT) -> set[tuple[str, ...]]:
    """Our own modules that a file imports, also under TYPE_CHECKING and inside functions."""
    package = path.relative_to(root).parent.parts
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = (*package[: len(package) - node.level + 1], *filter(None, (node.module or "").split(".")))
            names = {(*base, alias.name) for alias in node.names}
            found |= {name if name in modules else base for name in names}
    return found & modules


def circle(imports: dict[tuple[str, ...], set[tuple[str, ...]]]) -> list[tuple[str, ...]]:
    """A circle of imports, empty without one."""
    done: set[tuple[str, ...]] = set()

    def visit(module: tuple[str, ...], path: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
        if module in path:
            return path[path.index(module) :]
        if module not in done:
            for other in sorted(imports[module]):
                if found := visit(other, [*path, module]):
                    return found
            done.add(module)
        return []

    return next((found for module in sorted(imports) if (found := visit(module, []))), [])


def graph_of(sources: list[Path], root: Path = ROOT) -> dict[tuple[str, ...], set[tuple[str, ...]]]:
    modules = {module_of(path, root) for path in sources}
    return {module_of(path, root): imports_of(path, modules, root) for path in sources}


IMPORTS = graph_of(SOURCES)


@pytest.mark.parametrize("module", IMPORTS, ids=".".join)
def test_imports_go_down(module: tuple[str, ...]) -> None:
    above = LAYERS[LAYERS.index(module[0]) + 1 :]
    assert not {other for other in IMPORTS[module] if other[0] in above}


def test_no_two_files_import_each_other() -> None:
    assert circle(IMPORTS) == []


def test_a_planted_circle_is_found(tmp_path: Path) -> None:
    """The circle goes through three files. One import is inside a function, one under TYPE_CHECKING."""
    (tmp_path / "a.py").write_text("from .b import x\n")
    (tmp_path / "b.py").write_text("def f():\n    from . import c\n")
    (tmp_path / "c.py").write_text("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from .a import y\n")
    found = circle(graph_of(sorted(tmp_path.glob("*.py")), tmp_path))
    assert sorted(found) == [("a",), ("b",), ("c",)]


def test_the_test_sees_imports() -> None:
    assert {module[0] for module in IMPORTS["reports", "html", "page"]} >= {"models", "verify", "reports"}


def test_the_kernel_imports_the_standard_library_only() -> None:
    modules = set()
    for node in ast.walk(ast.parse((ROOT / "verify" / "kernel.py").read_text())):
        if isinstance(node, ast.Import):
            modules |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            modules.add((node.module or "").split(".")[0])
    assert modules <= sys.stdlib_module_names


def test_what_models_exports_is_there_and_nothing_else() -> None:
    from gaincert import models

    assert [getattr(models, name).__name__ for name in models.__all__] == models.__all__
    with pytest.raises(AttributeError, match="no attribute 'Robot'"):
        _ = models.Robot
