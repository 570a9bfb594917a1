"""`gaincert validate`: the fleet from many starts, nominal and disturbed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .inputs import ALL_CORES, Pool, check_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..console import Printer
    from ..models.digests import Digests
    from ..models.equations import State
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..models.tolerance import Tolerance
    from ..verify.simulation.disturbance import Disturbance
    from ..verify.validation.start_result import StartResult
    from ..verify.validation.validate import ValidationSpec
    from .inputs import Starts


@dataclass(frozen=True)
class Validation:
    """The options of `validate`."""

    spec: ValidationSpec
    digests: Digests
    states: Sequence[State]
    seed: int | None  # of random starts, None for those of a file
    disturbance: Disturbance | None = None
    margins: bool = False  # whether to search for them
    pool: Pool = ALL_CORES


HORIZON_FACTOR = 6.0  # of the predicted tail, as in `design`: transients and chaos take their time, too
HORIZONS = (300.0, 20_000.0)  # s, shortest and longest


def default_horizon(fleet: Fleet, gains: GainsFile, tolerance: Tolerance) -> float:
    """The time to simulate so that a start can settle, s, from the tail that the averaged flow predicts.

    Rounded up to two digits, so that it is the same on every processor.
    """
    from ..models.arrays import floats
    from ..models.errors import UndecidedError
    from ..synthesis.rates import rates

    plant = fleet.with_links(gains.links).plant()
    shortest, longest = HORIZONS
    try:
        tail = rates(plant, gains.gains.map(floats), gains.excitation, tolerance.position, tolerance.heading).tail_time
    except UndecidedError:
        return longest
    time = min(max(HORIZON_FACTOR * tail, shortest), longest)
    unit = 10 ** (math.floor(math.log10(time)) - 1)
    return float(unit * math.ceil(time / unit))


def spec_of(
    fleet: Fleet, gains: GainsFile, starts: Starts, horizon: float, tolerance: Tolerance, engine: str = "auto"
) -> ValidationSpec:
    """All that a result depends on, except the start."""
    from ..reports.versions import versions
    from ..verify.simulation.closed_loop import ClosedLoop
    from ..verify.validation.validate import make_spec

    used = fleet.with_links(gains.links)
    loop = ClosedLoop.of(used, gains.gains, gains.excitation)
    return make_spec(
        used, loop, starts.origin, horizon=horizon, tolerance=tolerance, engine=engine, versions=versions()
    )


def validate_starts(printer: Printer, fleet: Fleet, validation: Validation, folder: Path) -> dict[str, Any]:
    """Run all starts and write validation.json; returns its content."""
    from ..models.files.text import write_json
    from ..reports.versions import versions
    from ..verify.validation.robustness import robustness
    from ..verify.validation.statistics import ValidationResults
    from ..verify.validation.validate import validate

    check_folder(folder)
    spec, states = validation.spec, validation.states
    with validation.pool.open() as (executor, count), printer.progress() as progress:
        results = validate(spec, states, folder, executor, count, progress)
    with printer.progress() as progress:
        disturbed = robustness(
            fleet,
            spec,
            states,
            results,
            disturbance=validation.disturbance,
            search=validation.margins,
            progress=progress,
        )
    whole = ValidationResults(spec, results, validation.seed, disturbed)
    document = {**whole.to_json(), **validation.digests.to_json(), "versions": versions()}
    write_json(folder / "validation.json", document)
    printer.say(*whole.sentences(), *_hint(results))
    return document


def _hint(results: Sequence[StartResult]) -> list[str]:
    """The remedy if the horizon was too short."""
    from ..verify.simulation.settling import Approach

    closing = sum(str(Approach.CLOSING_IN) in (result.failure or "") for result in results)
    return [f"{closing} of these are still closing in: give a longer --horizon to see them settle"] if closing else []


def validation_exit_code(document: dict[str, Any]) -> int:
    """1 if a promise or a torque limit is broken, 4 if the integrator gave up on a start, else 0."""
    if document["violations"] or any(entry["peak_torque_ratio"] > 1 for entry in document.get("disturbed", [])):
        return 1
    return 4 if any(failure.get("gave_up") for failure in document["failures"]) else 0


def replay_start(printer: Printer, validation: Validation, number: int, folder: Path) -> dict[str, Any]:
    """Run one start again, in this process; compare it with the stored result, if there is one."""
    from ..models.errors import InputError
    from ..verify.validation.validate import replay

    if number >= len(validation.states):
        raise InputError(f"--replay {number}: the file has the starts 0 to {len(validation.states) - 1}")
    result, stored, run = replay(validation.spec, number, validation.states[number], folder)
    path = folder / f"replay-{number}.npz"
    run.write(path)
    same = None if stored is None else stored == result
    verdict = {None: "no stored result to compare with", True: "identical to the stored one", False: "DIFFERS from it"}
    settled = result.failure or f"settles after {result.settling_time:.6g} s"
    printer.say(f"start {number}: {settled}; {verdict[same]}", f"trajectory: {path}")
    return {**result.to_json(), "same": same, "trajectory": str(path)}
