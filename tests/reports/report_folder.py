"""A folder as `gaincert run` leaves it, in a second: the paper's gains, a short run, and names that are markup."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from gaincert.models.digests import Digests
from gaincert.models.files.text import write_json
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES
from gaincert.models.numbers import decimal_text
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.reports.deployment import write_fleet_copy
from gaincert.reports.figures.run_figures import write_figures
from gaincert.reports.tables.gain_table import rows, write_csv
from gaincert.verify.certificates.certify import certify
from gaincert.verify.simulation.simulate import simulate, summarize

ATTACKS = (
    "<img src=x onerror=alert(1)>",
    "</script><script>alert(2)</script>",
    "<!--<script>",
    '" onmouseover="alert(3)',
    "{{ 7 * 7 }}{% raw %}",
    "javascript:alert(4)//\u2028&lt;b&gt;",
)

HOSTILE = "<script>alert(1)</script> \\input{/etc/passwd} $x$ & % # _ ^ ~ | `a` 车 \n {{ 7 * 7 }}"


def renamed(names: tuple[str, ...], title: str) -> Fleet:
    """The paper's fleet under other names."""
    fleet = paper_fleet()
    new = dict(zip(fleet.names, names, strict=True))
    content = json.loads(fleet.model_dump_json(by_alias=True))
    content["name"] = title
    for vehicle in content["vehicle"]:
        vehicle["name"] = new[vehicle["name"]]
    graph = content["graph"]
    graph["edges"] = [[new[a], new[b], weight] for a, b, weight in graph["edges"]]
    graph["leader_links"] = {new[name]: weight for name, weight in graph["leader_links"].items()}
    return Fleet.model_validate(content)


def fill(folder: Path, fleet: Fleet, horizon: float = 30.0) -> Path:
    """Write the files that the report reads; psi is the paper's."""
    gains, excitation = paper_gains(), paper_excitation()
    digests = Digests.of(fleet, fleet, excitation, gains)
    certify(fleet, excitation, gains, "paper").write(folder / "certificate.json")
    write_csv(folder / "gains.csv", rows(fleet, excitation, gains))
    write_fleet_copy(fleet, folder)
    write_json(folder / "design.json", {**design(fleet), **digests.to_json()})
    run = simulate(fleet, gains, excitation, horizon=horizon)
    run.write(folder / "trajectory.npz", digests.to_json())
    write_figures(fleet, {"bounded scheme": run}, folder / "figures", str(digests))
    origin = {"scheme": "bounded", **digests.to_json(), "versions": {"gaincert": "<b>0</b>"}}
    write_json(folder / "summary.json", {**summarize(fleet, run).to_json(), **origin})
    write_json(folder / "validation.json", {**validation(), **digests.to_json()})
    write_json(folder / "proof.json", CLAIMS)
    return folder


def design(fleet: Fleet) -> dict[str, Any]:
    """A design.json."""
    return {
        "fleet": fleet.name,
        "conditions": "paper",
        "excitation": paper_excitation().table(),
        "excitation_designed": False,
        "psi_bar": decimal_text(paper_excitation().bound),
        "gains": {name: [decimal_text(value) for value in getattr(paper_gains(), name)] for name in GAIN_NAMES},
        "predicted": {"gamma_omega": 0.1, "gamma_v": 0.2, "kappa": 0.3, "tail_time_s": 1.0},
        "measured_settling_s": [10.0, None, 30.0],
        "seed": 0,
        "digits": 4,
        "versions": {"python": "3"},
    }


def validation() -> dict[str, Any]:
    """A validation.json."""
    each = [10.0 + number for number in range(40)] + [None, None]
    return {"starts": 42, "settled": 40, "settling_time_s": {"median": 30.5, "p90": 48.0, "max": None, "each": each}}


CLAIMS: list[dict[str, Any]] = [
    {
        "id": "theorem",
        "source": "corrected theorem",
        "statement": "the formation is UGAS <script>alert(5)</script>",
        "status": "PROVED",
        "method": "all lemmas",
        "reason": "L15",
        "group": "theorem",
        "needs": ["eq-21"],
    },
    {
        "id": "eq-21",
        "source": "(21)",
        "statement": "as printed",
        "status": "CORRECTED",
        "method": "algebra",
        "reason": "three errors",
        "group": "printed",
        "needs": [],
        "corrected": "the true form",
        "stated": "x",
        "mathml": {
            "stated": '<math display="inline"><mi onclick="alert(6)">x</mi><mo>&InvisibleTimes;</mo></math>',
            "derived": "<math><mtext><script>alert(7)</script></mtext></math>",
        },
    },
]
