"""What disturbances do to a validated design: the part of validation.json that speaks of real robots."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ...models.equations import State
from ...models.fleet import Fleet
from ..simulation.disturbance import Disturbance, disturbed, in_words, largest_sample_time, parts, report
from .validate import Question


def robustness(
    fleet: Fleet,
    question: Question,
    starts: Sequence[State],
    results: Sequence[dict[str, Any]],
    disturbance: Disturbance | None,
    largest: bool,
    progress: Callable[[str, float], None] = lambda _what, _fraction: None,
) -> dict[str, Any]:
    """Each disturbance against the nominal results of the same starts; the largest sample time if asked for."""
    loop, horizon, tolerance = question.loop, question.horizon, question.tolerance
    nominal = [result["settling_time_s"] for result in results]
    found: dict[str, Any] = {}
    if disturbance is not None:
        asked = parts(disturbance)
        found["disturbed"] = []
        for number, one in enumerate(asked):
            progress("disturbed runs", number / len(asked))
            run = disturbed(fleet, loop, starts, one, horizon, tolerance)
            found["disturbed"].append(report(one, run, nominal))
    if largest:
        progress("largest sample time", 0.0)
        found["largest_sample_time_s"] = largest_sample_time(fleet, loop, starts, Disturbance(), horizon, tolerance)
    return found


def sentences(document: dict[str, Any]) -> list[str]:
    """The same for a reader."""
    lines = []
    for entry in document.get("disturbed", []):
        later = entry["later_than_nominal_s"]
        lines.append(
            f"with {in_words(entry['disturbance'])}: {entry['settled']} settle"
            + (f", {later['median']:+.3g} s against nominal (median)" if later else "")
            + f", peak torque {100 * entry['peak_torque_ratio']:.2f} %"
        )
    if "largest_sample_time_s" in document:
        found = document["largest_sample_time_s"]
        lines.append(
            "no sample time lets all starts settle"
            if found is None
            else f"largest sample time at which all starts settle within torque limits: {found:.3g} s"
        )
    return lines
