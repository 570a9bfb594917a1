"""The application behind the command line: the options before the verb, and the switches that every verb takes."""

from __future__ import annotations

import inspect
import io
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from functools import wraps
from typing import Annotated, Any

import typer

from . import __version__
from .cli_options import Json, Quiet, Verbose
from .console import Outcome, Printer, flush
from .models.errors import FaultError, GaincertError, one_line, write_error

app = typer.Typer(
    name="gaincert",
    help="Designs, proves, certifies and simulates the gains of a fleet of differential-drive robots.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

INTERRUPTED = 130  # the exit code
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
    """Take the options before the verb."""


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


def run_application() -> None:
    """Run a command: an expected failure is one message and an exit code, and only a bug prints a traceback."""
    if isinstance(sys.stdout, io.TextIOWrapper):  # the encoding of a terminal may lack a character
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        try:
            app()
        finally:
            flush()
    except GaincertError as error:
        _fail(error)
    except OSError as error:
        _fail(write_error(error.filename or "a file", error))
    except MemoryError:
        _fail(FaultError("no memory is left; use a machine with more, or fewer vehicles, starts or workers"))
    except SystemExit as leaving:
        if leaving.code == INTERRUPTED:  # typer's exit code for a KeyboardInterrupt
            sys.stderr.write("interrupted; every file that was finished is whole\n")
        raise
    except Exception as error:  # a bug: never mistaken for a verdict
        traceback.print_exc()
        _fail(
            FaultError(f"this is a fault of gaincert ({type(error).__name__}); please report it with the lines above")
        )


def _fail(error: GaincertError) -> None:
    with suppress(OSError):  # if standard error fails too, only the exit code remains
        sys.stderr.write("".join(f"error: {one_line(line)}\n" for line in str(error).split("\n")))
    raise SystemExit(error.exit_code) from None
