"""A certificate: the document, the kernel's verdict on it, and what it holds as exact numbers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from ...models.arrays import Array, column
from ...models.errors import InputError
from ...models.excitation import Excitation
from ...models.files.text import write_text
from ...models.fleet import Fleet
from ...models.fleet_content import excitation_of, numbers_of
from ...models.fleet_tables import Links
from ...models.gains import GAIN_NAMES, Gains
from ...models.html_table import html_table
from ...models.saturation import SCALE_NAMES, Saturation
from .. import kernel
from .repair import Violation


@dataclass(frozen=True, eq=False)
class Certificate:
    """What `gaincert certify` found: a document for the kernel where all holds, a diagnosis where it does not."""

    content: dict[str, Any]  # the JSON document, docs/certificate.md
    verdict: kernel.Verdict  # the kernel's word on that document
    violations: tuple[Violation, ...] = ()
    notes: tuple[str, ...] = ()  # facts of interest that the certificate does not claim
    file_digest: str | None = None  # SHA-256 of the file that it was read from

    def __repr__(self) -> str:
        found = "VALID" if self.valid else f"INVALID: {self._failures[0]}"
        vehicles = self.content["fleet"]["vehicles"]
        return f"Certificate({found}; conditions {self.conditions}, {vehicles} vehicles)"

    def _repr_html_(self) -> str:
        lines = self.facts if self.valid else self._failures
        return html_table(repr(self), ["what is proved" if self.valid else "what fails"], [[line] for line in lines])

    @property
    def _failures(self) -> list[str]:
        """The broken conditions, or the rule that the kernel found broken."""
        return list(map(str, self.violations)) or [f"{self.verdict.rule}: {self.verdict.reason}"]

    @property
    def valid(self) -> bool:
        """Whether the kernel accepts the document."""
        return self.verdict.valid

    @property
    def facts(self) -> tuple[str, ...]:
        """What the certificate proves, in sentences."""
        return self.verdict.theorem

    @property
    def conditions(self) -> str:
        """The condition set."""
        return str(self.content["conditions"])

    @property
    def gains(self) -> Gains:
        """The certified gains and scales, exact."""
        table = self.content["gains"]
        scales = {name: column(numbers_of(table[f"{name}_scale"])) for name in SCALE_NAMES}
        network = {name: scales[name][0] for name in ("position", "heading")}
        gains = {name: column(numbers_of(table[name])) for name in GAIN_NAMES}
        return Gains(**gains, saturation=Saturation(**{**scales, **network}))

    @property
    def excitation(self) -> Excitation:
        """The certified psi, exact."""
        return excitation_of(self.content["designed"]["excitation"] or self.content["fleet"]["excitation"])

    @property
    def margins(self) -> dict[str, Array]:
        """By condition, the stated margin of each vehicle, (N,); None where it has no such limit."""
        limits = self.content["fleet"]["limits"]
        found = {}
        for name, text in self.content["margins"].items():
            stated: list[Fraction | None] = list(numbers_of(text))
            if name in limits:
                asked = dict(zip(map(int, limits[name]["vehicle"].split()), stated, strict=True))
                stated = [asked.get(i) for i in range(self.content["fleet"]["vehicles"])]
            found[name] = column(stated)
        return found

    @property
    def rates(self) -> Mapping[str, Fraction | None]:
        """gamma_omega and gamma_v, 1/s, None where none was found."""
        return {name: stated and Fraction(stated["rate"]) for name, stated in self.content["rates"].items()}

    def links(self, fleet: Fleet) -> Links | None:
        """The designed links of the certificate's own fleet; None where its weights were not designed."""
        weights = self.content["designed"]["weights"]
        if weights is None:
            return None
        own = self.content["fleet"]
        tails, heads = (map(int, own["edges"][end].split()) for end in ("tail", "head"))
        edges = zip(tails, heads, numbers_of(weights["edges"]), strict=True)
        led = zip(map(int, own["leader_links"]["vehicle"].split()), numbers_of(weights["leader_links"]), strict=True)
        names = fleet.names
        return Links(
            edges=tuple((names[i], names[j], weight) for i, j, weight in edges if weight),
            leader_links={names[i]: weight for i, weight in led},
        )

    def to_json(self) -> str:
        """The document as JSON text."""
        return as_text(self.content)

    def write(self, path: str | Path) -> None:
        """Write the document, whole or not at all. Raises InputError where it is not valid: such a file would lie."""
        if not self.valid:
            raise InputError(*(map(str, self.violations) if self.violations else [str(self.verdict)]))
        write_text(Path(path), self.to_json())

    @classmethod
    def read(cls, path: str | Path, fleet: Fleet | None = None) -> Certificate:
        """The certificate in a file, checked by the kernel, against a fleet where one is given. Raises InputError.

        The file is read once, so that what was checked is what is used.
        """
        with readable(path):
            data = kernel.read(path)
            verdict = kernel.check_data(data, fleet.digest if fleet else None)
            return cls(kernel.load(data), verdict, file_digest="sha256:" + hashlib.sha256(data).hexdigest())


def as_text(content: dict[str, Any]) -> str:
    """A document as JSON text."""
    return json.dumps(content, indent=1) + "\n"


@contextmanager
def readable(path: str | Path) -> Iterator[None]:
    """Turns the kernel's refusal of a file into an InputError."""
    try:
        yield
    except kernel.UnreadableError as error:
        raise InputError(f"{path}: {error}; give a certificate.json that gaincert certify wrote") from None


def verify(path: str | Path, fleet: Fleet | None = None) -> kernel.Verdict:
    """The kernel's verdict on a certificate file, and that it is of this fleet. Raises InputError if unreadable."""
    with readable(path):
        return kernel.check_data(kernel.read(path), fleet.digest if fleet else None)
