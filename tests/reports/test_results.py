"""The report shows only matching files, names the others, and states the run of each result."""

import html
import json
import re
import shutil

import numpy as np
import pytest
from gaincert.models.digests import Digests
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.reports.figures.margins import write_margins
from gaincert.reports.html.page import write_report
from gaincert.reports.html.verdicts import many_starts_verdict, proof_verdict, run_verdicts
from gaincert.reports.results import (
    ClaimResult,
    ManyStartsResult,
    MarginResult,
    RunResult,
    current_digests,
    say_stale,
    stale_files,
)

DISTURBANCE = {"sample_time": 0.02, "delay": 0.04, "noise_position": 0.005, "noise_heading": 0.01, "coulomb": 0.02}
SPREAD = {"median": 10.0, "p90": 12.0, "max": None, "each": [10.0, 12.0, None]}
RUN = {
    "settling_time_s": 40.0,
    "tolerance": {"position_m": 0.1, "heading_rad": 0.1},
    "horizon_s": 80.0,
    "peak_torque_ratio": 0.5,
    "final_position_error_m": 0.01,
    "final_heading_error_rad": 0.02,
}


@pytest.fixture
def copied(folder, tmp_path):
    return shutil.copytree(folder, tmp_path / "x")


def of_other_gains(path):
    """Give a result the digest of other gains."""
    content = json.loads(path.read_text())
    path.write_text(json.dumps({**content, "controller_digest": "sha256:other"}))


def tiles(page):
    found = re.findall(r"<dt><span[^>]*>(.)</span> (.*?)</dt>\s*<dd>(.*?)</dd>", page, re.DOTALL)
    return [(mark, title, " ".join(html.unescape(re.sub("<.*?>", " ", text)).split())) for mark, title, text in found]


def test_the_files_of_a_folder_are_of_the_same_gains(folder):
    fleet = paper_fleet()
    expected = Digests.of(fleet, fleet, paper_excitation(), paper_gains())
    assert current_digests(folder) == expected
    assert stale_files(folder, expected) == []
    assert say_stale([]) == ""


@pytest.mark.parametrize(
    ("name", "verb", "title", "figure"),
    [
        ("summary.json", "simulate", "Settles|Does not settle", None),
        ("validation.json", "validate", "Many starts", "settling"),
    ],
)
def test_what_is_stale_is_named_and_left_out(name, verb, title, figure, copied):
    assert any(re.fullmatch(title, found) for _, found, _ in tiles(write_report(copied).read_text()))
    of_other_gains(copied / name)
    page = write_report(copied).read_text()
    left_out = next(text for _, found, text in tiles(page) if found == "Left out of this report")
    assert left_out == f"{name} is from other gains or another fleet: run gaincert {verb} again"
    assert not any(re.fullmatch(title, found) for _, found, _ in tiles(page))
    assert figure is None or f'id="figure-{figure}"' in page  # drawn of the right gains before


def test_a_trajectory_of_other_gains_is_not_shown(copied):
    assert 'id="stage"' in write_report(copied).read_text()
    with np.load(copied / "trajectory.npz") as stored:
        arrays = dict(stored)
    np.savez(copied / "trajectory.npz", **{**arrays, "controller_digest": np.array("sha256:other")})
    page = write_report(copied).read_text()
    assert 'id="stage"' not in page
    assert "trajectory.npz is from other gains" in page


def test_figures_of_other_gains_are_not_shown(copied):
    assert 'id="figure-paths"' in write_report(copied).read_text()
    (copied / "trajectory.npz").unlink()
    digest = current_digests(copied).controller
    for kind in ("svg", "png"):
        path = copied / "figures" / f"paths.{kind}"
        path.write_bytes(path.read_bytes().replace(digest.encode(), b"sha256:" + b"0" * 64))
    page = write_report(copied).read_text()
    assert 'id="figure-paths"' not in page
    assert 'id="figure-poses"' in page


def test_figures_are_drawn_again_for_the_run_that_belongs(copied):
    for kind in ("svg", "png"):
        path = copied / "figures" / f"paths.{kind}"
        path.write_bytes(path.read_bytes().replace(current_digests(copied).controller.encode(), b"sha256:" + b"0" * 64))
    assert 'id="figure-paths"' in write_report(copied).read_text()


def test_a_file_that_says_nothing_of_its_gains_is_stale(copied):
    content = json.loads((copied / "validation.json").read_text())
    del content["controller_digest"]
    (copied / "validation.json").write_text(json.dumps(content))
    assert stale_files(copied, current_digests(copied)) == ["validation.json"]


def test_tiles_say_which_run_they_speak_of():
    nominal = RunResult.model_validate(RUN)
    disturbed = {**RUN, "settling_time_s": None, "approach": "standing still", "peak_torque_ratio": 1.5}
    both = RunResult.model_validate({**disturbed, "disturbance": DISTURBANCE, "nominal": RUN})
    assert [(v.good, v.title) for v in run_verdicts(nominal)] == [
        (True, "Settles"),
        (True, "Torques within their limits"),
    ]
    verdicts = run_verdicts(both)
    assert [(verdict.good, verdict.title) for verdict in verdicts] == [
        (True, "Settles"),
        (True, "Torques within their limits"),
        (False, "Does not settle"),
        (False, "Torque limit exceeded"),
    ]
    assert all(verdict.text.startswith("nominal run, bounded scheme: ") for verdict in verdicts[:2])
    words = "with the disturbance: torques held for 20 ms, 40 ms of delay, noise of 0.005 m, 0.01 rad, friction of "
    assert all(verdict.text.startswith(words) for verdict in verdicts[2:])
    assert "not settled within 80 s and standing still" in verdicts[2].text


def test_many_starts_list_every_disturbance_with_its_count():
    runs = {"settling_time_s": SPREAD, "peak_torque_ratio": 0.4}
    result = ManyStartsResult.model_validate(
        {
            "starts": 3,
            "settled": 3,
            "settling_time_s": {**SPREAD, "max": 13.0, "each": [10.0, 12.0, 13.0]},
            "horizon_s": 300.0,
            "disturbed": [
                {"disturbance": {"sample_time": 0.02}, "settled": 3, **runs},
                {"disturbance": DISTURBANCE, "settled": 2, **runs},
            ],
            "margins": {
                "sample_time": {"largest": 0.05, "present": 0.02, "unit": "s", "tried": [0.002, 2.0]},
                "delay": {"largest": None, "present": 0.0, "unit": "s", "tried": [0.02, 20.0]},
            },
        }
    )
    (verdict,) = many_starts_verdict(result)
    assert not verdict.good  # all settle, but not with the disturbance
    assert "nominal: 3 of 3 settle within 300 s" in verdict.text
    assert "with disturbances: 2 of 3 at the worst" in verdict.text
    *runs, longest, delay = verdict.facts
    assert longest == "largest sample time with which all settle: 0.05 s (in the fleet file 0.02 s)"
    assert delay == "largest delay with which all settle: none that was tried (in the fleet file 0 s)"
    alone, together = (fact.split(" settle")[0] for fact in runs)
    assert alone == "torques held for 20 ms: 3 of 3"
    assert together.endswith("noise of 0.005 m, 0.01 rad, friction of 0.02 N m at every wheel: 2 of 3")


def test_margins_are_drawn_one_axis_for_each_disturbance(tmp_path):
    margins = {
        "sample_time": MarginResult(largest=0.05, present=0.02, unit="s", tried=(0.002, 2.0)),
        "coulomb": MarginResult(largest=None, present=0.0, unit="N m", tried=(0.001, 1.0)),
    }
    paths = write_margins(margins, tmp_path)
    assert {path.stem for path in paths} == {"margins"} and {".svg", ".png"} <= {path.suffix for path in paths}
    assert all(path.stat().st_size > 2_000 for path in paths)


def test_refuted_statements_are_the_papers():
    claim = {"source": "(15)", "statement": "s", "method": "m", "reason": "r"}
    kinds = {"theorem": "PROVED", "a": "REFUTED", "b": "CORRECTED"}
    claims = [ClaimResult.model_validate({**claim, "id": key, "status": status}) for key, status in kinds.items()]
    (verdict,) = proof_verdict(claims)
    assert verdict.good
    assert "of the paper's printed statements 1 are refuted and 1 corrected" in verdict.text
