"""`gaincert design`: choose gains, write them, and print what they achieve."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .certify import certify_gains
from .inputs import ALL_CORES, Pool, check_folder
from .obstacles import confirmed, obstacles_of, say_slips

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..models.tolerance import Tolerance
    from ..reports.obstacles import Obstacle
    from ..synthesis.design import Design
    from ..verify.certificates.certify import Certificate


@dataclass(frozen=True)
class DesignOptions:
    """The options of `design`, as `synthesis.design.design` takes them."""

    mode: str
    conditions: str
    excitation: str | None
    saturation: str | None
    weights: str
    seed: int
    digits: int
    time_limit: float  # s
    tolerance: Tolerance
    torque_factor: float
    box: float | None  # m


@dataclass(frozen=True)
class Designed:
    """The results of `design`."""

    design: Design
    document: dict[str, Any]  # the content of design.json
    certificate: Certificate
    obstacles: list[Obstacle]  # reasons why the robots cannot use the gains


def design_gains(printer: Printer, fleet: Fleet, options: DesignOptions, pool: Pool = ALL_CORES) -> Design:
    """A design; its rollouts run in the pool."""
    from ..synthesis.design import design

    with pool.open() as (executor, _), printer.progress() as progress:
        return design(fleet, **vars(options), executor=executor, progress=progress)


def write_design(printer: Printer, design: Design, folder: Path) -> dict[str, Any]:
    """Write design.json, gains.csv with its psi, and the copy of the fleet; returns the content of design.json."""
    from ..models.digests import Digests
    from ..models.files.psi_file import write_psi
    from ..models.files.text import write_json
    from ..reports.deployment import write_fleet_copy
    from ..reports.tables.gain_table import for_terminal, rows, write_csv
    from ..reports.versions import versions
    from ..synthesis.design_file import DesignFile

    document = DesignFile.of(design, versions()).content()
    table = rows(design.used_fleet, design.excitation, design.gains)
    write_json(folder / "design.json", document)
    write_psi(write_csv(folder / "gains.csv", table), design.excitation, design.links, Digests.of_json(document))
    write_fleet_copy(design.fleet, folder)
    printer.say(for_terminal(table), *sentences(design))
    printer.detail(f"wrote {folder / 'design.json'} and {folder / 'gains.csv'}")
    return dict(document)


def design_fleet(
    printer: Printer, fleet: Fleet, options: DesignOptions, folder: Path, pool: Pool = ALL_CORES
) -> Designed:
    """Design, write design.json, gains.csv and certificate.json, and list older files that belong to other gains."""
    from ..models.digests import Digests
    from ..reports.results import say_stale, stale_files

    check_folder(folder)
    say_slips(printer, fleet)
    design = design_gains(printer, fleet, options, pool)
    document = write_design(printer, design, folder)
    gains = gains_of(design)
    certificate = certify_gains(printer, fleet, gains, design.conditions.name, folder)
    if stale := stale_files(folder, Digests.of_json(document)):
        printer.say(f"note: {say_stale(stale)}")
    obstacles = obstacles_of(printer, fleet, gains, design.tolerance)
    if all(map(math.isfinite, design.settling_held)):
        obstacles = confirmed(printer, obstacles, f"all of {len(design.settling_held)} starts with friction")
    obstacles += _control_rate(design)
    return Designed(design, document, certificate, obstacles)


def _control_rate(design: Design) -> list[Obstacle]:
    """The sample time of the fleet against the largest with which the design settles."""
    from ..reports.obstacles import of_control_rate

    table = design.fleet.disturbance
    sample_time = float(table.sample_time) if table and table.sample_time else None
    return of_control_rate(sample_time, design.largest_sample_time)


def gains_of(design: Design) -> GainsFile:
    """The gains of a design, as if they had been read from its file."""
    from ..models.files.gains_file import GainsFile

    return GainsFile(design.gains, design.excitation, design.conditions.name, design.links)


def sentences(design: Design) -> list[str]:
    """A design in a few sentences."""
    psi = design.excitation
    lines = [
        f"conditions {design.conditions.name} ({', '.join(design.conditions.sources)}), found by the {design.origin}",
        f"scales: {scales_of(design)}",
        f"psi: {'designed' if design.excitation_designed else 'as given'}, |psi| <= {float(psi.bound):.6g}, "
        f"{float(psi.frequency):.4g} rad/s",
        f"settles within {design.tolerance.position:g} m and {design.tolerance.heading:g} rad "
        f"from {len(design.settling)} starts: {spread(design.settling)}",
        held(design),
    ]
    if all(map(math.isinf, design.settling)):
        lines.append("no start settled in the time that was simulated: gaincert validate --horizon S looks further")
    return lines if design.excitation_designed else [*lines, "psi was given; --excitation designed may settle faster"]


def scales_of(design: Design) -> str:
    """The saturation scales; those of v and omega as the smallest and the largest."""
    scale, count = design.gains.saturation, len(design.fleet)
    if scale.unit:
        return "1 m, 1 rad, 1 m/s, 1 rad/s (the paper's)"
    columns = scale.columns(count)
    ranges = [f"{float(min(columns[name])):.3g} to {float(max(columns[name])):.3g}" for name in ("speed", "turn_rate")]
    return f"{float(scale.position):.3g} m, {float(scale.heading):.3g} rad, {ranges[0]} m/s, {ranges[1]} rad/s"


def held(design: Design) -> str:
    """What remains of a design on a robot whose torques are held between samples."""
    largest = design.largest_sample_time
    return (
        f"as a robot with a sample time of {design.sample_time:g} s and its disturbances: "
        f"{spread(design.settling_held)}; all of these starts settle "
        + (f"with sample times up to {largest:.3g} s" if largest else "with none of the sample times tried")
    )


def spread(settling: Sequence[float]) -> str:
    """The median and the worst of settling times, s; inf is said in words."""
    times = sorted(settling)
    median, worst = (
        f"{time:.0f} s" if math.isfinite(time) else "not settled" for time in (times[len(times) // 2], times[-1])
    )
    return f"median {median}, worst {worst}"
