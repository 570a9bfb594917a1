"""The application behind the command line: the options before the verb, and the switches that every verb takes."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any

import typer

from . import __version__
from .cli_options import Json, Quiet, Verbose
from .console import Outcome, Printer

app = typer.Typer(
    name="gaincert",
    help="Designs, proves, certifies and simulates the gains of a fleet of differential-drive robots.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

SWITCHES = {"json": Json, "quiet": Quiet, "verbose": Verbose}  # of every verb


def _print_version(wanted: bool) -> None:
    if wanted:
        sys.stdout.write(f"gaincert {__version__}\n")
        raise typer.Exit


@app.callback()
def main_options(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="print the version and exit")
    ] = False,
) -> None:
    """Take the options that stand before the verb."""


def verb(function: Callable[..., Outcome]) -> Callable[..., None]:
    """Register a verb: it gets a Printer with the switches; its outcome is printed and sets the exit code."""

    @wraps(function)
    def called(*, json: bool, quiet: bool, verbose: bool, **options: Any) -> None:
        printer = Printer(json, quiet, verbose)
        outcome = function(printer, **options)
        printer.document(outcome.document)
        if outcome.exit_code:
            raise typer.Exit(outcome.exit_code)

    signature = inspect.signature(function, eval_str=True)
    kind = inspect.Parameter.KEYWORD_ONLY
    switches = [inspect.Parameter(name, kind, default=False, annotation=hint) for name, hint in SWITCHES.items()]
    parameters = [*list(signature.parameters.values())[1:], *switches]
    called.__signature__ = signature.replace(parameters=parameters, return_annotation=None)  # type: ignore[attr-defined]
    called.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    app.command()(called)
    return called
