"""The versions that an output came from."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("gaincert", "casadi", "clarabel", "cvxpy", "numpy", "python-flint", "scipy", "sympy")


def versions() -> dict[str, str]:
    """Name -> version of Python and of the packages that results depend on."""
    return {"python": platform.python_version(), **{name: _version(name) for name in PACKAGES}}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
