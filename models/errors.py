"""Errors that a user can act on. The command line prints them as they are and never as a traceback."""

from __future__ import annotations

import difflib
import errno
from collections.abc import Iterable, Sequence
from typing import Any

NAMED = 3  # vehicles that a message about several names


class GaincertError(Exception):
    """An expected failure: one message that names the thing, its value, what is required and what to do."""

    exit_code = 2


class InputError(GaincertError):
    """Bad input; holds every mistake found, one line each, whatever line breaks or escape codes the input quotes."""

    exit_code = 2

    def __init__(self, *mistakes: str) -> None:
        self.mistakes = tuple(map(one_line, mistakes))
        super().__init__("\n".join(self.mistakes))


def one_line(text: str) -> str:
    """The text with every character that is not printable written as its escape."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


class InfeasibleError(GaincertError):
    """No gains can meet the conditions; the message names the vehicle and the condition that bind."""

    exit_code = 3


class UndecidedError(GaincertError):
    """A solver gave up or a time limit was reached before a verdict."""

    exit_code = 4


class FaultError(GaincertError):
    """The machine fails, not the input: a full disk, no memory."""

    exit_code = 5


FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.ENOMEM}  # no other input helps against these


def write_error(what: object, error: OSError, remedy: str = "") -> GaincertError:
    """The error for a file that cannot be written: FaultError for a full disk and the like, else InputError."""
    full = error.errno in FULL
    kind, remedy = (FaultError, "free some space and try again") if full else (InputError, remedy)
    return kind(f"{what}: cannot be written: {error.strerror or error}" + (f"; {remedy}" if remedy else ""))


def last_line(error: Exception) -> str:
    """The last line of another library's error message; the reason is there."""
    lines = [line for line in str(error).splitlines() if line.strip()]
    return lines[-1][:200] if lines else "no message"


def did_you_mean(word: Any, known: Iterable[str]) -> str:
    """A similar known word in brackets, capitals or not; empty without one."""
    small = {str(name).lower(): name for name in list(known)[:2000]}
    close = difflib.get_close_matches(str(word).lower(), list(small), 1)
    return f" (did you mean {small[close[0]]!r}?)" if close else ""


def some_vehicles(quoted: Sequence[str]) -> str:
    """Several vehicles for a message: the first names, in quotes already, and how many more there are."""
    more = f" and {len(quoted) - NAMED} more" if len(quoted) > NAMED else ""
    return f"vehicles {', '.join(quoted[:NAMED])}{more}"


def shown(value: Any) -> str:
    """A value for a message, shortened if it is long."""
    try:
        text = repr(value) if isinstance(value, str) else str(value)
    except (ValueError, RecursionError):  # an integer of thousands of digits, tables nested too deeply
        return "(too long to show)"
    return text if len(text) <= 60 else f"{text[:57]}..."
