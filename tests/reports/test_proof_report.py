"""The proof report: five files, escaped, typeset, and a LaTeX document that compiles."""

import json
import subprocess

import pytest
from defusedxml import ElementTree
from gaincert.reports.proof import documents as proof_report
from gaincert.reports.proof.notation import latex, mathml
from gaincert.verify.proof.claim import Status
from gaincert.verify.proof.generic_fleet import generic


@pytest.fixture(scope="module")
def documents(claims, tmp_path_factory):
    folder = tmp_path_factory.mktemp("proof")
    proof_report.write_documents(claims, folder)
    return folder


def test_five_files_are_written(documents):
    names = {"proof.json", "proof.md", "proof.html", "proof.tex", "proof_graph.svg"}
    assert {path.name for path in documents.iterdir()} == names


def test_json_has_the_keys_of_the_contract(claims, documents):
    rows = json.loads((documents / "proof.json").read_text())
    assert rows == proof_report.claims_to_json(claims)
    assert len(rows) >= 45
    for row in rows:
        assert {"id", "source", "statement", "status", "method", "reason", "needs"} <= set(row)
        assert row["status"] in Status.__members__
        assert row["status"] != "CORRECTED" or row["corrected"]
        assert row["status"] not in ("CORRECTED", "REFUTED") or row["witness"]


def test_what_is_false_heads_the_report(documents):
    for name in ("proof.md", "proof.html", "proof.tex"):
        text = (documents / name).read_text()
        assert text.index("Refuted (") < text.index("Corrected (") < text.index("Proved (")


def test_svg_and_html_are_well_formed(documents):
    ElementTree.parse(documents / "proof_graph.svg")
    html = (documents / "proof.html").read_text()
    assert "http://" not in html.replace("http://www.w3.org", "")
    assert html.count("<math") > 20
    assert html.count("<math") == html.count("</math>")


def test_hostile_names_are_escaped(hostile_claims, tmp_path):
    proof_report.write_documents(hostile_claims, tmp_path)
    html = (tmp_path / "proof.html").read_text()
    assert "<script" not in html
    tex = (tmp_path / "proof.tex").read_text()
    assert "\\input{" not in tex
    assert "<script" not in (tmp_path / "proof.md").read_text()
    ElementTree.parse(tmp_path / "proof_graph.svg")


@pytest.mark.needs("latex")
@pytest.mark.parametrize("hostile", [False, True])
def test_latex_compiles(claims, hostile_claims, tmp_path, hostile):
    proof_report.write_documents(hostile_claims if hostile else claims, tmp_path)
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "proof.tex"],
        cwd=tmp_path, capture_output=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-2000:].decode(errors="replace")
    assert (tmp_path / "proof.pdf").stat().st_size > 20_000


def test_every_symbol_is_typeset():
    g = generic()
    for rate in (*g.closed_loop.v, *g.closed_loop.omega):
        folded = g.dt(g.fold(rate))
        assert "text" not in latex(folded)
        assert "_" not in "".join(ElementTree.fromstring(mathml(folded).replace("&InvisibleTimes;", "")).itertext())


def test_figures_of_the_witnesses(tmp_path):
    from gaincert.reports.figures import witnesses as proof_figures

    for path in proof_figures.write_witness_figures(tmp_path):
        ElementTree.parse(path)
