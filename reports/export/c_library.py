"""The exported controller as a shared library of this machine."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from ...models.errors import InputError, last_line
from ..deployment import Deployment
from .c_controller import NAME, c_files

COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-std=c99", "-O2", "-shared", "-fPIC")


def build_library(deployed: Deployment, folder: Path) -> Path:
    """Write the C export into a folder and compile it there. Raises InputError where that cannot be done."""
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None:
        raise InputError(f"no C compiler was found ({', '.join(COMPILERS)}); install one, such as gcc")
    for name, text in c_files(deployed).items():
        (folder / name).write_text(text)
    library = folder / f"lib{NAME}.so"
    command = [compiler, *FLAGS, str(folder / f"{NAME}.c"), "-o", str(library), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 -- our own file
    if done.returncode:
        raise InputError(f"{compiler} does not compile the controller: {last_line(RuntimeError(done.stderr))}")
    return library
