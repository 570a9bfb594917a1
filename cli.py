"""The command line: parses, calls, prints; no mathematics. Everything heavy is imported by the verb that needs it."""

from __future__ import annotations

import json as json_module
import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .models.errors import GaincertError

if TYPE_CHECKING:
    from .models.fleet import Fleet
    from .models.gains_file import GainsFile
    from .synthesis.rollout import Tolerance
    from .verify.disturbance import Disturbance
    from .verify.recording import Recording
    from .verify.simulate import Trajectory
    from .verify.validate import Question

app = typer.Typer(
    name="gaincert",
    help="Designs, proves, certifies and simulates the gains of a fleet of differential-drive robots.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


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
TimeLimit = Annotated[float, typer.Option(min=1, help="s of wall clock for --mode best")]
Digits = Annotated[int, typer.Option(min=2, max=15, help="significant digits of every gain")]
Horizon = Annotated[float | None, typer.Option(min=0.1, max=1e6, help="s [default: until settled and a while longer]")]
ToleranceOption = Annotated[tuple[float, float], typer.Option(metavar="M RAD", help="what counts as settled")]


SampleTime = Annotated[
    float | None,
    typer.Option(min=1e-4, max=10, metavar="S", help="also with torques computed at this interval and held in between"),
]


class Printer:
    """Where a verb's words, document and progress go."""

    def __init__(self, json: bool, quiet: bool, verbose: bool) -> None:
        """Keep the three switches that every verb has."""
        self.json, self.quiet, self.verbose = json, quiet, verbose

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
    from .models.files import write_text
    from .models.templates import template_text

    printer = Printer(json, quiet, verbose)
    if fleet_path.exists():
        raise InputError(f"{fleet_path}: is already there; choose another name or remove it")
    write_text(fleet_path, template_text(template.value, vehicles))
    printer.say(f"wrote {fleet_path}; next: gaincert check {fleet_path}")
    printer.document({"fleet": str(fleet_path), "template": template.value})


@app.command()
def check(fleet_path: FleetPath, json: Json = False, quiet: Quiet = False, verbose: Verbose = False) -> None:
    """Read a fleet file and say what is in it, or all that is wrong with it."""
    from .reports.fleet_summary import fleet_summary

    printer = Printer(json, quiet, verbose)
    summary = fleet_summary(_fleet(fleet_path))
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
    claims = _prove(printer, None if fleet is None else _fleet(fleet), folder)
    if not _theorem_holds(claims):
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
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Choose gains that settle the fleet fast, within the conditions."""
    printer = Printer(json, quiet, verbose)
    made = _design(
        printer,
        _fleet(fleet_path),
        mode,
        conditions,
        excitation,
        weights,
        seed,
        time_limit,
        digits,
        _tolerance(tolerance),
    )
    printer.document(_write_design(printer, made, folder))


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
    fleet = _fleet(fleet_path)
    chosen = _gains(gains, fleet)
    name = conditions.value if conditions else chosen.conditions or "paper"
    document = _certify(printer, fleet, chosen, name, folder)
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
    from .verify.certificate import verify as verify_file

    printer = Printer(json, quiet, verbose)
    verdict = verify_file(certificate, None if fleet is None else _fleet(fleet))
    printer.say(str(verdict))
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
    fleet = _fleet(fleet_path)
    chosen, wide = _gains(gains, fleet), _tolerance(tolerance)
    real = _disturbance(fleet, seed, sample_time=sample_time)
    summary = _simulate(printer, fleet, chosen, folder, (scheme,), horizon, wide, engine, real)
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
    box: Annotated[
        float | None,
        typer.Option(min=0, metavar="M", help="side of the square around the goal [default: the fleet's own scale]"),
    ] = None,
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
    from .reports.versions import versions
    from .verify.validate import ask

    printer = Printer(json, quiet, verbose)
    fleet = _fleet(fleet_path)
    chosen, wide = _gains(gains, fleet), _tolerance(tolerance)
    count = starts if replay is None else max(starts, replay + 1)
    states, origin = _starts(fleet, count, starts_file, seed, box)
    question = ask(
        fleet.with_links(chosen.links),
        chosen.gains,
        chosen.excitation,
        origin,
        horizon=horizon,
        tolerance=wide,
        method=integrator.value,
        versions=versions(),
    )
    if replay is not None:
        document = _replay(printer, question, states, replay, folder)
        printer.document(document)
        if document["same"] is False:
            raise typer.Exit(1)
        return
    real = _disturbance(
        fleet,
        seed,
        sample_time=sample_time,
        delay=delay,
        mismatch=mismatch,
        **dict(zip(("noise_position", "noise_heading"), noise or (), strict=False)),
        **dict(zip(("coulomb", "viscous"), friction or (), strict=False)),
        **({"lost_link": lost_link[:2], "lost_at": lost_link[2]} if lost_link else {}),
    )
    document = _validate(
        printer,
        question,
        states,
        folder,
        None if starts_file else seed,
        workers,
        scheduler,
        fleet,
        real,
        largest_sample_time,
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
    from .reports.html import write_report

    printer = Printer(json, quiet, verbose)
    document = {"report": str(write_report(folder, fleet))}
    if animate is not None:
        from .reports.movie import write_movie

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
    from .reports.exports import export as export_files

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
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Design, certify, prove, simulate and report: the whole job."""
    from .models.gains_file import GainsFile
    from .reports.html import write_report

    printer = Printer(json, quiet, verbose)
    fleet = _fleet(fleet_path)
    settled = _tolerance(tolerance)
    made = _design(printer, fleet, mode, conditions, excitation, weights, seed, time_limit, digits, settled)
    document = {"design": _write_design(printer, made, folder)}
    chosen = GainsFile(made.gains, made.excitation, conditions.value, made.links)
    document["certificate"] = _certify(printer, fleet, chosen, conditions.value, folder)
    claims = _prove(printer, fleet, folder, part_of_run=True)
    if fleet.start() is None:
        printer.say("simulation: left out, because the fleet file has no start for every vehicle")
    else:
        real = _disturbance(fleet, seed)
        document["summary"] = _simulate(printer, fleet, chosen, folder, tuple(Scheme), horizon, settled, real=real)
    path = write_report(folder)
    printer.say(f"report: {path}")
    printer.document({**document, "report": str(path)})
    broken = document.get("summary", {}).get("violations", [])
    if broken or not document["certificate"]["valid"] or not _theorem_holds(claims):
        raise typer.Exit(1)


# -- what several verbs do --------------------------------------------------------------------------------------------


def _fleet(path: Path) -> Fleet:
    from .models.fleet_file import load

    return load(path)


def _gains(path: Path, fleet: Fleet) -> GainsFile:
    from .models.gains_file import load_gains

    return load_gains(path, fleet)


def _tolerance(pair: tuple[float, float]) -> Tolerance:
    from .models.errors import InputError
    from .synthesis.rollout import Tolerance

    if not all(math.isfinite(value) and value > 0 for value in pair):
        raise InputError(f"--tolerance {pair[0]:g} {pair[1]:g}: both must be finite and > 0 (m, rad)")
    return Tolerance(*pair)


def _design(
    printer: Printer,
    fleet: Fleet,
    mode: Mode,
    conditions: Conditions,
    excitation: Source | None,
    weights: Source,
    seed: int,
    time_limit: float,
    digits: int,
    tolerance: Tolerance,
) -> Any:
    from .synthesis.design import design
    from .verify.dispatch import local

    with local() as (executor, _), printer.progress() as progress:
        return design(
            fleet,
            conditions=conditions.value,
            mode=mode.value,
            excitation=excitation.value if excitation else None,
            weights=weights.value,
            seed=seed,
            digits=digits,
            time_limit=time_limit,
            tolerance=tolerance,
            executor=executor,
            progress=progress,
        )


def _write_design(printer: Printer, made: Any, folder: Path) -> dict[str, Any]:
    from .models.files import write_json
    from .reports.deployment import write_fleet_copy
    from .reports.gain_table import for_terminal, rows, write_csv
    from .reports.versions import versions
    from .synthesis.design import as_json

    document = as_json(made, versions())
    table = rows(made.used_fleet, made.excitation, made.gains)
    write_json(folder / "design.json", document)
    write_csv(folder / "gains.csv", table)
    write_fleet_copy(made.fleet, folder)
    times = sorted(made.settling)
    worst = f"{times[-1]:.0f} s" if math.isfinite(times[-1]) else "not settled"
    printer.say(
        for_terminal(table),
        f"conditions {made.conditions.name} ({', '.join(made.conditions.sources)}), found by the {made.origin}",
        f"psi: {'designed' if made.excitation_designed else 'as given'}, |psi| <= {float(made.excitation.bound):.6g}, "
        f"{float(made.excitation.frequency):.4g} rad/s",
        f"settles within {made.tolerance.position:g} m and {made.tolerance.heading:g} rad from {len(times)} starts: "
        f"median {times[len(times) // 2]:.0f} s, worst {worst}",
    )
    if not made.excitation_designed:
        printer.say("psi was given; --excitation designed may settle faster")
    printer.detail(f"wrote {folder / 'design.json'} and {folder / 'gains.csv'}")
    return document


def _certify(printer: Printer, fleet: Fleet, chosen: GainsFile, conditions: str, folder: Path) -> dict[str, Any]:
    from .reports.deployment import write_fleet_copy
    from .verify.certificate import certify

    certificate = certify(fleet, chosen.excitation, chosen.gains, conditions, links=chosen.links)
    path = folder / "certificate.json"
    if certificate.valid:
        certificate.write(path)
        write_fleet_copy(fleet, folder)
        printer.say(f"certificate: {path}")
    else:
        printer.say(
            "not certified:", *(str(violation) for violation in certificate.violations or (certificate.verdict,))
        )
    printer.say(*(f"note: {note}" for note in certificate.notes))
    return {
        "valid": certificate.valid,
        "conditions": conditions,
        "certificate": str(path) if certificate.valid else None,
        "failures": [str(violation) for violation in certificate.violations],
        "notes": list(certificate.notes),
    }


def _prove(printer: Printer, fleet: Fleet | None, folder: Path | None, *, part_of_run: bool = False) -> Any:
    from .reports.proof_figures import write as write_witness_figures
    from .reports.proof_report import claims_to_json, write
    from .verify.proof import prove

    claims = prove(fleet)
    counts: dict[str, int] = {}
    for claim in claims:
        counts[claim.status.name] = counts.get(claim.status.name, 0) + 1
    printer.say(
        f"proof check: {len(claims)} claims, "
        + ", ".join(f"{number} {name}" for name, number in sorted(counts.items()))
        + ("; the corrected theorem is proved" if _theorem_holds(claims) else "; the corrected theorem is NOT proved")
    )
    for claim in claims:
        if printer.verbose or (claim.status.name in ("REFUTED", "CORRECTED", "OPEN") and not part_of_run):
            printer.say(f"  {claim.status.name:9} {claim.source}: {claim.reason}")
    if folder is not None:
        write(claims, folder)
        write_witness_figures(folder / "figures")
        printer.say(f"proof report: {folder / 'proof.html'}")
    if not part_of_run:
        printer.document(claims_to_json(claims))
    return claims


def _theorem_holds(claims: Any) -> bool:
    from .verify.proof import theorem_proved

    return theorem_proved(claims)


def _simulate(
    printer: Printer,
    fleet: Fleet,
    chosen: GainsFile,
    folder: Path,
    schemes: tuple[Scheme, ...],
    horizon: float | None,
    tolerance: Tolerance,
    engine: Engine = Engine.auto,
    real: Disturbance | None = None,
) -> dict[str, Any]:
    """Simulate the schemes and write all files; the first is summarised, with the disturbance where there is one."""
    from .models.equations import State
    from .models.errors import UndecidedError
    from .models.files import write_json
    from .reports.deployment import write_fleet_copy
    from .reports.figures import write_figures
    from .reports.versions import versions
    from .verify.disturbance import disturbed_run, disturbed_summary, in_words
    from .verify.simulate import integration_error, simulate, summarize

    runs: dict[str, Trajectory] = {}
    for scheme in schemes:
        end = horizon if not runs else float(runs[schemes[0].value].t[-1])
        try:
            with printer.progress() as progress:
                runs[scheme.value] = simulate(
                    fleet.with_links(chosen.links),
                    chosen.gains,
                    chosen.excitation,
                    bounded=scheme is Scheme.bounded,
                    horizon=end,
                    tolerance=tolerance,
                    engine=engine.value,
                    progress=progress,
                )
        except UndecidedError as error:
            if not runs:
                raise
            printer.say(f"{scheme.value} scheme for comparison: {error}")
    first = runs[schemes[0].value]
    stored: Recording = first
    summary = {**summarize(fleet, first, tolerance), **integration_error(first)}
    drawn: dict[str, Recording] = {f"{name} scheme": run for name, run in runs.items()}
    printer.say(f"simulation of the {schemes[0].value} scheme: {_run_in_words(summary)}")
    if real is not None:
        start = State(*(column[0] for column in first.state))
        outcome, stored = disturbed_run(fleet, first.loop, start, real, float(first.t[-1]), tolerance)
        summary = disturbed_summary(outcome, stored, tolerance, real, summary)
        drawn = {"with the disturbance": stored, **drawn}
        printer.say(f"with the disturbance ({in_words(real)}): {_run_in_words(summary)}")
    record = {**summary, "scheme": schemes[0].value, "fleet_digest": fleet.digest, "versions": versions()}
    stored.write(folder / "trajectory.npz")
    write_json(folder / "summary.json", record)
    write_fleet_copy(fleet, folder)
    write_figures(fleet, drawn, folder / "figures")
    printer.say(*(f"FALSE: {violation}" for violation in summary["violations"]), f"figures: {folder / 'figures'}")
    return record


def _run_in_words(summary: dict[str, Any]) -> str:
    settled, error = summary["settling_time_s"], summary.get("integration_error_m")
    return (
        (f"settles after {settled:.1f} s" if settled is not None else f"not settled by {summary['horizon_s']:g} s")
        + f", peak torque {100 * summary['peak_torque_ratio']:.1f} % of the limit, "
        f"final error {summary['final_position_error_m']:.3g} m, {summary['final_heading_error_rad']:.3g} rad"
        + ("" if error is None else f", integration error {error:.1g} m")
    )


def _starts(fleet: Fleet, count: int, file: Path | None, seed: int, box: float | None) -> tuple[Any, dict[str, Any]]:
    """The starts to validate from, and where they come from."""
    from .models.starts import load_starts, random_starts, scale
    from .verify.validate import origin_of_states

    if file is not None:
        states = load_starts(file, fleet)
        return states, {"file": file.name, **origin_of_states(states)}
    half = scale(fleet) if box is None else box / 2
    return random_starts(fleet, count, seed, half), {"random": {"seed": seed, "box_m": 2 * half}}


def _validate(
    printer: Printer,
    question: Question,
    states: Any,
    folder: Path,
    seed: int | None,
    workers: int | None,
    scheduler: str | None,
    fleet: Fleet,
    real: Disturbance | None,
    largest: bool,
) -> dict[str, Any]:
    from .models.files import write_json
    from .reports.versions import versions
    from .verify.dispatch import cluster, local
    from .verify.robustness import robustness
    from .verify.robustness import sentences as robust_sentences
    from .verify.validate import validate
    from .verify.validation import sentences, summarize

    with cluster(scheduler) if scheduler else local(workers) as (executor, count), printer.progress() as progress:
        results = validate(question, states, folder, executor, count, progress)
    document = summarize(question, results, seed)
    if real is not None or largest:
        with printer.progress() as progress:
            document |= robustness(fleet, question, states, results, real, largest, progress)
    document["versions"] = versions()
    write_json(folder / "validation.json", document)
    printer.say(*sentences(document), *robust_sentences(document))
    return document


def _disturbance(fleet: Fleet, seed: int, **options: Any) -> Disturbance | None:
    """What the fleet's [disturbance] table asks for, or the options where they are given; None without either."""
    from dataclasses import replace

    from .verify.disturbance import checked, of_table

    given = {name: value for name, value in options.items() if value is not None}
    if not given and fleet.disturbance is None:
        return None
    return checked(replace(of_table(fleet.disturbance, seed), **given), fleet)


def _replay(printer: Printer, question: Question, states: Any, number: int, folder: Path) -> dict[str, Any]:
    """One start again, in this process; compared with the stored result where there is one."""
    from .models.errors import InputError
    from .verify.validate import replay

    if number >= len(states):
        raise InputError(f"--replay {number}: the file has the starts 0 to {len(states) - 1}")
    result, stored, run = replay(question, number, states[number], folder)
    path = folder / f"replay-{number}.npz"
    run.write(path)
    same = None if stored is None else stored == result
    verdict = {None: "no stored result to compare with", True: "identical to the stored one", False: "DIFFERS from it"}
    settled = result["settling_time_s"]
    printer.say(
        f"start {number}: {result['failure'] or f'settles after {settled:.6g} s'}; {verdict[same]}",
        f"trajectory: {path}",
    )
    return {**result, "same": same, "trajectory": str(path)}


def main() -> None:
    """The entry point: an expected failure is one message and an exit code, never a traceback."""
    try:
        app()
    except GaincertError as error:
        sys.stderr.write(f"error: {error}\n".replace("\n", "\nerror: ").removesuffix("error: "))
        raise SystemExit(error.exit_code) from None
    except KeyboardInterrupt:
        sys.stderr.write("interrupted; every file that was finished is whole\n")
        raise SystemExit(130) from None


if __name__ == "__main__":
    main()
