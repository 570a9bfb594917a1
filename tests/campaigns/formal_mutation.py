"""The formal proof mutated: `python -m tests.campaigns.formal_mutation [--file NAME]`, from the repository's root.

A mutant is the sources of `verify/formal` in which the proof of one lemma is empty, or in which one hypothesis of the
theorem, (A1) to (A3) of `Statement.v`, is `True`. Coq must refuse it: a hypothesis that no proof uses does not belong
into the statement. Exit code 1 if a mutant compiles.

An empty proof is compiled in its own file, on top of the unchanged others; a missing hypothesis in all that lead to
the claims, without the paper's fleet, whose proofs only show that the hypotheses hold.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from gaincert.verify.formal.check import NotProvedError, compiled, sources

LEMMA = re.compile(r"^(?:Lemma|Theorem) (\w+).*?Proof\.(.*?)Qed\.", re.MULTILINE | re.DOTALL)
PROVED = ("Theorem", "Existence", "Uniqueness", "TorqueSharp", "NotExponential")
# Every condition of (A1) to (A3), as Statement.v has it.
HYPOTHESES = (
    "a F i j = a F j i",
    "0 <= a F i j",
    "0 <= al F i",
    "0 < sum (N F) (fun i => if S i then\n"
    "           al F i + sum (N F) (fun j => if S j then 0 else a F i j) else 0)",
    "0 < ls F", "0 < rs F", "0 < m F i", "0 < J F i", "0 < wr F i", "0 < arm F i", "0 < pv F i", "0 < dv F i",
    "0 < pw F i", "0 < dw F i", "0 < k F i", "0 < ss F i", "0 < ws F i",
    "0 < T F",
    "0 < mu F",
    "is_derive (psi F i) t (dpsi F i t)",
    "is_derive (dpsi F i) t (ddpsi F i t)",
    "Rabs (psi F i t) <= psi0 F",
    "Rabs (dpsi F i t) <= psi1 F",
    "Rabs (ddpsi F i t) <= psi2 F",
    "mu F <= RInt (fun s => (dpsi F i s) ^ 2) t (t + T F)",
)  # fmt: skip


def without_proof(text: str) -> Iterator[tuple[str, str]]:
    """(lemma, the text with that lemma's proof left empty) for every lemma."""
    for found in LEMMA.finditer(text):
        yield found[1], text[: found.start(2)] + " " + text[found.end(2) :]


def without_hypothesis(statement: str) -> Iterator[tuple[str, str]]:
    """(hypothesis, the statement with True in its place) for every hypothesis."""
    start, end = statement.index("(** ** Hypotheses *)"), statement.index("(** ** Conclusions *)")
    for hypothesis in HYPOTHESES:
        assert statement.count(hypothesis, start, end) == 1, hypothesis
        place = statement.index(hypothesis, start)
        yield hypothesis, statement[:place] + "True" + statement[place + len(hypothesis) :]


def file_survives(unchanged: Path, name: str, text: str) -> bool:
    """Whether a changed file compiles beside the others."""
    with tempfile.TemporaryDirectory() as temporary:
        path = Path(temporary) / f"{name}.v"
        path.write_text(text)
        command = ["coqc", "-q", "-R", temporary, "Mutant", "-Q", str(unchanged), "Gaincert", str(path)]
        return subprocess.run(command, cwd=temporary, capture_output=True, check=False).returncode == 0


def claims_survive(statement: str) -> bool:
    """Whether the theorem and what is stated beside it compile from a changed statement."""
    texts = {name: text for name, text in sources().items() if not name.startswith(("Paper", "Constant", "Numerics"))}
    texts |= {"Statement": statement, "Claims": f"Require {' '.join(f'Gaincert.{name}' for name in PROVED)}."}
    with tempfile.TemporaryDirectory() as temporary:
        try:
            compiled(texts, Path(temporary))
        except NotProvedError:
            return False
    return True


def mutants(unchanged: Path, chosen: Mapping[str, str]) -> Iterator[tuple[str, Callable[[], bool]]]:
    """(what is changed, whether it compiles) for every mutant; what is unchanged has to compile."""
    for name, text in chosen.items():
        assert file_survives(unchanged, name, text), f"{name}.v does not compile as it is"
        for lemma, changed in without_proof(text):
            yield f"{name}.v: {lemma}", partial(file_survives, unchanged, name, changed)
        if name == "Statement":
            assert claims_survive(text), "the claims do not compile as they are"
            for hypothesis, changed in without_hypothesis(text):
                yield f"without {hypothesis}", partial(claims_survive, changed)


def main() -> int:
    """Print what survives; 1 if anything does."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--file", help="only the lemmas of this file, such as Window; Statement: the hypotheses")
    options = parser.parse_args()
    texts = sources()
    chosen = {name: text for name, text in texts.items() if options.file in (None, name)}
    if not chosen:
        parser.error(f"no file {options.file}; there are {', '.join(texts)}")
    with tempfile.TemporaryDirectory() as temporary, ThreadPoolExecutor(os.cpu_count()) as pool:
        compiled(texts, Path(temporary))
        waiting = [(place, pool.submit(survives)) for place, survives in mutants(Path(temporary), chosen)]
        survivors = [place for place, future in waiting if future.result()]
    for place in survivors:
        print(f"survives: {place}")
    left_out = sum(place.startswith("without ") for place, _ in waiting)
    print(f"{len(waiting) - left_out} lemmas without their proof, {left_out} hypotheses left out", end=": ")
    print(f"{len(survivors)} compile")
    return int(bool(survivors))


if __name__ == "__main__":
    sys.exit(main())
