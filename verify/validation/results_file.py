"""Results as they come: one line of JSON each, appended and flushed, so that a broken run goes on where it stopped."""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any

from ...models.errors import InputError


class Ledger:
    """The file `validation-KEY.jsonl`: a line that says what was asked, then one line for every start that is done.

    KEY is the digest of the question: another fleet, other gains or another seed have another file.
    """

    def __init__(self, folder: Path, key: str, question: dict[str, Any]) -> None:
        """Read what is there; cut off a line that a killed run left unfinished."""
        self.path = folder / f"validation-{key}.jsonl"
        self.done: dict[int, dict[str, Any]] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            whole = self._read(question)
            # Only this process writes here, and one line at a time.
            self._file = self.path.open("r+b" if whole else "wb", buffering=0)
            self._file.truncate(whole)
            self._file.seek(whole)
        except OSError as error:
            raise InputError(f"{self.path}: cannot be written: {error.strerror}; choose another folder") from None
        if not whole:
            try:
                self._line(question)
            except InputError:
                self.path.unlink()
                raise

    def _read(self, question: dict[str, Any]) -> int:
        """Take over the finished lines; the number of bytes that they fill."""
        data = self.path.read_bytes() if self.path.exists() else b""
        whole = data.rfind(b"\n") + 1
        lines = data[:whole].splitlines()
        if not lines:
            return 0
        try:
            asked, *results = map(json.loads, lines)
            self.done = {int(result["start"]): result for result in results}
        except (ValueError, KeyError, TypeError):
            raise InputError(f"{self.path}: is damaged; remove it to begin anew") from None
        if asked != json.loads(json.dumps(question)):
            raise InputError(f"{self.path}: answers another question; remove it or choose another folder")
        return whole

    def add(self, result: dict[str, Any]) -> None:
        """Store one result for good."""
        self.done[int(result["start"])] = result
        self._line(result)

    def _line(self, content: dict[str, Any]) -> None:
        left = json.dumps(content, allow_nan=False).encode() + b"\n"
        try:
            while left:  # not buffered: what a killed process has written stays; a power cut may cost some starts
                left = left[self._file.write(left) :]
        except OSError as error:
            raise InputError(
                f"{self.path}: cannot be written: {error.strerror}; free some space and run again: it goes on from here"
            ) from None

    def __enter__(self) -> Ledger:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.fsync(self._file.fileno())
        self._file.close()
