"""Warnings as lines on standard error, in the command line's format, from this process and its workers."""

from __future__ import annotations

import logging
import sys

from .errors import one_line

LOGGER = logging.getLogger("gaincert")


class _Line(logging.Handler):
    """One line per message: `warning: ...`, like `error: ...` of the command line."""

    def emit(self, record: logging.LogRecord) -> None:
        try:
            sys.stderr.write(f"{record.levelname.lower()}: {one_line(record.getMessage())}\n")
        except OSError:
            self.handleError(record)


def show_warnings(level: int) -> None:
    """Write messages of gaincert's own loggers from `level` up; a second call changes the level only."""
    LOGGER.setLevel(level)
    if not any(isinstance(handler, _Line) for handler in LOGGER.handlers):
        LOGGER.addHandler(_Line())


def shown_level() -> int | None:
    """The level of `show_warnings`, None before the first call: a library leaves logging to its user."""
    return LOGGER.level if any(isinstance(handler, _Line) for handler in LOGGER.handlers) else None
