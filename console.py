"""Where the words of the command line go: to a reader, or one JSON document to a program."""

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

READER_LEFT = 141  # the exit code where nobody reads standard output any more, as a shell says it of SIGPIPE


@dataclass(frozen=True)
class Outcome:
    """What a verb came to: the JSON document that it prints, and its exit code."""

    document: Any  # JSON
    exit_code: int = 0  # 0 done and true, 1 a claim is false, 4 undecided

    @classmethod
    def of(cls, document: Any, *, true: bool) -> Outcome:
        """The outcome of a verb that checks a claim."""
        return cls(document, 0 if true else 1)


class Printer:
    """Where a verb's words, document and progress go."""

    def __init__(self, json: bool, quiet: bool, verbose: bool) -> None:
        """Keep the three switches that every verb has."""
        self.json, self.quiet, self.verbose = json, quiet, verbose
        show_warnings(logging.ERROR if quiet else logging.WARNING)

    def silent(self) -> Printer:
        """The same, but for words and documents: for work inside a job that says more itself."""
        other = copy(self)  # which leaves warnings as they are
        other.json, other.quiet, other.verbose = False, True, False
        return other

    def say(self, *lines: Any) -> None:
        """Print for a reader: to standard output, or to standard error where a document is asked for."""
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
        """Print where the reader asked for more."""
        if self.verbose:
            self.say(*lines)

    def document(self, content: Any) -> None:
        """Print the one JSON document, where it is asked for."""
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
    """Hand over what was said. Raises FaultError where standard output does not take it, which is then dropped."""
    try:
        with _output():
            sys.stdout.flush()
    except BaseException:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python would try again at its end
        raise


@contextmanager
def _output() -> Iterator[None]:
    """What the system says of standard output as an exit: a message, or none where the reader has left."""
    try:
        yield
    except (BrokenPipeError, SystemExit):  # rich makes an exit of the one
        raise SystemExit(READER_LEFT) from None
    except OSError as error:
        raise write_error("standard output", error) from None
