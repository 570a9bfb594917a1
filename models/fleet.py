"""The fleet: vehicles, leader, links and excitation, validated, with exact numbers."""

from __future__ import annotations

import hashlib
import json
import math
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from .arrays import Array, column, floats
from .conditions import ConditionData
from .equations import Plant, State
from .excitation import Excitation
from .fleet_content import fleet_content
from .fleet_tables import DisturbanceTable, ExcitationTable, Leader, Links, Name, SaturationTable, Table, Vehicle
from .graph import Graph
from .graph_checks import graph_mistakes
from .html_table import html_table
from .numbers import high, low, nominal


class Fleet(Table):
    """A fleet, as its file describes it. `files.fleet_file.load_fleet` reads one."""

    name: Name
    drive: Literal["physical", "paper"] = "physical"
    leader: Leader
    excitation: ExcitationTable | None = None
    saturation: SaturationTable | None = None  # None: the tool designs the scales
    disturbance: DisturbanceTable | None = None  # for simulation only
    links: Links = Field(alias="graph")
    vehicles: tuple[Vehicle, ...] = Field(alias="vehicle")

    @model_validator(mode="after")
    def _consistent(self) -> Fleet:
        names = [vehicle.name for vehicle in self.vehicles]
        if mistakes := graph_mistakes(names, self.links.edges, self.links.leader_links):
            raise PydanticCustomError("graph", "{mistakes}", {"mistakes": "\n".join(mistakes)})
        return self

    def with_links(self, links: Links | None) -> Fleet:
        """The same fleet with other links; itself for None."""
        if links is None:
            return self
        return Fleet(links=links, **{name: getattr(self, name) for name in type(self).model_fields if name != "links"})

    def __len__(self) -> int:
        return len(self.vehicles)

    def __repr__(self) -> str:
        led = sum(1 for weight in self.links.leader_links.values() if weight)
        return f"Fleet({self.name!r}: {len(self)} vehicles, {len(self.links.edges)} links, {led} to the leader)"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        headings = ("vehicle", "mass / kg", "inertia / kg m^2", "R / m", "r / m", "torque limit / N m", "offset / m")
        rows = [
            [
                vehicle.name,
                *map(nominal, (vehicle.mass, vehicle.inertia, vehicle.half_track, vehicle.wheel_radius)),
                min(low(vehicle.torque_limit.left), low(vehicle.torque_limit.right)),
                ", ".join(f"{float(value):g}" for value in vehicle.offset),
            ]
            for vehicle in self.vehicles
        ]
        return html_table(repr(self), headings, rows)

    @cached_property
    def names(self) -> list[str]:
        """The vehicles' names in file order."""
        return [vehicle.name for vehicle in self.vehicles]

    @cached_property
    def graph(self) -> Graph:
        """The interconnection with exact weights."""
        index = {name: i for i, name in enumerate(self.names)}
        tail = np.array([index[a] for a, _, _ in self.links.edges], dtype=np.int64)
        head = np.array([index[b] for _, b, _ in self.links.edges], dtype=np.int64)
        led = self.links.leader_links
        return Graph(
            tail,
            head,
            column(weight for _, _, weight in self.links.edges),
            column(led.get(name, Fraction(0)) for name in self.names),
        )

    @property
    def psi(self) -> Excitation | None:
        """The given excitation, None where the tool is to design it."""
        return self.excitation.psi if self.excitation else None

    @cached_property
    def arm(self) -> Array:
        """The signed lever arm of the left wheel, m, exact (N,): 2R in (2) as printed, -R on a physical drive.

        Nominal, where only an interval of R is known.
        """
        sign = 1 if self.drive == "paper" else -1
        return column(sign * self.arm_factor * nominal(vehicle.half_track) for vehicle in self.vehicles)

    @property
    def arm_factor(self) -> int:
        """|lever arm| over R: 2 in (2) as printed, 1 on a physical drive."""
        return 2 if self.drive == "paper" else 1

    def plant(self) -> Plant:
        """The numbers of (1)-(14) as floats, mass and inertia with the wheels' own; nominal for intervals."""
        return Plant(
            graph=self.graph.map(floats),
            m=floats(column(v.effective_mass() for v in self.vehicles)),
            inertia=floats(column(v.effective_inertia(self.arm_factor) for v in self.vehicles)),
            r=floats(column(nominal(v.wheel_radius) for v in self.vehicles)),
            arm=floats(self.arm),
            offset_x=floats(column(v.offset[0] for v in self.vehicles)),
            offset_y=floats(column(v.offset[1] for v in self.vehicles)),
            leader_x=float(self.leader.position[0]),
            leader_y=float(self.leader.position[1]),
            leader_theta=self.leader.theta,
        )

    def condition_data(self, psi: Excitation) -> ConditionData:
        """The numbers of the conditions, exact, for the excitation psi; the worst case where parameters are intervals.

        (16) and (16*) say that u_v + u_omega / arm stays below 2 torque / r: the worst case is the smallest arm, the
        largest r and the smallest torque limit. Accelerations are largest for the least mass and inertia, wheels are
        fastest for the longest arm and the smallest r.
        """

        def limit(name: str) -> Array:
            return column(getattr(v.limits, name) or math.inf for v in self.vehicles)

        return ConditionData(
            degree=self.graph.degree,
            psi_bar=psi.bound,
            r=column(high(v.wheel_radius) for v in self.vehicles),
            arm=column(self.arm_factor * low(v.half_track) for v in self.vehicles),
            torque=column(min(low(v.torque_limit.left), low(v.torque_limit.right)) for v in self.vehicles),
            speed=limit("speed"),
            turn_rate=limit("turn_rate"),
            wheel_speed=limit("wheel_speed"),
            acceleration=limit("acceleration"),
            turn_acceleration=limit("turn_acceleration"),
            m=column(v.mass_bounds()[0] for v in self.vehicles),
            inertia=column(v.inertia_bounds(self.arm_factor)[0] for v in self.vehicles),
            longest_arm=column(self.arm_factor * high(v.half_track) for v in self.vehicles),
            smallest_r=column(low(v.wheel_radius) for v in self.vehicles),
        )

    def start(self) -> State | None:
        """The initial state as floats, each (N,), or None where a vehicle of the file has none."""
        starts = [vehicle.start for vehicle in self.vehicles]
        if any(start is None for start in starts):
            return None
        rows = [(*s.position, s.theta, s.v, s.omega) for s in starts if s is not None]
        return State(*np.array(rows, dtype=float).T)

    @cached_property
    def content(self) -> dict[str, Any]:
        """What a certificate says of the fleet; see `fleet_content`.

        Left out are names, the leader's pose, starts, footprints, scales (they belong to the gains), the disturbance.
        """
        return fleet_content(self.drive, self.vehicles, self.graph, self.psi)

    @cached_property
    def digest(self) -> str:
        """The digest of the content: what ties a certificate to a fleet file. The names of vehicles do not count."""
        return digest_of(self.content)


def digest_of(content: Any) -> str:
    """SHA-256 of some content as JSON with sorted keys, without spaces."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return "sha256:" + hashlib.sha256(text.encode()).hexdigest()
