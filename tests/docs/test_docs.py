"""The documentation: its code runs and its links lead somewhere; `make docs` builds it and stops at a warning."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from runpy import run_path

import pytest
from gaincert.models.files.fleet_file import load_fleet as load
from gaincert.models.files.gains_file import load_gains
from gaincert.models.paper import paper_fleet

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").glob("*.md"))
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SHORT = """#!/bin/sh
case "$*" in
  *--gains*) ;;
  design*|run*) set -- "$@" --mode draft ;;
esac
exec {} -m gaincert "$@"
"""
LINK = re.compile(r"\]\(([^)#\s]*)(#[^)\s]*)?\)")


def blocks(page, language):
    return [text for kind, text in BLOCK.findall(page.read_text()) if kind == language]


def having(language):
    return [pytest.param(page, id=page.name) for page in PAGES if blocks(page, language)]


@pytest.fixture
def shell(tmp_path):
    """A shell in a folder with `examples` alone; `gaincert` is the one that is tested, its designs are drafts."""
    programs = tmp_path / "bin"
    programs.mkdir()
    script = programs / "gaincert"
    script.write_text(SHORT.format(sys.executable))
    script.chmod(0o755)
    work = tmp_path / "work"
    work.mkdir()
    (work / "examples").symlink_to(ROOT / "examples")
    environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}

    def run(*command):
        done = subprocess.run(command, cwd=work, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
        return work

    return run


@pytest.mark.slow
@pytest.mark.needs("gcc", "make")
@pytest.mark.parametrize("page", having("sh"))
def test_shell_blocks_run_one_after_the_other(page, shell):
    work = shell("sh", "-e", "-c", "\n".join(blocks(page, "sh")))
    assert (work / "out" / "report.html").stat().st_size > 10_000


@pytest.mark.slow
@pytest.mark.parametrize("page", having("python"))
def test_python_blocks_run_one_after_the_other(page, shell):
    shell(sys.executable, "-c", "\n".join(blocks(page, "python")))


@pytest.mark.parametrize("page", having("toml"))
def test_toml_blocks_are_fleets_or_gains(page, tmp_path):
    for text in blocks(page, "toml"):
        path = tmp_path / "block.toml"
        path.write_text(text)
        if "vehicle" in tomllib.loads(text):
            assert len(load(path)) == text.count("[[vehicle]]")
        else:
            assert len(load_gains(path, paper_fleet()).gains.p_v) == 6


@pytest.mark.needs("gcc")
@pytest.mark.parametrize("page", having("c"))
def test_c_blocks_are_what_the_header_declares(page):
    header = (ROOT / "reports" / "templates" / "controller.h.jinja").read_text()
    for text in blocks(page, "c"):
        assert " ".join(text.split()) in " ".join(header.split())


def test_the_acceleration_limits_of_the_physics_page_follow_from_its_fleet():
    """a > 2 sqrt2 (2 c / r) / m and a_omega > (2 + 2 sqrt2) (2 c R / r) / I, with effective values."""
    fleet = load(ROOT / "examples" / "three_robots.toml")
    plant, (waffle, kobuki) = fleet.plant(), (fleet.names.index(name) for name in ("waffle", "kobuki"))
    force = 2 * float(fleet.disturbance.coulomb) / plant.r
    ahead, turning = 2 * 2**0.5 * force / plant.m, (2 + 2 * 2**0.5) * force * abs(plant.arm) / plant.inertia
    text = " ".join((ROOT / "docs" / "physics.md").read_text().split())
    assert f"{ahead[waffle]:.1f} m/s^2 and {turning[waffle]:.0f} rad/s^2 for the Waffle" in text
    assert f"{ahead[kobuki]:.1f} m/s^2 and {turning[kobuki]:.0f} rad/s^2 for the Kobuki" in text


@pytest.mark.parametrize("page", [pytest.param(page, id=page.name) for page in PAGES])
def test_links_lead_somewhere(page):
    for target, _ in LINK.findall(page.read_text()):
        assert target.startswith("https://") or (page.parent / target).exists(), target


def test_every_page_is_in_the_navigation():
    navigation = (ROOT / "mkdocs.yml").read_text()
    assert all(f": {page.name}\n" in navigation for page in PAGES)


def test_every_verb_and_output_file_is_documented():
    text = "".join(page.read_text() for page in PAGES)
    for verb in (
        "init",
        "check",
        "prove",
        "design",
        "certify",
        "verify",
        "simulate",
        "validate",
        "report",
        "export",
        "run",
    ):
        assert re.search(rf"gaincert {verb}\b", text), verb
    for name in ("design.json", "gains.csv", "summary.json", "validation.json", "trajectory.npz", "fleet_copy.toml"):
        assert name in text


@pytest.mark.slow
def test_the_tour_of_the_python_interface_runs(tmp_path, capsys):
    run_path(str(ROOT / "examples" / "api_tour.py"))["tour"](tmp_path, "draft")
    assert "not certified: vehicle" in capsys.readouterr().out
    assert (tmp_path / "report.html").is_file()


def test_the_papers_figures_and_numbers_are_printed_and_drawn(tmp_path, capsys, monkeypatch):
    """Section 4: (15) and (16) are tight, the bounded scheme keeps to the limits and the unbounded one does not."""
    monkeypatch.setattr(sys, "argv", ["paper_figures.py", str(tmp_path), "--horizon", "3"])
    run_path(str(ROOT / "examples" / "paper_figures.py"), run_name="__main__")
    printed = capsys.readouterr().out
    assert "|psi| <= 2.43233" in printed
    assert re.search(r"^v5 .* 503\.52 < +504\.00", printed, re.MULTILINE)
    assert "unbounded torques: up to 7.5" in printed
    assert re.search(r"'the bounds of the actuators': up to 0\.\d+ of the limit", printed)
    for name in ("paths", "poses", "wheel_torques"):
        assert (tmp_path / f"{name}.pdf").read_bytes().startswith(b"%PDF")


def test_every_public_name_is_there_and_documented():
    import gaincert

    text = (ROOT / "docs" / "api.md").read_text()
    for name in gaincert.__all__:
        assert getattr(gaincert, name) is not None
        assert name == "__version__" or f"`{name}`" in text
