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
    from ..reports.proof.documents import write_documents
    from ..verify.proof import prove

    if folder is not None:
        check_folder(folder)
    claims = list(prove(fleet))
    printer.say(sentence(claims))
    for claim in claims:
        if printer.verbose or (claim.status.name in FALSE_OR_OPEN and not brief):
            printer.say(f"  {claim.status.name:9} {claim.source}: {claim.reason}")
    if folder is not None:
        write_documents(claims, folder)
        write_witness_figures(folder / "figures")
        printer.say(f"proof report: {folder / 'proof.html'}")
    return claims


def sentence(claims: Sequence[Claim]) -> str:
    """The verdict, and the number of false statements."""
    counts = Counter(claim.status.name for claim in claims)
    proved = "proved" if theorem_holds(claims) else "NOT proved"
    undecided = f", {counts['OPEN']} open" if counts["OPEN"] else ""
    return (
        f"the corrected theorem is {proved}: {len(claims)} claims checked, {counts['PROVED']} proved, "
        f"{counts['CITED']} cited{undecided}; of the statements that the paper prints {counts['REFUTED']} are "
        f"refuted and {counts['CORRECTED']} corrected"
    )


def theorem_holds(claims: Sequence[Claim]) -> bool:
    """Whether the corrected theorem is proved."""
    from ..verify.proof import theorem_proved

    return theorem_proved(claims)
