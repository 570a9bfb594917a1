"""What many starts say together: the content of validation.json."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

from .validate import Question

SENSITIVE = 0.5  # m between two very accurate runs of a start: beyond, rounding has a part in its settling time
SHOWN = 5  # failures and violations that are printed

Results = Sequence[dict[str, Any]]


def summarize(question: Question, results: Results, seed: int | None) -> dict[str, Any]:
    """The content of validation.json, but for what the caller knows (versions)."""
    times = [result["settling_time_s"] for result in results]
    settled = sorted(time for time in times if time is not None)
    whole = [result for result in results if not result.get("gave_up")]
    worst = max(whole, key=lambda result: float(result["peak_torque_ratio"]["value"]), default=None)
    return {
        "starts": len(results),
        "settled": len(settled),
        "settling_time_s": {**spread(times), "each": times},
        "ratio_to_physical_limit": _over_limit(results),
        "peak_torque_ratio": worst and worst["peak_torque_ratio"]["value"],
        "peak_torque": worst and {"start": worst["start"], **worst["peak_torque_ratio"]},
        "peak_speed": max((result["peak_speed"]["value"] for result in whole), default=None),
        "peak_turn_rate": max((result["peak_turn_rate"]["value"] for result in whole), default=None),
        "max_V_increase": max((result["max_V_increase"] for result in whole), default=None),
        "sensitive": [r["start"] for r in whole if (r["sensitivity_m"] or 0) > SENSITIVE],
        "failures": [_failure(result) for result in results if result["failure"]],
        "violations": [{"start": result["start"], "what": what} for result in results for what in result["violations"]],
        "seed": seed,
        "question": question.key,
        **{key: question.content[key] for key in ("fleet_digest", "tolerance", "horizon_s", "starts_from")},
        "integrator": question.content["integrator"],
    }


def spread(times: Sequence[float | None]) -> dict[str, float | None]:
    """Median, ninth decile and maximum over all starts; a start that never settled counts as later than all others."""
    ordered = sorted(time for time in times if time is not None)
    missing = len(times) - len(ordered)
    return {
        "median": _rank(ordered, missing, 0.5),
        "p90": _rank(ordered, missing, 0.9),
        "max": None if missing or not ordered else ordered[-1],
    }


def _rank(ordered: Sequence[float], missing: int, share: float) -> float | None:
    """The quantile with linear interpolation; None where it falls among those that never settled."""
    place = share * (len(ordered) + missing - 1)
    below, fraction = int(place), place - int(place)
    above = below + (fraction > 0)
    if above >= len(ordered):
        return None
    return ordered[below] + fraction * (ordered[above] - ordered[below])


def _over_limit(results: Results) -> dict[str, float | None]:
    """Settling time over the physical limit of the same start."""
    ratios = [result["settling_time_s"] / result["physical_limit_s"] for result in results if result["settling_time_s"]]
    return {"median": statistics.median(ratios) if ratios else None, "max": max(ratios, default=None)}


def _failure(result: dict[str, Any]) -> dict[str, Any]:
    kept = ("start", "failure", "gave_up", "final_position_error_m", "final_heading_error_rad")
    return {key: result[key] for key in kept if key in result}


def sentences(document: dict[str, Any]) -> list[str]:
    """The same in some lines for a reader."""
    times, tolerance = document["settling_time_s"], document["tolerance"]
    said = {key: "later" if times[key] is None else f"{times[key]:.4g} s" for key in ("median", "p90", "max")}
    lines = [
        f"{document['settled']} of {document['starts']} starts settle within {tolerance['position_m']:g} m and "
        f"{tolerance['heading_rad']:g} rad by {document['horizon_s']:g} s: median {said['median']}, "
        f"ninth decile {said['p90']}, slowest {said['max']}"
    ]
    if (ratio := document["ratio_to_physical_limit"]["median"]) is not None:
        lines.append(f"that is {ratio:.3g} times the physical limit (median over the starts that settle)")
    if (peak := document["peak_torque"]) is not None:
        lines.append(
            f"peak torque {100 * peak['value']:.2f} % of the limit (vehicle {peak['vehicle']!r}, "
            f"start {peak['start']}, {peak['time_s']:.3g} s), peak speed {document['peak_speed']:.3g} m/s"
        )
    if document["sensitive"]:
        lines.append(
            f"{len(document['sensitive'])} of {document['starts']} starts are chaotic at first: "
            "rounding errors choose their times, and only the figures over all starts mean something"
        )
    lines += [f"FALSE: start {entry['start']}: {entry['what']}" for entry in document["violations"][:SHOWN]]
    lines += [f"start {entry['start']}: {entry['failure']}" for entry in document["failures"][:SHOWN]]
    hidden = len(document["failures"]) - SHOWN
    return [*lines, f"and {hidden} more, in validation.json"] if hidden > 0 else lines
