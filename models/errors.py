"""Errors that a user can act on. The command line prints them as they are and never as a traceback."""

from __future__ import annotations


class GaincertError(Exception):
    """An expected failure: one message that names the thing, its value, what is required and what to do."""

    exit_code = 2


class InputError(GaincertError):
    """Bad input; holds every mistake found, one line each."""

    exit_code = 2

    def __init__(self, *mistakes: str) -> None:
        super().__init__("\n".join(mistakes))
        self.mistakes = mistakes


class InfeasibleError(GaincertError):
    """No gains can meet the conditions; the message names the vehicle and the condition that bind."""

    exit_code = 3


class UndecidedError(GaincertError):
    """A solver gave up or a time limit was reached before a verdict."""

    exit_code = 4
