"""The inputs of a verb: files and options as typed values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from concurrent.futures import Executor
    from contextlib import AbstractContextManager

    from ..models.digests import Digests
    from ..models.equations import State
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..models.tolerance import Tolerance
    from ..verify.simulation.disturbance import Disturbance

LARGEST_TOLERANCE = 1e6  # m, rad; it is squared


def read_fleet(path: Path) -> Fleet:
    """The fleet of a file."""
    from ..models.files.fleet_file import load_fleet

    return load_fleet(path)


def read_gains(path: Path, fleet: Fleet) -> GainsFile:
    """The gains of a file, for a fleet."""
    from ..models.files.gains_file import load_gains

    return load_gains(path, fleet)


def conditions_of(requested: str | None, gains: GainsFile) -> str:
    """The condition set to certify gains under: the requested one, else the one that the gains were designed for."""
    return str(requested or gains.conditions or "paper")


def check_folder(folder: Path) -> None:
    """Refuse a folder that cannot be written before the work begins. Raises InputError or FaultError."""
    from ..models.files.text import check_writable

    check_writable(folder)


def digests_of(fleet: Fleet, gains: GainsFile) -> Digests:
    """The digests of the fleet and gains that are simulated, validated or certified."""
    from ..models.digests import Digests

    return Digests.of(fleet, fleet.with_links(gains.links), gains.excitation, gains.gains)


def tolerance_of(pair: tuple[float, float]) -> Tolerance:
    """The tolerance (m, rad) of the option. Raises InputError."""
    from ..models.errors import InputError
    from ..models.tolerance import Tolerance

    if not all(0 < value <= LARGEST_TOLERANCE for value in pair):
        raise InputError(f"--tolerance {pair[0]:g} {pair[1]:g}: both must be finite and > 0 (m, rad), at most 1e6")
    return Tolerance(*pair)


@dataclass(frozen=True)
class Pool:
    """Where the work runs."""

    workers: int | None = None  # processes; None: one for every core
    scheduler: str | None = None  # the address of a Dask cluster, which runs it instead

    def open(self) -> AbstractContextManager[tuple[Executor, int]]:
        """The executor and the number of its workers. Raises InputError where the cluster does not answer."""
        from ..parallel import cluster, local

        return local(self.workers) if self.scheduler is None else cluster(self.scheduler)


ALL_CORES = Pool()


@dataclass(frozen=True)
class StartOptions:
    """Which starts `validate` runs."""

    count: int
    file: Path | None
    seed: int
    box: float | None  # m


@dataclass(frozen=True)
class Starts:
    """Initial states, and where they come from."""

    states: Sequence[State]
    origin: dict[str, Any]  # for validation.json

    @classmethod
    def of(cls, fleet: Fleet, options: StartOptions) -> Starts:
        """The starts of a file, or random ones."""
        from ..models.files.starts_file import load_starts
        from ..models.starts import random_starts, scale
        from ..verify.validation.validate import origin_of_states

        if options.file is not None:
            states = load_starts(options.file, fleet)
            return cls(states, {"file": options.file.name, **origin_of_states(states)})
        half = scale(fleet) if options.box is None else options.box / 2
        states = random_starts(fleet, options.count, options.seed, half)
        return cls(states, {"random": {"seed": options.seed, "box_m": 2 * half}})


@dataclass(frozen=True)
class DisturbanceOptions:
    """The disturbance options of the command line; None if not given."""

    sample_time: float | None = None  # s
    delay: float | None = None  # s
    noise: tuple[float, float] | None = None  # m, rad
    noise_speed: float | None = None  # m/s and rad/s
    mismatch: float | None = None
    friction: tuple[float, float] | None = None  # N m, N m s
    lost_link: tuple[str, str, float] | None = None  # vehicle, vehicle, s
    com_offset: bool = False

    def of(self, fleet: Fleet, seed: int) -> Disturbance | None:
        """The fleet's [disturbance], its entries replaced by these options; None without either. Raises InputError."""
        from dataclasses import replace

        from ..verify.simulation.disturbance import checked, of_table

        given = self._given()
        if not given and fleet.disturbance is None:
            return None
        return checked(replace(of_table(fleet.disturbance, seed), **given), fleet)

    def _given(self) -> dict[str, Any]:
        names = ("sample_time", "delay", "noise_speed", "mismatch")
        single = {name: getattr(self, name) for name in names}
        given: dict[str, Any] = {name: value for name, value in single.items() if value is not None}
        if self.noise:
            given |= {"noise_position": self.noise[0], "noise_heading": self.noise[1]}
        if self.friction:
            given |= {"coulomb": self.friction[0], "viscous": self.friction[1]}
        if self.lost_link:
            given |= {"lost_link": self.lost_link[:2], "lost_at": self.lost_link[2]}
        if self.com_offset:
            given["com_offset"] = True
        return given
