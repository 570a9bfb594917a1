# ruff: noqa: RUF001 -- mathematical letters are compared
"""The proof report: its files, escaped, typeset, and a LaTeX document that compiles within its margins."""

import json
import subprocess

import pytest
from defusedxml import ElementTree
from gaincert.reports.proof import documents as proof_report
from gaincert.reports.proof.inline import inline_html, inline_markdown, inline_tex
from gaincert.reports.proof.letters import letter_of
from gaincert.reports.proof.notation import latex, mathml
from gaincert.reports.proof.statements import expressions, in_text, inner_steps, refuting, true_form
from gaincert.reports.proof.words import ALL
from gaincert.verify.proof import prove
from gaincert.verify.proof.claim import Kind, Quotation, Relation, Status
from gaincert.verify.proof.method.fleet_symbols import generic

from tests.campaigns.proof_verdicts import strained_fleet


@pytest.fixture(scope="module")
def documents(claims, tmp_path_factory):
    folder = tmp_path_factory.mktemp("proof")
    proof_report.write_documents(claims, folder)
    return folder


def test_every_file_is_written(documents):
    names = {"proof.json", "proof.md", "proof.html", "proof.tex", "proof_graph.svg"}
    names |= {"proof_preamble.tex", "proof_article.tex"}
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


def test_what_is_false_heads_the_report_and_the_rest_is_in_the_papers_order(claims, documents):
    """A page of what is false and what it changes, then every claim: (1) before (18) before L5 before the fleet."""
    false = [
        claim for claim in claims if claim.kind is Kind.PAPER and claim.status in (Status.REFUTED, Status.CORRECTED)
    ]
    assert len(false) == 15
    html = (documents / "proof.html").read_text()
    summary, rest = html.split('<h2 id="part-1">')
    assert all(f'href="#claim-{claim.id}"' in summary for claim in false)
    order = [
        rest.index(f'id="claim-{id_}"')
        for id_ in ("eq-1", "eq-12", "prop-1", "eq-18", "eq-21", "table-1", "L0", "L5", "theorem", "A1")
    ]
    assert order == sorted(order)
    for name in ("proof.md", "proof.tex"):
        text = (documents / name).read_text()
        assert text.index("what it changes for your gains") < text.index("The paper, in its order")


def test_every_false_statement_says_what_it_changes(claims):
    for claim in claims:
        false = claim.kind is Kind.PAPER and claim.status in (Status.REFUTED, Status.CORRECTED)
        assert bool(ALL[claim.id].effect) == false, claim.id


def test_all_facts_of_every_claim_are_shown(claims, documents):
    html = (documents / "proof.html").read_text()
    for claim in claims:
        section = html.split(f'id="claim-{claim.id}"')[1].split("</section>")[0]
        truth = claim.truth if claim.status is Status.CORRECTED else ()
        assert section.count("<li class=") == len(claim.facts) + len(truth) + len(inner_steps(claim)), claim.id


def test_a_true_form_never_says_that_something_is_itself(claims):
    """(23): what is left in the limit is the same expression on both sides, and has a letter."""
    for claim in claims:
        for fact in true_form(claim):
            assert not isinstance(fact.statement, Relation) or fact.left != fact.right, claim.id
        assert claim.status is not Status.CORRECTED or true_form(claim), claim.id
    (limit,) = (claim for claim in claims if claim.id == "eq-23")
    assert in_text(true_form(limit)[0].statement) == "limit = b_i*omega_i"


def test_the_witness_of_an_equation_has_two_sides_that_differ(claims):
    sides = [
        (fact.witness.left, fact.witness.right)
        for claim in claims
        for fact in refuting(claim)
        if isinstance(fact.statement, Relation) and fact.statement.sign == "=" and fact.witness.left
    ]
    assert len(sides) >= 4
    assert all(float(left) != float(right) for left, right in sides)


def test_formal_statements_are_closed_sentences(claims):
    quoted = [
        f.statement for c in claims for f in c.facts if isinstance(f.statement, Quotation) and f.statement.is_source
    ]
    assert len(quoted) > 10
    bound = [quotation.text for quotation in quoted if " F" in quotation.text]
    assert all(text.startswith(("forall", "exists")) or "forall F" in text for text in bound), bound


def test_every_letter_is_explained(claims, documents):
    html = (documents / "proof.html").read_text().split('<h2 id="letters">')[1]
    symbols = {s for e in expressions(claims) for s in getattr(e, "free_symbols", ())}
    assert len(symbols) > 100
    for symbol in symbols:
        letter, _ = letter_of(symbol.name)
        assert letter.meaning
    assert html.count("<tr>") > 60
    with pytest.raises(KeyError, match="no meaning"):
        letter_of("unheard_of")


def test_energies_are_followed_line_by_line(documents):
    for name, lines in (("proof.html", 6), ("proof.md", 6), ("proof.tex", 6)):
        text = (documents / name).read_text().lower()
        assert text.count("line by line") == lines
        assert text.count("terms that cancel in pairs") == lines
        assert text.count("less what is stated") == lines


@pytest.mark.parametrize(
    ("sentence", "html", "tex"),
    [
        ("omega_i <= psi_bar", "<i>ω</i><sub>i</sub> ≤ <i>ψ̄</i>", r"$\omega_{i}$ $\le$ $\bar{\psi}$"),
        (
            "phi_perp^T e_z' & a",
            "<i>φ</i><sub>⊥</sub><sup>⊤</sup> <i>e</i><sub>z</sub>′ &amp; a",
            r"$\phi_{\perp}^{\top}$ $e_{z}^{\prime}$ \& a",
        ),
        ("sum_j a_ij, m/s^2", "<i>∑</i><sub>j</sub> <i>a</i><sub>ij</sub>, m/s²", r"$\sum_{j}$ $a_{ij}$, m/s$^{2}$"),
        ("K of (b), 2 m/s", "<i>K</i> of (b), 2 m/s", "$K$ of (b), 2 m/s"),
        ('"so W rises"', "&quot;so <i>W</i> rises&quot;", "``so $W$ rises''"),
        ("a robot's <b>", "a robot&#x27;s &lt;b&gt;", r"a robot's \textless{}b\textgreater{}"),
    ],
)
def test_mathematics_in_sentences_is_typeset(sentence, html, tex):
    assert inline_html(sentence) == html
    assert inline_tex(sentence) == tex
    assert "<b>" not in inline_markdown(sentence)


def test_svg_and_html_are_well_formed(documents):
    ElementTree.parse(documents / "proof_graph.svg")
    html = (documents / "proof.html").read_text()
    assert "http://" not in html.replace("http://www.w3.org", "")
    assert html.count("<math") > 20
    assert html.count("<math") == html.count("</math>")


def test_a_fleet_with_scales_and_every_limit_is_reported():
    shown = proof_report.render("proof.md", prove(*strained_fleet()))
    limits = ("speed", "turn rate", "wheel speed", "acceleration", "turn acceleration")
    assert [name for name in limits if f"{name} limit" not in shown] == []


def test_hostile_names_are_escaped(hostile_claims, tmp_path):
    proof_report.write_documents(hostile_claims, tmp_path)
    html = (tmp_path / "proof.html").read_text()
    assert "<script" not in html
    tex = (tmp_path / "proof.tex").read_text()
    assert "\\input{" not in tex
    assert "<script" not in (tmp_path / "proof.md").read_text()
    ElementTree.parse(tmp_path / "proof_graph.svg")


def test_the_appendix_writes_out_the_closed_loop_and_then_the_energies(documents):
    """A fragment: what it needs is in a preamble beside it."""
    text = (documents / "proof.tex").read_text()
    assert "documentclass" not in text
    assert "usepackage" not in text
    section = text.split("section{The closed loop and its energies}")[1].split("section{The paper, in its order}")[0]
    labels = [section.index(f"\\item[({n})] $") for n in (1, 8, 10, 11, 13, 14, 17, 18, 19, 20)]
    assert labels == sorted(labels)
    assert "The closed loop and its energies" not in text.split("The paper, in its order")[1]
    assert section.count("Terms that cancel in pairs: (1) and (") == 6


def test_terms_that_cancel_are_named_by_their_numbers(claims):
    walks = [walk for claim in claims for walk in claim.walks]
    assert len(walks) == 6
    for walk in walks:
        pairs = proof_report.cancelling(walk)
        assert [(walk.after[one - 1], walk.after[other - 1]) for one, other in pairs] == list(walk.pairs)
        assert len({number for pair in pairs for number in pair}) == 2 * len(walk.pairs)


@pytest.mark.needs("latex")
@pytest.mark.parametrize("hostile", [False, True])
def test_latex_compiles(claims, hostile_claims, tmp_path, hostile):
    proof_report.write_documents(hostile_claims if hostile else claims, tmp_path)
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "proof_article.tex"],
        cwd=tmp_path, capture_output=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-2000:].decode(errors="replace")
    assert (tmp_path / "proof_article.pdf").stat().st_size > 20_000
    assert "Overfull" not in (tmp_path / "proof_article.log").read_text(encoding="latin-1")


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
