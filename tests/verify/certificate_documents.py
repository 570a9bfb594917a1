"""Certificates as documents, for tests of the kernel that change them."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from gaincert.models.fleet_content import fixed_point
from gaincert.verify import kernel

from tests.campaigns.certified_fleets import CASES

Document = dict[str, Any]
Change = Callable[[Document], Any]


def document(name: str = "paper") -> Document:
    """A valid certificate, to be changed."""
    loaded: Document = json.loads(CASES[name]().certificate.to_json())
    return loaded


def check(content: Any, digest: str | None = None) -> kernel.Verdict:
    return kernel.check_data(json.dumps(content).encode(), digest)


def reason(content: Any) -> str:
    """The rule that fails and why."""
    verdict = check(content)
    assert not verdict.valid, verdict
    return str(verdict)


def refusal(content: Any) -> str:
    """Why a document is refused, in one line."""
    with pytest.raises(kernel.UnreadableError) as caught:
        check(content)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def column(*values: Any) -> str:
    return fixed_point(Fraction(str(value)) for value in values)


def arcs(depth: int) -> dict[str, str]:
    """Arcs of one width over both halves of a period."""
    return dict.fromkeys(("here", "opposite"), " ".join([str(depth)] * 2 ** (depth + 1)))


def harmonics(sin: str = "", cos: str = "", mean: str = "0", frequency: str = "1") -> Document:
    return {"family": "harmonics", "mean": mean, "frequency": frequency, "sin": sin, "cos": cos}


NO_LIMITS = dict.fromkeys(kernel.LIMITS)


def single(torque: str = "100", **changes: Any) -> Document:
    """One vehicle, r = 2, arm = 1, D = 1, p_v = k psi_bar: T = d_v + 2 p_v + d_omega + p_omega = 6 exactly."""
    fleet = dict.fromkeys(("mass", "inertia", "half_track"), "1") | {"drive": "physical", "vehicles": 1}
    fleet |= {"wheel_radius": "2", "wheel_inertia": "0", "torque_left": torque, "torque_right": "100"}
    fleet |= {"offset_x": "0", "offset_y": "0", "limits": dict(NO_LIMITS), "excitation": harmonics("0.9")}
    fleet |= {"edges": {"tail": "", "head": "", "weight": ""}, "leader_links": {"vehicle": "0", "weight": "1"}}
    gains = dict.fromkeys(kernel.GAINS, "1") | {"p_omega": "2"}
    content = {
        "schema": kernel.SCHEMA,
        "conditions": "corrected",
        "fleet": fleet,
        "designed": {"excitation": None, "weights": None},
        "gains": gains,
        "psi_bar": "1",
        "arcs": arcs(2),
        "tree": {"link": "-1", "depth": "0"},
        "margins": {"(16*)": "0"},
        "rim_speed": "",
        "rates": {"gamma_omega": None, "gamma_v": None},
        "provenance": {},
    }
    return copy.deepcopy({**content, **changes})


def with_limit(content: Document, name: str, value: str, margin: str = "0") -> Document:
    """The single vehicle with a limit."""
    content["fleet"]["limits"][name] = {"vehicle": "0", "value": value}
    content["margins"][name] = margin
    return content
