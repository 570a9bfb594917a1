"""Folders and claims that several files of tests read; they are copied before they are changed."""

from dataclasses import replace

import pytest
from gaincert.models.fleet import Fleet
from gaincert.models.paper import paper_fleet, paper_gains
from gaincert.reports.html.page import write_report
from gaincert.verify import proof

from tests.models.conftest import draw_gains  # noqa: F401 -- exports are tested with every choice of the scales
from tests.reports.report_folder import ATTACKS, HOSTILE, fill, renamed


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """The paper's fleet with its own gains."""
    return fill(tmp_path_factory.mktemp("plain"), paper_fleet())


@pytest.fixture(scope="session")
def attacked(tmp_path_factory):
    """The same fleet under names that are markup, with its report."""
    folder = fill(tmp_path_factory.mktemp("attacked"), renamed(ATTACKS, "<h1>title</h1>"))
    write_report(folder)
    return folder


@pytest.fixture(scope="session")
def claims():
    return proof.prove()


@pytest.fixture(scope="session")
def hostile_claims():
    """Claims with markup of every language for a vehicle's name and for the values of a witness."""
    fleet = paper_fleet()
    vehicles = tuple(vehicle.model_copy(update={"name": HOSTILE}) for vehicle in fleet.vehicles)
    hostile = Fleet.model_construct(**{**dict(fleet), "vehicles": vehicles})
    vars(hostile)["graph"] = fleet.graph
    return [_with_values(claim) for claim in proof.prove(hostile, paper_gains())]


def _with_values(claim):
    if claim.id != "eq-21":
        return claim
    witness = replace(claim.facts[0].witness, left=HOSTILE)
    return replace(claim, facts=(replace(claim.facts[0], witness=witness, values=(HOSTILE,)),))
