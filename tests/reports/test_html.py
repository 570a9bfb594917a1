"""report.html: one file, safe for all names; figures; animations."""

import base64
import hashlib
import html
import json
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from gaincert.models.equations import State
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.text import write_json
from gaincert.models.paper import paper_fleet
from gaincert.reports.deployment import load_deployment, write_fleet_copy
from gaincert.reports.escapes import script_json
from gaincert.reports.figures.movie import write_movie
from gaincert.reports.html.animation import ANGLE, RATIO, animation_data, frame_indices
from gaincert.reports.html.embed import safe_mathml
from gaincert.reports.html.page import write_report
from gaincert.reports.tables.conditions_table import condition_rows
from gaincert.reports.tables.designs_table import design_rows
from gaincert.verify.simulation.trajectory import Trajectory, read_trajectory

from tests.reports.report_folder import ATTACKS, CLAIMS

ROOT = Path(__file__).parents[2]
MOST_BYTES = 5_000_000


@pytest.fixture(scope="module")
def page(attacked):
    return (attacked / "report.html").read_text()


def elements(page):
    """(tag, names of its attributes) of every element, as a browser reads them."""
    found = []
    parser = HTMLParser()
    parser.handle_starttag = lambda tag, attributes: found.append((tag, [name for name, _ in attributes]))
    parser.feed(page)
    return found


def data(page):
    return json.loads(re.search(r'<script type="application/json" id="run">(.*?)</script>', page, re.DOTALL)[1])


def test_the_report_is_one_small_file_without_network(page):
    assert len(page.encode()) < MOST_BYTES
    assert not re.findall(r'(?:src|href)="(?!data:|#)', page)
    assert not re.search(r"url\(|@import|\bfetch\(|XMLHttpRequest|WebSocket", page)
    assert "default-src 'none'" in page


def test_the_only_script_is_ours_and_the_policy_names_it(page):
    scripts = re.findall(r"<script(.*?)>(.*?)</script>", page, re.DOTALL)
    assert [attributes for attributes, _ in scripts] == [' type="application/json" id="run"', ""]
    digest = base64.b64encode(hashlib.sha256(scripts[1][1].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in html.unescape(page)


def test_hostile_names_stay_text_everywhere(page):
    body = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"<img src=x|<script|<h1>title|<!--|<b>0", body)
    assert not {name for _, names in elements(page) for name in names if name.startswith("on")}
    assert [tag for tag, _ in elements(page)].count("script") == 2
    for name in ATTACKS:
        assert name in html.unescape(body)
    assert data(page)["names"] == list(ATTACKS)
    assert "49" not in re.findall(r'<th scope="row">(.*?)</th>', body)


def test_json_in_a_script_cannot_end_it():
    text = str(script_json({"</script>": "<!-- & \u2028"}))
    assert not set(text) & set("<>&\u2028")
    assert json.loads(text) == {"</script>": "<!-- & \u2028"}


def test_mathml_keeps_formulas_and_nothing_else(page):
    assert "<mi>x</mi><mo>\u2062</mo>" in page
    assert "alert(6)" not in page
    assert "<mtext><script>" not in page
    assert str(safe_mathml("<math><mi>a</mi></math>")) == '<math displaystyle="true"><mi>a</mi></math>'
    for bad in ("<math><a href='x'>b</a></math>", "<math>", "x < y", '<!DOCTYPE a [<!ENTITY b "c">]><math>&b;</math>'):
        assert "<" not in str(safe_mathml(bad))


def test_the_report_says_what_is_true(page):
    for words in ("✓</span> Certified", "✗</span> Does not settle", "✓</span> Torques within", "✗</span> Many starts"):
        assert words in page
    assert "✓</span> The corrected theorem is proved" in page
    assert page.count('class="bar"') == 6
    assert "rate-bounded" in page  # the condition sets side by side
    assert "certified exponential rate" in page


def test_a_tampered_certificate_is_not_called_certified(attacked, tmp_path):
    shutil.copytree(attacked, tmp_path / "x")
    path = tmp_path / "x" / "certificate.json"
    path.write_text(path.read_text().replace('"840 840 ', '"8400 840 '))
    page = write_report(tmp_path / "x").read_text()
    assert "✓</span> Certified" not in page
    assert "✗</span> Not deployable" in page


def test_files_of_different_fleets_are_not_mixed_silently(folder, tmp_path):
    shutil.copytree(folder, tmp_path / "x")
    summary = json.loads((folder / "summary.json").read_text())
    (tmp_path / "x" / "summary.json").write_text(json.dumps({**summary, "fleet_digest": "sha256:other"}))
    assert "summary.json is from other gains or another fleet" in write_report(tmp_path / "x").read_text()


@pytest.mark.parametrize("kept", ["design.json", "certificate.json", "summary.json", "proof.json", "validation.json"])
def test_a_folder_with_one_file_has_a_report(kept, folder, tmp_path):
    shutil.copy(folder / kept, tmp_path)
    assert "</html>" in write_report(tmp_path).read_text()


def test_without_a_copy_of_the_fleet_there_is_no_animation_and_with_one_given_there_is(folder, tmp_path):
    shutil.copytree(folder, tmp_path / "x")
    (tmp_path / "x" / "fleet_copy.toml").rename(tmp_path / "fleet.toml")
    assert "--fleet FLEET.toml" in write_report(tmp_path / "x").read_text()
    assert 'id="stage"' in write_report(tmp_path / "x", tmp_path / "fleet.toml").read_text()


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("design.json", "{"),
        ("design.json", "[1]"),
        ("design.json", '{"versions": {}}'),
        ("summary.json", '{"settling_time_s": "<b>"}'),
        ("validation.json", '{"starts": 1}'),
        ("proof.json", '[{"id": 1}]'),
        ("proof.json", "7"),
        ("trajectory.npz", "no zip"),
        ("certificate.json", "[]"),
        ("fleet_copy.toml", "name = 1"),
    ],
)
def test_a_broken_file_is_one_message(name, text, folder, tmp_path):
    shutil.copytree(folder, tmp_path / "x")
    (tmp_path / "x" / name).write_text(text)
    try:
        page = write_report(tmp_path / "x").read_text()
    except InputError:
        assert not (tmp_path / "x" / "report.html").exists()
    else:
        assert "✗" in page  # a certificate that is none is a verdict, not an error


def test_an_empty_folder_is_refused(tmp_path):
    with pytest.raises(InputError, match="holds no"):
        write_report(tmp_path)


def test_the_condition_sets_are_compared(folder):
    found = {row.name: row for row in condition_rows(load_deployment(folder, paper_fleet()))}
    assert [found[name].holds for name in ("paper", "corrected", "rate-bounded")] == [True, True, False]
    assert found["paper"].requested
    assert found["paper"].used == pytest.approx(503.52 / 504, abs=1e-3)  # (16) is tight
    assert found["rate-bounded"].where.startswith("(15'), vehicle v")


def test_designs_in_folders_are_compared(folder, tmp_path):
    shutil.copytree(folder, tmp_path / "x")
    assert design_rows(tmp_path / "x") == []
    shutil.copytree(folder, tmp_path / "x" / "<other>")
    shutil.copytree(folder, tmp_path / "x" / "of another fleet")
    for path in (tmp_path / "x" / "of another fleet").glob("*.json"):
        path.write_text(path.read_text().replace('"fleet_digest": "sha256:', '"fleet_digest": "sha256:0'))
    assert [row.name for row in design_rows(tmp_path / "x")] == ["this design", "<other>"]
    page = write_report(tmp_path / "x").read_text()
    assert "Designs side by side" in page
    assert "&lt;other&gt;" in page
    assert (tmp_path / "x" / "figures" / "designs.svg").is_file()


# -- figures and animations -------------------------------------------------------------------------------------------


def test_every_figure_is_there_as_svg_and_png(attacked, page):
    for name in ("paths", "poses", "cross_track", "torques", "energies", "settling"):
        assert (attacked / "figures" / f"{name}.svg").read_bytes().startswith(b"<?xml")
        assert (attacked / "figures" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert f'id="figure-{name}"' in page


def test_the_animation_is_the_run(folder):
    fleet, run = paper_fleet(), read_trajectory(folder / "trajectory.npz")
    shown = animation_data(fleet, run)
    frames = np.searchsorted(run.t, np.array(shown["t"]) - 1e-3)
    assert shown["t"][0] == 0
    assert shown["t"][-1] == run.t[-1]
    size = len(frames)
    for key, values, unit in (("x", run.state.x + 25, shown["unit"]), ("theta", run.state.theta, ANGLE)):
        seen = np.reshape(shown[key], (size, 6)) * unit
        assert np.abs(seen - values[frames]).max() <= 0.51 * unit
    ratio = max(np.abs(run.tau_left).max(axis=0) / [55, 55, 160, 160, 56, 56])
    assert max(shown["left"]) * RATIO == pytest.approx(ratio, abs=RATIO)  # no peak is lost
    assert shown["edges"][0] == [0, 1]
    assert shown["led"] == [1, 3]


def test_frames_follow_the_motion():
    t = np.linspace(0, 100, 10001)
    fast = np.where(t < 5, np.sin(20 * t), 0)[:, None]
    zero = np.zeros_like(fast)
    run = Trajectory(t, State(fast, zero, zero, zero, zero), zero, zero, t, t)
    frames = frame_indices(run, [0], 400)
    assert len(frames) <= 400
    assert (t[frames] < 5).mean() > 0.6
    assert np.abs(np.interp(t, t[frames], fast[frames, 0]) - fast[:, 0]).max() < 0.2
    still = Trajectory(t, State(zero, zero, zero, zero, zero), zero, zero, t, t)
    assert frame_indices(still, [0], 400)[-1] == 10000


def test_arrays_that_do_not_fit_are_refused(folder, tmp_path):
    with np.load(folder / "trajectory.npz") as stored:
        arrays = dict(stored)
    for change in ({"x": arrays["x"][:-1]}, {"V": arrays["x"]}, {"t": np.array([])}, {"y": np.array("text")}):
        np.savez(tmp_path / "t.npz", **{**arrays, **change})
        with pytest.raises(InputError, match="simulate again"):
            read_trajectory(tmp_path / "t.npz")
    np.savez(tmp_path / "t.npz", t=np.array([print], dtype=object))  # a pickle is never opened
    with pytest.raises(InputError):
        read_trajectory(tmp_path / "t.npz")


@pytest.mark.slow
def test_a_gif_moves(folder, monkeypatch):
    from gaincert.reports.figures import movie
    from PIL import Image

    monkeypatch.setitem(movie.FRAMES, "gif", 5)
    path = write_movie(folder, "gif", None, lambda _what, _fraction: None)
    with Image.open(path) as picture:
        assert picture.n_frames == 5
        assert picture.size == (720, 540)


def test_mp4_without_ffmpeg_is_bad_usage(folder, monkeypatch):
    monkeypatch.setenv("PATH", "/nowhere")
    command = [sys.executable, "-m", "gaincert", "report", folder, "--animate", "mp4"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 2
    assert "ffmpeg" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.needs("ffmpeg")
def test_an_mp4_is_written(folder, monkeypatch):
    from gaincert.reports.figures import movie

    monkeypatch.setitem(movie.FRAMES, "mp4", 5)
    path = write_movie(folder, "mp4", None, lambda _what, _fraction: None)
    assert path.read_bytes()[4:8] == b"ftyp"


def test_the_report_says_what_every_robot_is_taken_to_be(tmp_path):
    """With the wheels' own inertia, and with the note on a centre of mass, which (2) ignores."""
    content = paper_fleet().model_dump(by_alias=True)
    content["vehicle"][0].update(wheel_inertia="0.005", com_offset=["-0.1", 0])
    fleet = parse(content)
    write_fleet_copy(fleet, tmp_path)
    write_json(tmp_path / "proof.json", CLAIMS)
    text = html.unescape(write_report(tmp_path).read_text())
    assert "effective mass 14 kg" in text  # 10 + 2 * 0.005 / 0.05^2
    assert "v3, v4" in text
    assert "the centre of mass is off the middle of the axle: 'v1' 10 cm behind" in text
