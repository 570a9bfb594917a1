"""The output of the command line: text for a reader, or one JSON document for a program."""

from __future__ import annotations

import json as json_module
import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass
from typing import Any

from .models.errors import one_line, write_error
from .models.warning_lines import show_warnings

READER_LEFT = 141  # nobody reads standard output any more; 128 + 13: the exit code shells use after SIGPIPE


@dataclass(frozen=True)
class Outcome:
    """The result of a verb: the JSON document that it prints, and its exit code."""

    document: Any  # JSON
    exit_code: int = 0  # 0 done and true, 1 a claim is false, 4 undecided

    @classmethod
    def of(cls, document: Any, *, true: bool) -> Outcome:
        """The outcome of a verb that checks a claim."""
        return cls(document, 0 if true else 1)


class Printer:
    """Prints a verb's text, document and progress."""

    def __init__(self, json: bool, quiet: bool, verbose: bool) -> None:
        """Keep the three switches that every verb has."""
        self.json, self.quiet, self.verbose = json, quiet, verbose
        show_warnings(logging.ERROR if quiet else logging.WARNING)

    def silent(self) -> Printer:
        """The same printer, but without text and documents: for a verb that another verb calls."""
        other = copy(self)  # unlike a new Printer, a copy does not change which warnings are shown
        other.json, other.quiet, other.verbose = False, True, False
        return other

    def say(self, *lines: Any) -> None:
        """Print for a reader: to standard output, or to standard error if standard output is for the document."""
        if self.quiet:
            return
        from rich.console import Console

        # In a pipe there is no terminal to fit into: rich would take 80 columns.
        stream = sys.stderr if self.json else sys.stdout
        console = Console(file=stream, highlight=False, width=None if stream.isatty() else 120)
        with _output():
            for line in lines:
                if isinstance(line, str):  # a terminal breaks it itself
                    console.print(one_line(line), markup=False, soft_wrap=True)
                else:
                    console.print(line)

    def detail(self, *lines: Any) -> None:
        """Print only with --verbose."""
        if self.verbose:
            self.say(*lines)

    def document(self, content: Any) -> None:
        """Print the JSON document, with --json only."""
        if self.json:
            with _output():
                sys.stdout.write(json_module.dumps(content, indent=1, allow_nan=False) + "\n")

    @contextmanager
    def progress(self) -> Iterator[Any]:
        """A progress function: a bar on a terminal, nothing in a pipe."""
        if self.quiet or not sys.stderr.isatty():
            yield lambda _what, _fraction: None
            return
        from rich.console import Console
        from rich.progress import Progress

        with Progress(console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("", total=1.0)
            yield lambda what, fraction: bar.update(task, description=what, completed=fraction)


def flush() -> None:
    """Flush standard output. Raises FaultError if that fails; the text is then dropped."""
    try:
        with _output():
            sys.stdout.flush()
    except BaseException:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python would try again at its end
        raise


@contextmanager
def _output() -> Iterator[None]:
    """Turn errors of standard output into exits: with a message, or with none if nobody reads it any more."""
    try:
        yield
    except (BrokenPipeError, SystemExit):  # rich turns a broken pipe into SystemExit
        raise SystemExit(READER_LEFT) from None
    except OSError as error:
        raise write_error("standard output", error) from None
