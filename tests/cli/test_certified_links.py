"""A certificate of links that the fleet does not have: valid of its own fleet, refused as one of the user's fleet."""

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from gaincert.models.files.fleet_text import dumps
from gaincert.models.fleet_tables import Links
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.reports.html.verdicts import CERTIFIED
from gaincert.verify.certificates.certify import certify

from tests.campaigns.certified_fleets import CASES
from tests.cli.command_line import gaincert

Content = dict[str, Any]


def of_another_link() -> Content:
    """A valid certificate of the paper's fleet with a further edge, v4 - v6."""
    fleet = paper_fleet()
    links = Links(edges=(*fleet.links.edges, ("v4", "v6", Fraction(1, 1000))), leader_links=fleet.links.leader_links)
    gains = paper_gains().map(lambda values: values / 2)
    certificate = certify(fleet.with_links(links), paper_excitation(), gains, "paper")
    assert certificate.valid
    content: Content = json.loads(certificate.to_json())
    return content


def of_another_weight() -> Content:
    """A certificate with a weight under `designed` for an edge that is not in the fleet."""
    content: Content = json.loads(CASES["paper"]().certificate.to_json())
    content["designed"]["weights"] = {"edges": "1 1 1 1 1 1 1 1", "leader_links": "10 10"}
    return content


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the paper's fleet."""
    (tmp_path / "fleet_copy.toml").write_text(dumps(paper_fleet()))
    return tmp_path


def written(folder: Path, content: Content) -> Path:
    path = folder / "certificate.json"
    path.write_text(json.dumps(content))
    return path


@pytest.mark.parametrize("forged", [of_another_link, of_another_weight])
def test_verify_refuses_the_links_of_another_fleet(forged: Callable[[], Content], folder: Path) -> None:
    path = written(folder, forged())
    done = gaincert("verify", path, "--fleet", folder / "fleet_copy.toml")
    assert done.returncode in {1, 2}
    assert not done.stdout.startswith("VALID")


@pytest.mark.parametrize("forged", [of_another_link, of_another_weight])
@pytest.mark.parametrize("format_", ["c", "ros2", "csv", "latex", "markdown"])
def test_export_refuses_the_links_of_another_fleet(format_: str, forged: Callable[[], Content], folder: Path) -> None:
    path = written(folder, forged())
    done = gaincert("export", folder, "--format", format_)
    assert done.returncode == 2
    assert str(path) in done.stderr
    assert {file.name for file in folder.iterdir()} == {"certificate.json", "fleet_copy.toml"}


@pytest.mark.parametrize("forged", [of_another_link, of_another_weight])
def test_report_refuses_the_links_of_another_fleet(forged: Callable[[], Content], folder: Path) -> None:
    written(folder, forged())
    assert gaincert("report", folder).returncode == 0
    page = (folder / "report.html").read_text()
    assert "Not deployable" in page
    assert CERTIFIED not in page


def test_the_true_certificate_is_accepted(folder: Path) -> None:
    path = written(folder, json.loads(CASES["paper"]().certificate.to_json()))
    assert gaincert("report", folder).returncode == 0
    assert CERTIFIED in (folder / "report.html").read_text()
    assert gaincert("verify", path, "--fleet", folder / "fleet_copy.toml").stdout.startswith("VALID")
    assert gaincert("export", folder, "--format", "csv").returncode == 0
