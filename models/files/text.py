"""Text files: read with a bound on their size, written whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from ..errors import InputError, write_error


def read_text(path: Path, max_bytes: int) -> str:
    """The text of a UTF-8 file of bounded size. Raises InputError."""
    try:
        with path.open("rb") as file:
            data = file.read(max_bytes + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError:
        raise InputError(f"{path}: cannot be read: the name of a file holds no NUL character") from None
    if len(data) > max_bytes:
        raise InputError(f"{path}: is larger than {max_bytes // 2**20} MiB; put large fleets into CSV tables")
    try:
        return data.decode("utf-8-sig")  # spreadsheets write a byte order mark
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not UTF-8 text") from None


def write_whole(path: Path, write: Callable[[IO[bytes]], Any]) -> Path:
    """Let `write` fill a temporary file beside `path`, then rename it. Raises InputError or FaultError."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise write_error(path, error, "choose another output folder") from None
    try:
        with os.fdopen(handle, "wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        Path(temporary).chmod(0o666 & ~_umask())
        Path(temporary).replace(path)
    except OSError as error:
        raise write_error(path, error, "choose another output folder") from None
    finally:
        Path(temporary).unlink(missing_ok=True)
    return path


def check_writable(folder: Path) -> None:
    """Raise InputError or FaultError if no file can be written into a folder; what it creates is removed again."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    if files := [path for path in (folder, *folder.parents) if path.is_file()]:
        raise InputError(f"{folder}: cannot be written: {files[0]} is a file, not a folder; choose another folder")
    try:
        write_whole(folder / ".gaincert-try", lambda _file: None).unlink()
    finally:
        for path in missing:
            with suppress(OSError):  # it was not created, or is in use
                path.rmdir()


def write_text(path: Path, text: str) -> Path:
    """Write UTF-8 text, whole or not at all."""
    return write_whole(path, lambda file: file.write(text.encode()))


def write_json(path: Path, content: Any) -> Path:
    """Write a JSON document, whole or not at all; NaN and infinities are refused."""
    return write_text(path, json.dumps(content, indent=1, allow_nan=False) + "\n")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
