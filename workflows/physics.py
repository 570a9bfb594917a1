"""`gaincert validate --plant mujoco`: many starts in a physics engine, driven by the exported C controller."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .inputs import check_folder, digests_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..console import Printer
    from ..models.equations import State
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..models.tolerance import Tolerance
    from ..verify.simulation.disturbance import Disturbance


@dataclass(frozen=True)
class PhysicsRun:
    """What `validate --plant mujoco` is to do."""

    states: Sequence[State]
    horizon: float  # s
    tolerance: Tolerance
    disturbance: Disturbance | None  # None: sampling alone
    workers: int | None = None  # None: one for every core


def validate_in_physics(
    printer: Printer, fleet: Fleet, gains: GainsFile, run: PhysicsRun, folder: Path
) -> dict[str, Any]:
    """Run all starts and write validation.json; its content. Raises InputError where something is missing."""
    from ..models.arrays import floats
    from ..models.files.text import write_json
    from ..parallel import in_turn, local
    from ..reports.deployment import Deployment, write_fleet_copy
    from ..reports.export.c_library import build_library
    from ..reports.figures.physics import write_physics
    from ..reports.versions import versions
    from ..verify.physics.validation import PhysicsTask, PhysicsValidation, run_physics
    from ..verify.physics.world import World
    from ..verify.simulation.closed_loop import ClosedLoop
    from ..verify.simulation.disturbance import Disturbance

    check_folder(folder)
    used = fleet.with_links(gains.links)
    disturbance = run.disturbance or Disturbance()
    World(used, disturbance)  # what cannot be built is said before anything runs
    deployed = Deployment(used, gains.excitation, gains.gains, fleet.digest, None, None)
    loop = ClosedLoop.of(used, gains.gains, gains.excitation)
    with tempfile.TemporaryDirectory() as build:
        library = build_library(deployed, Path(build))
        bounds = floats(deployed.torque_bounds)
        task = PhysicsTask(used, loop, bounds, library, disturbance, run.horizon, run.tolerance)
        jobs = ((task, k, start) for k, start in enumerate(run.states))
        done = []
        with local(run.workers) as (executor, count), printer.progress() as progress:
            for result in in_turn(executor, run_physics, jobs, count):
                done.append(result)
                progress(f"{len(done)} starts in MuJoCo", len(done) / len(run.states))
    results = PhysicsValidation(task, sorted(done, key=lambda result: result.start))
    digests = digests_of(fleet, gains)
    document = {**results.to_json(), **digests.to_json(), "versions": {**versions(), **_mujoco()}}
    write_json(folder / "validation.json", document)
    write_fleet_copy(fleet, folder)
    write_physics(used, results, folder / "figures", str(digests))
    printer.say(*results.sentences())
    return document


def refuse_with_mujoco(*options: tuple[str, bool]) -> None:
    """Raise InputError where one of these options (name, whether it is given) is of the model alone."""
    from ..models.errors import InputError

    if given := [name for name, is_given in options if is_given]:
        raise InputError(f"{', '.join(given)}: not with --plant mujoco; leave it out, or use --plant model")


def _mujoco() -> dict[str, str]:
    from importlib.metadata import version

    return {"mujoco": version("mujoco")}
