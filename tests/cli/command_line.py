"""The command line in this process, without the cost of a start."""

from __future__ import annotations

import contextlib
import io
import sys
from pathlib import Path
from typing import NamedTuple

from gaincert.cli import main


class Done(NamedTuple):
    """The result of a command."""

    returncode: int
    stdout: str
    stderr: str


def gaincert(*arguments: object, cwd: Path | None = None) -> Done:
    """Run a command in a folder; any exception except an exit is raised."""
    out, err, before = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["gaincert", *map(str, arguments)]
    code = 0
    try:
        with (
            contextlib.chdir(cwd) if cwd else contextlib.nullcontext(),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
        ):
            main()
    except SystemExit as leaving:
        code = int(leaving.code or 0)
    finally:
        sys.argv = before
    return Done(code, out.getvalue(), err.getvalue())
