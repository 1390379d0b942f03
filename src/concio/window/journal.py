"""The journal of a document: every change, on the disk before it is shown; and the lock that lets one window write.

Both are in a hidden folder beside the file, ``.wall.toml.window`` for ``wall.toml``. The journal is a list of JSON
lines to which lines are only added: the text at the beginning, then each change. A line that a killed process left
half written is the last one, and is ignored. The lock is the system's: it goes when the process dies, however it dies.
"""

from __future__ import annotations

import hashlib
import json
import os
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from concio.errors import InputError

FORMAT = 1
LARGEST = 50_000_000
"""A journal of more bytes is begun again at the next opening; its history is then that of the file alone."""


def folder_of(file: Path) -> Path:
    """Return the hidden folder in which a window keeps the journal, the lock and the results of a file."""
    return file.with_name(f".{file.name}.window")


def hash_of(text: str) -> str:
    """Return the hash of a text by which results are kept."""
    return hashlib.sha256(text.encode("utf-8")).hexdigest()[:32]


class Lock:
    """The lock of a document: held by the one window that may write.

    Parameters
    ----------
    folder : Path
        The hidden folder of the document; it is made where it is missing.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / "lock"
        self._file: BinaryIO | None = None

    def take(self) -> bool:
        """Take the lock where nobody has it; return whether it is held."""
        self._path.parent.mkdir(mode=0o700, exist_ok=True)
        file = self._path.open("a+b")
        try:
            _system_lock(file)
        except OSError:
            file.close()
            return False
        self._file = file
        return True

    def release(self) -> None:
        """Give the lock back."""
        if self._file is not None:
            self._file.close()
            self._file = None


def _system_lock(file: BinaryIO) -> None:
    try:
        import fcntl
    except ImportError:  # Windows
        import msvcrt

        file.seek(0)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        return
    fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)


class Journal:
    """The list of changes of a document.

    Parameters
    ----------
    folder : Path
        The hidden folder of the document.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / "journal.jsonl"
        self._file: BinaryIO | None = None

    def read(self) -> list[dict[str, Any]]:
        """Return the entries there are, the beginning first; none where there is no journal that can be read."""
        try:
            if self.path.stat().st_size > LARGEST:
                return []
            raw = self.path.read_bytes()
        except OSError:
            return []
        entries: list[dict[str, Any]] = []
        for line in raw.split(b"\n"):
            try:
                entry = json.loads(line)
            except ValueError:
                break
            if not isinstance(entry, dict):
                break
            entries.append(entry)
        if not entries or entries[0].get("format") != FORMAT or not isinstance(entries[0].get("text"), str):
            return []
        return entries

    def begin(self, text: str) -> None:
        """Begin again with a text.

        Raises
        ------
        InputError
            The journal cannot be written.
        """
        self.close()
        try:
            self.path.parent.mkdir(mode=0o700, exist_ok=True)
            fresh = self.path.with_suffix(".new")
            fresh.write_bytes(_line({"format": FORMAT, "text": text}))
            fresh.replace(self.path)
            self._open()
        except OSError as error:
            raise self._fault(error) from None

    def go_on(self, entries: int) -> None:
        """Go on after the entries that were read; a line that was left half written is cut off first."""
        try:
            raw = self.path.read_bytes().split(b"\n")
            whole = b"\n".join(raw[:entries]) + b"\n"
            with self.path.open("r+b") as file:
                file.truncate(len(whole))
                file.seek(len(whole) - 1)
                file.write(b"\n")
            self._open()
        except OSError as error:
            raise self._fault(error) from None

    def add(self, entry: dict[str, Any]) -> None:
        """Add an entry; it is on the disk when this returns.

        Raises
        ------
        InputError
            It cannot be written.
        """
        assert self._file is not None
        try:
            self._file.write(_line(entry))
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise self._fault(error) from None

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            with suppress(OSError):
                self._file.close()
            self._file = None

    def _open(self) -> None:
        self._file = self.path.open("ab")

    def _fault(self, error: OSError) -> InputError:
        msg = f"changes cannot be kept: {error.strerror or error}"
        return InputError(msg, where=str(self.path), hint="make room on the disk, or allow writing there")


def _line(entry: dict[str, Any]) -> bytes:
    return json.dumps(entry, ensure_ascii=False).encode("utf-8") + b"\n"
