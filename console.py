"""Where the words of the command line go: to a reader, or one JSON document to a program."""

from __future__ import annotations

import json as json_module
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class Printer:
    """Where a verb's words, document and progress go."""

    def __init__(self, json: bool, quiet: bool, verbose: bool) -> None:
        """Keep the three switches that every verb has."""
        self.json, self.quiet, self.verbose = json, quiet, verbose

    def silent(self) -> Printer:
        """The same, but for words and documents: for work inside a job that says more itself."""
        return Printer(False, True, False)

    def say(self, *lines: Any) -> None:
        """Print for a reader: to standard output, or to standard error where a document is asked for."""
        if self.quiet:
            return
        from rich.console import Console

        # In a pipe there is no terminal to fit into: rich would take 80 columns.
        stream = sys.stderr if self.json else sys.stdout
        console = Console(file=stream, highlight=False, soft_wrap=True, width=None if stream.isatty() else 120)
        for line in lines:
            console.print(line, markup=False)

    def detail(self, *lines: Any) -> None:
        """Print where the reader asked for more."""
        if self.verbose:
            self.say(*lines)

    def document(self, content: Any) -> None:
        """Print the one JSON document, where it is asked for."""
        if self.json:
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
