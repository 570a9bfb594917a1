"""Initial states from a CSV file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..equations import State
from ..errors import InputError, did_you_mean
from ..fleet import Fleet
from ..numbers import exact
from .fleet_file import read_csv

COLUMNS = ["start", "vehicle", "x", "y", "theta", "v", "omega"]


def load_starts(path: Path, fleet: Fleet) -> list[State]:
    """The starts of a CSV file with the columns start,vehicle,x,y,theta,v,omega (m, rad, m/s, rad/s).

    Raises InputError if a row is malformed or a start does not name every vehicle once.
    """
    index = {name: i for i, name in enumerate(fleet.names)}
    found: dict[str, dict[int, list[float]]] = {}
    for number, row in enumerate(read_csv(path, COLUMNS), 2):
        vehicle = index.get(row["vehicle"])
        if vehicle is None or vehicle in found.setdefault(row["start"], {}):
            unknown = f"the fleet has no such vehicle{did_you_mean(row['vehicle'], fleet.names)}"
            why = unknown if vehicle is None else "it is listed twice"
            raise InputError(f"{path}: row {number}: start {row['start']!r}, vehicle {row['vehicle']!r}: {why}")
        try:
            found[row["start"]][vehicle] = [float(exact(row[key])) for key in COLUMNS[2:]]
        except ValueError as error:
            raise InputError(f"{path}: row {number}: a number {error}") from None
    for name, states in found.items():
        if len(states) < len(fleet):
            missing = fleet.names[min(set(range(len(fleet))) - set(states))]
            raise InputError(f"{path}: start {name!r} has no row for vehicle {missing!r}")
    if not found:
        raise InputError(f"{path}: holds no start")
    return [State(*np.array([states[i] for i in range(len(fleet))]).T) for states in found.values()]
