"""The command line: parses, calls, prints; no mathematics. Everything heavy is imported by the verb that needs it."""

from __future__ import annotations

import io
import sys
from contextlib import suppress
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from .console import Printer, flush
from .models.errors import GaincertError, one_line
from .workflows import (
    certify_gains,
    compare_designs,
    design_gains,
    disturbance_of,
    prove_claims,
    question_of,
    read_fleet,
    read_gains,
    replay_start,
    simulate_schemes,
    starts_of,
    theorem_holds,
    tolerance_of,
    validate_starts,
    write_design,
)

app = typer.Typer(
    name="gaincert",
    help="Designs, proves, certifies and simulates the gains of a fleet of differential-drive robots.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

INTERRUPTED = 130  # the exit code


class Template(StrEnum):
    """Fleets that `init` writes."""

    paper = "paper"
    line = "line"
    ring = "ring"
    turtlebot3 = "turtlebot3"


class Mode(StrEnum):
    """How long to look."""

    fast = "fast"
    best = "best"


class Conditions(StrEnum):
    """Condition sets."""

    paper = "paper"
    corrected = "corrected"
    rate_bounded = "rate-bounded"


class Source(StrEnum):
    """Where psi comes from."""

    given = "given"
    designed = "designed"


class Format(StrEnum):
    """What robots and papers load."""

    ros2 = "ros2"
    c = "c"
    latex = "latex"
    csv = "csv"
    markdown = "markdown"


class Animation(StrEnum):
    """Kinds of moving pictures."""

    gif = "gif"
    mp4 = "mp4"


class Scheme(StrEnum):
    """The paper's controller, or its comparison with tanh(s) replaced by s."""

    bounded = "bounded"
    unbounded = "unbounded"


class Engine(StrEnum):
    """What simulates."""

    auto = "auto"
    cvodes = "cvodes"
    scale = "scale"


class Method(StrEnum):
    """How `validate` integrates."""

    auto = "auto"
    cvodes = "cvodes"
    dop853 = "dop853"


FleetPath = Annotated[Path, typer.Argument(metavar="FLEET.toml", help="the fleet file")]
GainsPath = Annotated[Path, typer.Option("--gains", help="a design.json, gains.csv or gains.toml")]
FolderFleet = Annotated[
    Path | None, typer.Option("--fleet", metavar="FLEET.toml", help="[default: the copy that lies in DIR]")
]
Folder = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="the folder that the files are written to")]
Json = Annotated[bool, typer.Option("--json", help="print one JSON document; messages go to standard error")]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="print errors only")]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="print more")]
ConditionsOption = Annotated[Conditions, typer.Option(help="(15) and (16); (16*) alone; (15') and (16*)")]
ModeOption = Annotated[Mode, typer.Option(help="seconds, or a search within the time limit")]
ExcitationOption = Annotated[
    Source | None, typer.Option(help="psi of the fleet file, or a designed one [default: given where the file has one]")
]
WeightsOption = Annotated[Source, typer.Option(help="a_ij and a_il of the fleet file, or better ones on its links")]
Seed = Annotated[int, typer.Option(min=0, help="of the random starts and of the search")]
TimeLimit = Annotated[float, typer.Option(min=1, help="s of wall clock that --mode best searches for")]
Digits = Annotated[int, typer.Option(min=2, max=15, help="significant digits of every gain")]
Horizon = Annotated[float | None, typer.Option(min=0.1, max=1e6, help="s [default: until settled and a while longer]")]
Box = Annotated[
    float | None,
    typer.Option(
        min=0,
        max=1e6,
        metavar="M",
        help="side of the square around the goal of starts [default: the fleet's own scale]",
    ),
]
ToleranceOption = Annotated[tuple[float, float], typer.Option(metavar="M RAD", help="what counts as settled")]


SampleTime = Annotated[
    float | None,
    typer.Option(min=1e-4, max=10, metavar="S", help="also with torques computed at this interval and held in between"),
]


@app.command()
def init(
    fleet_path: FleetPath,
    template: Annotated[Template, typer.Option(help="the kind of fleet")] = Template.paper,
    vehicles: Annotated[int | None, typer.Option(min=1, max=1_000_000, help="how many, for line and ring")] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Write a fleet file to start from."""
    from .models.errors import InputError
    from .models.files.templates import template_text
    from .models.files.text import write_text

    printer = Printer(json, quiet, verbose)
    if fleet_path.exists():
        raise InputError(f"{fleet_path}: is already there; choose another name or remove it")
    write_text(fleet_path, template_text(template.value, vehicles))
    printer.say(f"wrote {fleet_path}; next: gaincert check {fleet_path}")
    printer.document({"fleet": str(fleet_path), "template": template.value})


@app.command()
def check(fleet_path: FleetPath, json: Json = False, quiet: Quiet = False, verbose: Verbose = False) -> None:
    """Read a fleet file and say what is in it, or all that is wrong with it."""
    from .reports.tables.fleet_summary import fleet_summary

    printer = Printer(json, quiet, verbose)
    summary = fleet_summary(read_fleet(fleet_path))
    printer.say(*(f"{key:24} {value}" for key, value in summary.items()))
    printer.document(summary)


@app.command()
def prove(
    folder: Annotated[Path | None, typer.Option("-o", "--output", metavar="DIR", help="also write the report")] = None,
    fleet: Annotated[
        Path | None, typer.Option(metavar="FLEET.toml", help="for its numbers [default: the paper's]")
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Check the paper's claims and the corrected theorem symbolically."""
    printer = Printer(json, quiet, verbose)
    claims = prove_claims(printer, None if fleet is None else read_fleet(fleet), folder)
    if not theorem_holds(claims):
        raise typer.Exit(1)


@app.command()
def design(
    fleet_path: FleetPath,
    folder: Folder,
    mode: ModeOption = Mode.fast,
    conditions: ConditionsOption = Conditions.paper,
    excitation: ExcitationOption = None,
    weights: WeightsOption = Source.given,
    seed: Seed = 0,
    time_limit: TimeLimit = 600.0,
    digits: Digits = 4,
    tolerance: ToleranceOption = (0.1, 0.1),
    box: Box = None,
    compare: Annotated[
        bool, typer.Option("--compare", help="also design under all other conditions, psi and weights, and measure all")
    ] = False,
    against: Annotated[
        Path | None, typer.Option(metavar="GAINS", help="also measure the gains of this file from the same starts")
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Choose gains that settle the fleet fast, within the conditions."""
    printer = Printer(json, quiet, verbose)
    fleet = read_fleet(fleet_path)
    options = {
        "conditions": conditions,
        "excitation": excitation,
        "weights": weights,
        "seed": seed,
        "digits": digits,
        "time_limit": time_limit,
        "tolerance": tolerance_of(tolerance),
        "box": box,
    }
    if against is not None:
        read_gains(against, fleet)  # what is wrong with it is said before the work begins
    made = design_gains(printer, fleet, mode=mode, **options)
    document = write_design(printer, made, folder)
    if compare or against is not None:
        document["compared"] = compare_designs(printer, fleet, made, folder, compare, against, **options)
    printer.document(document)


@app.command()
def certify(
    fleet_path: FleetPath,
    gains: GainsPath,
    folder: Folder,
    conditions: Annotated[Conditions | None, typer.Option(help="[default: the design's own, else paper]")] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Certify gains, whoever chose them."""
    printer = Printer(json, quiet, verbose)
    fleet = read_fleet(fleet_path)
    chosen = read_gains(gains, fleet)
    name = conditions.value if conditions else chosen.conditions or "paper"
    document = certify_gains(printer, fleet, chosen, name, folder)
    printer.document(document)
    if not document["valid"]:
        raise typer.Exit(1)


@app.command()
def verify(
    certificate: Annotated[Path, typer.Argument(metavar="CERTIFICATE.json")],
    fleet: Annotated[
        Path | None, typer.Option(metavar="FLEET.toml", help="also check that it is of this fleet")
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Check a certificate again, with the trusted kernel alone."""
    from .verify.certificates.certify import verify as verify_file

    printer = Printer(json, quiet, verbose)
    verdict = verify_file(certificate, None if fleet is None else read_fleet(fleet))
    printer.say(*str(verdict).split("\n"))
    printer.document(
        {"valid": verdict.valid, "rule": verdict.rule, "reason": verdict.reason, "theorem": verdict.theorem}
    )
    if not verdict.valid:
        raise typer.Exit(1)


@app.command()
def simulate(
    fleet_path: FleetPath,
    gains: GainsPath,
    folder: Folder,
    scheme: Annotated[
        Scheme, typer.Option(help="the paper's controller, or its unbounded comparison")
    ] = Scheme.bounded,
    horizon: Horizon = None,
    sample_time: SampleTime = None,
    seed: Annotated[int, typer.Option(min=0, help="of the noise and the mismatch of a [disturbance] table")] = 0,
    tolerance: ToleranceOption = (0.1, 0.1),
    engine: Annotated[Engine, typer.Option(help="cvodes, or the explicit engine for large fleets")] = Engine.auto,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Simulate the fleet from its start and draw what happens."""
    printer = Printer(json, quiet, verbose)
    fleet = read_fleet(fleet_path)
    chosen, wide = read_gains(gains, fleet), tolerance_of(tolerance)
    real = disturbance_of(fleet, seed, sample_time=sample_time)
    summary = simulate_schemes(printer, fleet, chosen, folder, (scheme,), horizon, wide, engine, real)
    printer.document(summary)
    if summary["violations"]:
        raise typer.Exit(1)


@app.command()
def validate(
    fleet_path: FleetPath,
    gains: GainsPath,
    folder: Folder,
    starts: Annotated[int, typer.Option(min=1, max=1_000_000, help="how many random starts at rest")] = 100,
    starts_file: Annotated[
        Path | None, typer.Option(metavar="CSV", help="start,vehicle,x,y,theta,v,omega; instead of random starts")
    ] = None,
    box: Box = None,
    seed: Seed = 0,
    horizon: Annotated[float, typer.Option(min=0.1, max=1e6, help="s that every start runs for")] = 300.0,
    tolerance: ToleranceOption = (0.1, 0.1),
    workers: Annotated[
        int | None, typer.Option(min=1, max=1024, help="processes [default: one for every core]")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="tcp://HOST:PORT", help="a Dask cluster that does the work instead")
    ] = None,
    integrator: Annotated[
        Method, typer.Option(help="auto: cvodes in two stages; dop853: an independent check, slowly")
    ] = Method.auto,
    sample_time: SampleTime = None,
    delay: Annotated[float | None, typer.Option(metavar="S", help="from measuring to the wheels")] = None,
    noise: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="M RAD", help="standard deviation of measured positions and headings"),
    ] = None,
    mismatch: Annotated[
        float | None, typer.Option(help="relative error of mass, inertia, wheel radius and track")
    ] = None,
    friction: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="NM NMS", help="Coulomb (N m) and viscous (N m s) at every wheel"),
    ] = None,
    lost_link: Annotated[
        tuple[str, str, float] | None, typer.Option(metavar="V1 V2 S", help="the edge between them fails at that time")
    ] = None,
    largest_sample_time: Annotated[
        bool, typer.Option("--largest-sample-time", help="find it: all starts settle, torques within limits")
    ] = False,
    replay: Annotated[
        int | None, typer.Option(min=0, metavar="K", help="run start K alone, again, and store its trajectory")
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Run the fleet from many starts; a broken run goes on where it stopped."""
    printer = Printer(json, quiet, verbose)
    fleet = read_fleet(fleet_path)
    chosen, wide = read_gains(gains, fleet), tolerance_of(tolerance)
    count = starts if replay is None else max(starts, replay + 1)
    states, origin = starts_of(fleet, count, starts_file, seed, box)
    question = question_of(fleet, chosen, origin, horizon, wide, integrator)
    if replay is not None:
        document = replay_start(printer, question, states, replay, folder)
        printer.document(document)
        if document["same"] is False:
            raise typer.Exit(1)
        return
    real = disturbance_of(
        fleet,
        seed,
        sample_time=sample_time,
        delay=delay,
        mismatch=mismatch,
        **dict(zip(("noise_position", "noise_heading"), noise or (), strict=False)),
        **dict(zip(("coulomb", "viscous"), friction or (), strict=False)),
        **({"lost_link": lost_link[:2], "lost_at": lost_link[2]} if lost_link else {}),
    )
    document = validate_starts(
        printer,
        fleet,
        question,
        states,
        folder,
        seed=None if starts_file else seed,
        workers=workers,
        scheduler=scheduler,
        real=real,
        largest=largest_sample_time,
    )
    printer.document(document)
    if document["violations"] or any(entry["peak_torque_ratio"] > 1 for entry in document.get("disturbed", [])):
        raise typer.Exit(1)
    if any(failure.get("gave_up") for failure in document["failures"]):
        raise typer.Exit(4)


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="a folder that other verbs wrote to")],
    animate: Annotated[
        Animation | None, typer.Option(help="also write animation.gif or .mp4 (which needs ffmpeg)")
    ] = None,
    fleet: FolderFleet = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Gather all that lies in a folder into one HTML report."""
    from .reports.html.report import write_report

    printer = Printer(json, quiet, verbose)
    document = {"report": str(write_report(folder, fleet))}
    if animate is not None:
        from .reports.figures.movie import write_movie

        with printer.progress() as progress:
            document["animation"] = str(write_movie(folder, animate.value, fleet, progress))
    printer.say(*(f"{kind}: {path}" for kind, path in document.items()))
    printer.document(document)


@app.command()
def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="a folder with a design.json or certificate.json")],
    kind: Annotated[Format, typer.Option("--format", help="what for")],
    fleet: FolderFleet = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Write the gains for robots (ros2, c) and for papers (latex, csv, markdown)."""
    from .reports.export.export import export as export_files

    printer = Printer(json, quiet, verbose)
    paths = [str(path) for path in export_files(folder, kind.value, fleet)]
    printer.say(*(f"wrote {path}" for path in paths))
    printer.document({"format": kind.value, "files": paths})


@app.command()
def run(
    fleet_path: FleetPath,
    folder: Folder,
    mode: ModeOption = Mode.fast,
    conditions: ConditionsOption = Conditions.paper,
    excitation: ExcitationOption = None,
    weights: WeightsOption = Source.given,
    seed: Seed = 0,
    time_limit: TimeLimit = 600.0,
    digits: Digits = 4,
    horizon: Horizon = None,
    tolerance: ToleranceOption = (0.1, 0.1),
    box: Box = None,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Design, certify, prove, simulate and report: the whole job."""
    from .models.files.gains_file import GainsFile
    from .reports.html.report import write_report

    printer = Printer(json, quiet, verbose)
    fleet = read_fleet(fleet_path)
    settled = tolerance_of(tolerance)
    made = design_gains(
        printer,
        fleet,
        mode=mode,
        conditions=conditions,
        excitation=excitation,
        weights=weights,
        seed=seed,
        time_limit=time_limit,
        digits=digits,
        tolerance=settled,
        box=box,
    )
    document = {"design": write_design(printer, made, folder)}
    chosen = GainsFile(made.gains, made.excitation, conditions.value, made.links)
    document["certificate"] = certify_gains(printer, fleet, chosen, conditions.value, folder)
    claims = prove_claims(printer, fleet, folder, part_of_run=True)
    if fleet.start() is None:
        printer.say("simulation: left out, because the fleet file has no start for every vehicle")
    else:
        real = disturbance_of(fleet, seed)
        document["summary"] = simulate_schemes(
            printer, fleet, chosen, folder, tuple(Scheme), horizon, settled, real=real
        )
    path = write_report(folder)
    printer.say(f"report: {path}")
    printer.document({**document, "report": str(path)})
    broken = document.get("summary", {}).get("violations", [])
    if broken or not document["certificate"]["valid"] or not theorem_holds(claims):
        raise typer.Exit(1)


def main() -> None:
    """The entry point: an expected failure is one message and an exit code, never a traceback."""
    if isinstance(sys.stdout, io.TextIOWrapper):  # the encoding of a terminal may lack a character
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        try:
            app()
        finally:
            flush()
    except GaincertError as error:
        _complain(*str(error).split("\n"))
        raise SystemExit(error.exit_code) from None
    except OSError as error:
        _complain(f"{error.filename or 'the system'}: {error.strerror or error}")
        raise SystemExit(GaincertError.exit_code) from None
    except SystemExit as leaving:
        if leaving.code == INTERRUPTED:  # what typer makes of a KeyboardInterrupt
            sys.stderr.write("interrupted; every file that was finished is whole\n")
        raise


def _complain(*lines: str) -> None:
    with suppress(OSError):  # where standard error takes nothing either, the exit code says it
        sys.stderr.write("".join(f"error: {one_line(line)}\n" for line in lines))


if __name__ == "__main__":
    main()
