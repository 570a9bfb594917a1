"""What the verbs of the command line do: each job computes, writes its files whole, and says what happened.

Everything heavy is imported by the job that needs it.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .console import Printer
    from .models.files.gains_file import GainsFile
    from .models.fleet import Fleet
    from .models.tolerance import Tolerance
    from .synthesis.design import Design
    from .verify.simulation.disturbance import Disturbance
    from .verify.simulation.recording import Recording
    from .verify.simulation.simulate import Trajectory
    from .verify.validation.validate import Question


def read_fleet(path: Path) -> Fleet:
    """The fleet of a file."""
    from .models.files.fleet_file import load_fleet

    return load_fleet(path)


def read_gains(path: Path, fleet: Fleet) -> GainsFile:
    """The gains of a file, for a fleet."""
    from .models.files.gains_file import load_gains

    return load_gains(path, fleet)


LARGEST_TOLERANCE = 1e6  # m, rad; it is squared


def tolerance_of(pair: tuple[float, float]) -> Tolerance:
    """The tolerance (m, rad) of two options. Raises InputError."""
    from .models.errors import InputError
    from .models.tolerance import Tolerance

    if not all(0 < value <= LARGEST_TOLERANCE for value in pair):
        raise InputError(f"--tolerance {pair[0]:g} {pair[1]:g}: both must be finite and > 0 (m, rad), at most 1e6")
    return Tolerance(*pair)


def design_gains(printer: Printer, fleet: Fleet, **options: Any) -> Design:
    """Design with the options of `design`, on all cores."""
    from .parallel import local
    from .synthesis.design import design

    with local() as (executor, _), printer.progress() as progress:
        return design(fleet, **options, executor=executor, progress=progress)


def write_design(printer: Printer, made: Design, folder: Path) -> dict[str, Any]:
    """design.json, gains.csv and the copy of the fleet."""
    from .models.files.text import write_json
    from .reports.export.deployment import write_fleet_copy
    from .reports.tables.gain_table import for_terminal, rows, write_csv
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


COMPARED_STARTS = 20
COMPARED_HORIZON = 3000.0  # s


def compare_designs(
    printer: Printer, fleet: Fleet, made: Design, folder: Path, variants: bool, against: Path | None, **options: Any
) -> list[dict[str, Any]]:
    """Measure a design, its variants and the gains of a file from the same starts; each leaves its files in DIR/NAME.

    The variants are designs in mode "fast" under every other condition set, given and designed psi and weights.
    """
    from .models.files.gains_file import GainsFile
    from .reports.tables.designs_table import design_rows, for_terminal

    def measure(chosen: GainsFile, place: Path) -> None:
        states, origin = starts_of(fleet, COMPARED_STARTS, None, made.seed, options["box"])
        question = question_of(fleet, chosen, origin, COMPARED_HORIZON, made.tolerance)
        validate_starts(printer.silent(), fleet, question, states, place, seed=made.seed)

    measure(GainsFile(made.gains, made.excitation, made.conditions.name, made.links), folder)
    if against is not None:
        measure(read_gains(against, fleet), folder / against.stem)
    for choice in _variants(fleet, made) if variants else ():
        place = folder / "_".join(
            (choice["conditions"], *(f"{choice[key]}-{key}" for key in ("excitation", "weights")))
        )
        printer.say(f"designing {place.name} for comparison")
        other = design_gains(printer, fleet, **{**options, **choice, "mode": "fast"})
        write_design(printer.silent(), other, place)
        measure(GainsFile(other.gains, other.excitation, other.conditions.name, other.links), place)
    rows = design_rows(folder)
    printer.say(f"from the same {COMPARED_STARTS} starts, up to {COMPARED_HORIZON:g} s:", for_terminal(rows))
    return [{key: value for key, value in row.items() if key != "times"} for row in rows]


def _variants(fleet: Fleet, made: Design) -> list[dict[str, str]]:
    """The choices that `made` did not take."""
    from itertools import product

    from .models.conditions import CONDITION_SETS

    keys = ("conditions", "excitation", "weights")
    sources = ("given", "designed")
    taken = (made.conditions.name, sources[made.excitation_designed], sources[made.links is not None])
    all_of_them = product(CONDITION_SETS, sources if fleet.psi else ("designed",), sources)
    return [dict(zip(keys, choice, strict=True)) for choice in all_of_them if choice != taken]


def certify_gains(printer: Printer, fleet: Fleet, chosen: GainsFile, conditions: str, folder: Path) -> dict[str, Any]:
    """certificate.json, where the gains can be certified."""
    from .reports.export.deployment import write_fleet_copy
    from .verify.certificates.certify import certify

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


def prove_claims(printer: Printer, fleet: Fleet | None, folder: Path | None, *, part_of_run: bool = False) -> Any:
    """Check all claims; write the proof report into the folder if there is one."""
    from .reports.figures.witnesses import write as write_witness_figures
    from .reports.proof.report import claims_to_json, write
    from .verify.proof import prove

    claims = prove(fleet)
    counts: dict[str, int] = {}
    for claim in claims:
        counts[claim.status.name] = counts.get(claim.status.name, 0) + 1
    printer.say(
        f"proof check: {len(claims)} claims, "
        + ", ".join(f"{number} {name}" for name, number in sorted(counts.items()))
        + ("; the corrected theorem is proved" if theorem_holds(claims) else "; the corrected theorem is NOT proved")
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


def theorem_holds(claims: Any) -> bool:
    """Whether the corrected theorem is proved."""
    from .verify.proof import theorem_proved

    return theorem_proved(claims)


def simulate_schemes(
    printer: Printer,
    fleet: Fleet,
    chosen: GainsFile,
    folder: Path,
    schemes: tuple[str, ...],
    horizon: float | None,
    tolerance: Tolerance,
    engine: str = "auto",
    real: Disturbance | None = None,
) -> dict[str, Any]:
    """Simulate the schemes and write all files; the first is summarised, with the disturbance where there is one."""
    from .models.equations import State
    from .models.errors import UndecidedError
    from .models.files.text import write_json
    from .reports.export.deployment import write_fleet_copy
    from .reports.figures.figures import write_figures
    from .reports.versions import versions
    from .verify.simulation.disturbance import disturbed_run, disturbed_summary, in_words
    from .verify.simulation.simulate import integration_error, simulate, summarize

    runs: dict[str, Trajectory] = {}
    for scheme in schemes:
        end = horizon if not runs else float(runs[schemes[0]].t[-1])
        try:
            with printer.progress() as progress:
                runs[scheme] = simulate(
                    fleet.with_links(chosen.links),
                    chosen.gains,
                    chosen.excitation,
                    bounded=scheme == "bounded",
                    horizon=end,
                    tolerance=tolerance,
                    engine=engine,
                    progress=progress,
                )
        except UndecidedError as error:
            if not runs:
                raise
            printer.say(f"{scheme} scheme for comparison: {error}")
    first = runs[schemes[0]]
    stored: Recording = first
    summary = {**summarize(fleet, first, tolerance), **integration_error(first)}
    drawn: dict[str, Recording] = {f"{name} scheme": run for name, run in runs.items()}
    printer.say(f"simulation of the {schemes[0]} scheme: {_run_in_words(summary)}")
    if real is not None:
        start = State(*(column[0] for column in first.state))
        outcome, stored = disturbed_run(fleet, first.loop, start, real, float(first.t[-1]), tolerance)
        summary = disturbed_summary(outcome, stored, tolerance, real, summary)
        drawn = {"with the disturbance": stored, **drawn}
        printer.say(f"with the disturbance ({in_words(summary['disturbance'])}): {_run_in_words(summary)}")
    record = {**summary, "scheme": schemes[0], "fleet_digest": fleet.digest, "versions": versions()}
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


def starts_of(fleet: Fleet, count: int, file: Path | None, seed: int, box: float | None) -> tuple[Any, dict[str, Any]]:
    """The starts to validate from, and where they come from."""
    from .models.files.starts_file import load_starts
    from .models.starts import random_starts, scale
    from .verify.validation.validate import origin_of_states

    if file is not None:
        states = load_starts(file, fleet)
        return states, {"file": file.name, **origin_of_states(states)}
    half = scale(fleet) if box is None else box / 2
    return random_starts(fleet, count, seed, half), {"random": {"seed": seed, "box_m": 2 * half}}


def question_of(
    fleet: Fleet, chosen: GainsFile, origin: dict[str, Any], horizon: float, tolerance: Tolerance, method: str = "auto"
) -> Question:
    """What is asked of many starts."""
    from .reports.versions import versions
    from .verify.validation.validate import ask

    return ask(
        fleet.with_links(chosen.links),
        chosen.gains,
        chosen.excitation,
        origin,
        horizon=horizon,
        tolerance=tolerance,
        method=method,
        versions=versions(),
    )


def validate_starts(
    printer: Printer,
    fleet: Fleet,
    question: Question,
    states: Any,
    folder: Path,
    *,
    seed: int | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    real: Disturbance | None = None,
    largest: bool = False,
) -> dict[str, Any]:
    """Run all starts and write validation.json."""
    from .models.files.text import write_json
    from .parallel import cluster, local
    from .reports.versions import versions
    from .verify.validation.robustness import robustness
    from .verify.validation.robustness import sentences as robust_sentences
    from .verify.validation.statistics import sentences, summarize
    from .verify.validation.validate import validate

    with (
        local(workers) if scheduler is None else cluster(scheduler) as (executor, count),
        printer.progress() as progress,
    ):
        results = validate(question, states, folder, executor, count, progress)
    document = summarize(question, results, seed)
    if real is not None or largest:
        with printer.progress() as progress:
            document |= robustness(fleet, question, states, results, real, largest, progress)
    document["versions"] = versions()
    write_json(folder / "validation.json", document)
    printer.say(*sentences(document), *robust_sentences(document))
    return document


def disturbance_of(fleet: Fleet, seed: int, **options: Any) -> Disturbance | None:
    """What the fleet's [disturbance] table asks for, or the options where they are given; None without either."""
    from dataclasses import replace

    from .verify.simulation.disturbance import checked, of_table

    given = {name: value for name, value in options.items() if value is not None}
    if not given and fleet.disturbance is None:
        return None
    return checked(replace(of_table(fleet.disturbance, seed), **given), fleet)


def replay_start(printer: Printer, question: Question, states: Any, number: int, folder: Path) -> dict[str, Any]:
    """One start again, in this process; compared with the stored result where there is one."""
    from .models.errors import InputError
    from .verify.validation.validate import replay

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
