"""`gaincert design --compare` and `--against`: designs and other gains, measured from the same starts."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .design import DesignOptions, design_gains, gains_of, write_design
from .inputs import StartOptions, Starts, digests_of, read_gains
from .validate import Validation, spec_of, validate_starts

if TYPE_CHECKING:
    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..synthesis.design import Design

COMPARED_STARTS = 20
COMPARED_HORIZON = 3000.0  # s


def compare_designs(
    printer: Printer, design: Design, options: DesignOptions, folder: Path, variants: bool, against: Path | None
) -> list[dict[str, Any]]:
    """Measure a design, its variants and the gains of a file from the same starts; files go to DIR/NAME.

    The variants are designs in mode "fast" under every other condition set, given and designed psi and weights, and
    one with unit scales.
    """
    from ..reports.tables.designs_table import as_json, design_rows, for_terminal

    fleet = design.fleet

    def measure(gains: GainsFile, place: Path) -> None:
        starts = Starts.of(fleet, StartOptions(COMPARED_STARTS, None, design.seed, options.box))
        spec = spec_of(fleet, gains, starts, COMPARED_HORIZON, design.tolerance)
        validate_starts(
            printer.silent(), fleet, Validation(spec, digests_of(fleet, gains), starts.states, design.seed), place
        )

    measure(gains_of(design), folder)
    if against is not None:
        measure(read_gains(against, fleet), folder / against.stem)
    for variant in variants_of(fleet, design, options) if variants else ():
        place = folder / name_of(variant)
        printer.say(f"designing {place.name} for comparison")
        other = design_gains(printer, fleet, variant)
        write_design(printer.silent(), other, place)
        measure(gains_of(other), place)
    rows = design_rows(folder)
    printer.say(f"from the same {COMPARED_STARTS} starts, up to {COMPARED_HORIZON:g} s:", for_terminal(rows))
    return as_json(rows)


def variants_of(fleet: Fleet, design: Design, options: DesignOptions) -> list[DesignOptions]:
    """The combinations of options that `design` did not use, and its own with unit scales."""
    from ..models.conditions import CONDITION_SETS

    sources = ("given", "designed")
    taken = (design.conditions.name, sources[design.excitation_designed], sources[design.links is not None])
    choices = product(CONDITION_SETS, sources if fleet.psi else ("designed",), sources)
    variants = [
        replace(options, mode="fast", conditions=conditions, excitation=excitation, weights=weights)
        for conditions, excitation, weights in choices
        if (conditions, excitation, weights) != taken
    ]
    unit = replace(options, mode="fast", excitation=sources[design.excitation_designed], saturation="unit")
    return variants if design.gains.saturation.unit else [*variants, unit]


def name_of(variant: DesignOptions) -> str:
    """The folder of a variant, which says its choices."""
    name = f"{variant.conditions}_{variant.excitation}-excitation_{variant.weights}-weights"
    return f"{name}_unit-scales" if variant.saturation == "unit" else name
