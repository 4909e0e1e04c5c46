"""Writes files that are whole or absent, whatever interrupts the writing."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from vista.errors import InputError


def unwritable(path: Path, error: OSError) -> InputError:
    """What to raise for a file or folder that the system does not let us write."""
    return InputError(path, f"cannot be written: {(error.strerror or str(error)).lower()}")


def make_folder(path: Path) -> None:
    """Makes the folder and the folders above it. Raises InputError when that cannot be done."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from None


def check_replaceable(path: Path) -> None:
    """Raises InputError where a rename would put a file in the place of a folder, a device or a pipe."""
    try:
        if path.exists() and not path.is_file():
            raise InputError(path, "cannot be written: it exists and is no file")
    except OSError as error:
        raise unwritable(path, error) from None


def write_atomically(path: Path, data: bytes | str) -> None:
    """Writes beside the target, then renames. Raises InputError when the target cannot be written."""
    check_replaceable(path)
    content = data.encode(errors="replace") if isinstance(data, str) else data
    temporary = None
    try:
        descriptor, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
            os.fchmod(stream.fileno(), 0o666 & ~_umask())
        Path(temporary).replace(path)
        temporary = None
    except OSError as error:
        raise unwritable(path, error) from None
    finally:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)


class LineFile:
    """A text file of whole lines: each line goes to the file in one piece, or not at all."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._stream = path.open("wb", buffering=0)
        except OSError as error:
            raise unwritable(path, error) from None
        self._whole_bytes = 0

    def write_line(self, line: str) -> None:
        data = line.encode() + b"\n"
        try:
            written = self._stream.write(data)
            if written != len(data):
                raise OSError(None, "disk full")
        except OSError as error:
            self._stream.truncate(self._whole_bytes)
            raise unwritable(self._path, error) from None
        self._whole_bytes += len(data)

    def close(self) -> None:
        self._stream.close()


def _umask() -> int:
    mask = os.umask(0)  # there is no way to ask without setting
    os.umask(mask)
    return mask
