"""pyproject.toml installs all packages and files."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
LAYERS = ("models", "synthesis", "verify", "reports", "workflows")


def test_every_package_is_installed():
    folders = {path.parent.relative_to(ROOT).parts for layer in LAYERS for path in (ROOT / layer).rglob("__init__.py")}
    packages = {"gaincert", *(".".join(("gaincert", *parts)) for parts in folders)}
    assert set(PROJECT["tool"]["setuptools"]["packages"]) == packages


def test_files_beside_the_code_are_installed():
    for package, patterns in PROJECT["tool"]["setuptools"]["package-data"].items():
        folder = ROOT.joinpath(*package.split(".")[1:])
        for pattern in patterns:
            assert list(folder.glob(pattern)), (package, pattern)


def test_the_changelog_speaks_of_this_version():
    versions = re.findall(r"^## \[(.*?)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert versions[0] == PROJECT["project"]["version"]
