"""Digests that tie the files of a folder together: one of the fleet, one of its controller."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from .excitation import Excitation
from .fleet import Fleet, digest_of
from .fleet_content import excitation_content, fixed_point
from .gains import GAIN_NAMES, Gains

KEYS = ("fleet_digest", "controller_digest")  # of the entries of JSON files


class Digests(NamedTuple):
    """The digests of the fleet and the controller that a file belongs to."""

    fleet: str  # of the fleet file's content: no leader's pose, starts or disturbance
    controller: str  # of gains, scales, psi, links, robots and the leader's pose

    @classmethod
    def of(cls, fleet: Fleet, used: Fleet, excitation: Excitation, gains: Gains) -> Digests:
        """The digests of a fleet, and of its controller with these links and psi."""
        return cls(fleet.digest, controller_digest(used, excitation, gains))

    @classmethod
    def of_json(cls, content: Mapping[str, Any]) -> Digests:
        """The digests in a file; empty texts if it has none."""
        return cls(*(str(content.get(key) or "") for key in KEYS))

    def __str__(self) -> str:
        """For the metadata of a figure."""
        return f"fleet {self.fleet}, controller {self.controller}"

    def to_json(self) -> dict[str, str]:
        """The entries for a JSON file."""
        return dict(zip(KEYS, self, strict=True))


def controller_digest(used: Fleet, excitation: Excitation, gains: Gains) -> str:
    """SHA-256 of all numbers of the controller: gains, scales, psi, links, robots and the leader's pose."""
    scales = gains.saturation.columns(len(used))
    content: dict[str, Any] = {
        "fleet": used.digest,
        "vehicles": used.names,
        "leader": used.leader.model_dump(mode="json"),
        "gains": {name: fixed_point(getattr(gains, name)) for name in GAIN_NAMES},
        "saturation": {name: fixed_point(column) for name, column in scales.items()},
        "excitation": excitation_content(excitation),
    }
    return digest_of(content)
