"""`gaincert prove`: the symbolic proof check and its report."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from .inputs import check_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..console import Printer
    from ..models.fleet import Fleet
    from ..verify.proof.claim import Claim

FALSE_OR_OPEN = ("REFUTED", "CORRECTED", "OPEN")  # statuses that are listed without --verbose


def prove_claims(printer: Printer, fleet: Fleet | None, folder: Path | None, *, brief: bool = False) -> list[Claim]:
    """Check all claims, and write the proof report into the folder if there is one; `brief` lists no claims."""
    from ..reports.figures.witnesses import write_witness_figures
    from ..reports.proof.documents import in_order, summary_line, write_documents
    from ..verify.proof import prove

    if folder is not None:
        check_folder(folder)
    claims = in_order(prove(fleet))
    printer.say(sentence(claims))
    for claim in claims:
        if printer.verbose or (claim.status.name in FALSE_OR_OPEN and not brief):
            printer.say(f"  {summary_line(claim)}")
    if folder is not None:
        write_documents(claims, folder)
        write_witness_figures(folder / "figures")
        printer.say(f"proof report: {folder / 'proof.html'}")
    return claims


def sentence(claims: Sequence[Claim]) -> str:
    """The verdict, and the number of false statements."""
    counts = Counter(claim.status.name for claim in claims)
    paper = Counter(claim.status.name for claim in claims if claim.kind.name == "PAPER")
    proved = "proved" if theorem_holds(claims) else "NOT proved"
    others = "".join(f", {counts[name]} {name.lower()}" for name in ("CITED", "OPEN") if counts[name])
    return (
        f"the corrected theorem is {proved}: {len(claims)} claims checked, {counts['PROVED']} proved, "
        f"{counts['FORMAL']} formal{others}; of the statements that the paper prints {paper['REFUTED']} are "
        f"refuted and {paper['CORRECTED']} corrected"
    )


def check_formally(printer: Printer) -> bool:
    """Compile the machine-checked theorem and keep the record; False where that fails."""
    from ..models.files.text import write_text
    from ..verify.formal import check
    from ..verify.proof.formal import development

    printer.say("compiling verify/formal: about a minute")
    try:
        record = check.check()
    except check.MissingToolError as error:
        printer.say(*str(error).splitlines(), "the record of the last check is used instead")
        return True
    except check.NotProvedError as error:
        printer.say(*f"verify/formal is not proved: {error}".splitlines())
        return False
    write_text(check.RECORD, check.as_text(record))
    if found := development().record:
        printer.say(*(f"  {name}: {', '.join(axioms) or 'no axioms'}" for name, axioms in found.theorems.items()))
        printer.say(f"proved with Coq {found.coq}, sources {found.digest}")
    return True


def theorem_holds(claims: Sequence[Claim]) -> bool:
    """Whether the corrected theorem is proved."""
    from ..verify.proof import theorem_proved

    return theorem_proved(claims)
