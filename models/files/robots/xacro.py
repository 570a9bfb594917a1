"""xacro files are expanded by the `xacro` package, in a process of its own with a bound on time and memory.

A xacro file is a program: it includes files and evaluates expressions. The package evaluates them without Python's
built-in functions; the separate process stops files that compute forever.
"""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from ...errors import InputError, one_line

TIME_LIMIT = 60.0  # s
MEMORY_LIMIT = 2 * 2**30  # bytes
_PROGRAM = f"""
import sys
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, ({MEMORY_LIMIT}, {MEMORY_LIMIT}))
except ImportError:  # Windows
    pass
import xacro
sys.argv[0] = "xacro"
xacro.main()
"""


def expand(path: Path, max_bytes: int, time_limit: float = TIME_LIMIT) -> str:
    """The URDF text of a xacro file. Raises InputError if the package is missing or cannot expand the file."""
    if find_spec("xacro") is None:
        raise InputError(
            f"{path}: this is xacro, and the package that expands it is missing: "
            f"pip install 'gaincert[robots]', or run `xacro {path.name} > robot.urdf` and name robot.urdf"
        )
    try:
        run = subprocess.run(  # noqa: S603 -- this interpreter, with a program that is fixed
            # -P: no module is imported from the current folder.
            [sys.executable, "-P", "-c", _PROGRAM, str(path.resolve())],
            capture_output=True,
            timeout=time_limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise InputError(f"{path}: this is xacro and does not expand within {time_limit:g} s; simplify it") from None
    text = run.stdout.decode(errors="replace")
    if run.returncode:
        lines = [line for line in run.stderr.decode(errors="replace").splitlines() if line.strip()]
        reason = one_line(lines[0])[:200] if lines else f"exit code {run.returncode}"
        raise InputError(
            f"{path}: this is xacro and does not expand: {reason}; source the ROS workspace that it needs, or run "
            f"`xacro {path.name} NAME:=VALUE > robot.urdf` there and name robot.urdf"
        )
    if len(run.stdout) > max_bytes:
        raise InputError(f"{path}: this is xacro and expands to more than {max_bytes // 2**20} MiB; simplify it")
    return text
