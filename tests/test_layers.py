"""Imports run one way: models <- synthesis <- verify <- reports <- cli; the kernel imports nothing of ours."""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LAYERS = ["models", "synthesis", "verify", "reports", "console", "jobs", "cli"]
FOLDERS = LAYERS[:4]
SOURCES = [path for layer in FOLDERS for path in sorted((ROOT / layer).rglob("*.py"))]
SOURCES += [ROOT / f"{module}.py" for module in LAYERS[4:]]


def imported_layers(path: Path) -> set[str]:
    package = path.relative_to(ROOT).parent.parts
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = package[: len(package) - node.level + 1]
            found.add((*base, *(node.module or "").split("."))[0])
    return found & set(LAYERS)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_go_down(path: Path) -> None:
    own = path.relative_to(ROOT).parts[0].removesuffix(".py")
    above = LAYERS[LAYERS.index(own) + 1 :]
    assert not imported_layers(path) & set(above)


def test_the_test_sees_imports() -> None:
    assert imported_layers(ROOT / "verify" / "certificate.py") >= {"models", "synthesis"}


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
