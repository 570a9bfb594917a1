"""The results file: one line of JSON per finished start, so that a stopped validation can continue."""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any

from ...models.errors import GaincertError, InputError, write_error
from .start_result import StartResult


class ResultsFile:
    """The file `validation-KEY.jsonl`: first the specification of the validation, then one line per finished start.

    KEY is the digest of the specification: every fleet, set of gains and seed has its own file.
    """

    def __init__(self, folder: Path, key: str, specification: dict[str, Any]) -> None:
        """Read the finished lines; remove an unfinished last line. Raises InputError."""
        self.path = folder / f"validation-{key}.jsonl"
        self.done: dict[int, StartResult] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            whole = self._read(specification)
            # Only this process writes here, and one line at a time.
            self._file = self.path.open("r+b" if whole else "wb", buffering=0)
            self._file.truncate(whole)
            self._file.seek(whole)
        except OSError as error:
            raise write_error(self.path, error, "choose another folder") from None
        if not whole:
            try:
                self._line(specification)
            except GaincertError:
                self.path.unlink()
                raise

    def _read(self, specification: dict[str, Any]) -> int:
        """Read the finished lines. Returns the number of their bytes."""
        data = self.path.read_bytes() if self.path.exists() else b""
        whole = data.rfind(b"\n") + 1
        lines = data[:whole].splitlines()
        if not lines:
            return 0
        try:
            stored, *results = map(json.loads, lines)
            if stored == json.loads(json.dumps(specification)):
                self.done = {result.start: result for result in map(StartResult.from_json, results)}
        except (ValueError, KeyError, TypeError, AttributeError):
            raise InputError(f"{self.path}: is damaged; remove it to begin again") from None
        if stored != json.loads(json.dumps(specification)):
            raise InputError(f"{self.path}: belongs to another validation; remove it or choose another folder")
        return whole

    def add(self, result: StartResult) -> None:
        """Store one result."""
        self.done[result.start] = result
        self._line(result.to_json())

    def _line(self, content: dict[str, Any]) -> None:
        left = json.dumps(content, allow_nan=False).encode() + b"\n"
        try:
            while left:  # not buffered: finished starts survive a kill; a power cut may lose some
                left = left[self._file.write(left) :]
        except OSError as error:
            raise write_error(self.path, error, "choose another folder") from None

    def __enter__(self) -> ResultsFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.fsync(self._file.fileno())
        self._file.close()
