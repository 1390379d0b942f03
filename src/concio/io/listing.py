"""The list of what is concio's in a directory, ``concio.json``: names of files with their checksums."""

from __future__ import annotations

import hashlib
import json
import os
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import concio

CONTENTS = "concio.json"
FORMAT, VERSION = "concio contents", 1
LARGEST_LIST = 50_000_000
"""A longer list of contents is not believed [bytes]."""


@dataclass(frozen=True)
class Listing:
    """What a directory says of its files.

    Parameters
    ----------
    files : dict of str to str
        Files of concio with their checksums.
    before : dict of str to str
        Those that they are taking the place of; empty unless files are on the move.
    swap : str
        Name of the hidden directory that new files come from; empty unless files are on the move.
    """

    files: dict[str, str] = field(default_factory=dict)
    before: dict[str, str] = field(default_factory=dict)
    swap: str = ""

    def own(self, name: str, checksum: str) -> bool:
        """Tell whether a file of that content is concio's: as it was, or as it will be."""
        return bool(checksum) and checksum in (self.files.get(name), self.before.get(name))

    @property
    def names(self) -> set[str]:
        """All names that are listed."""
        return {*self.files, *self.before}


def read_list(root: Path) -> Listing | None:
    """Return the list of a directory, None where it has none that can be believed."""
    path = root / CONTENTS
    try:
        if path.is_symlink() or not path.is_file() or path.stat().st_size > LARGEST_LIST:
            return None
        data = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError, FileNotFoundError):
        return None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        return None
    files, before = _names(data.get("files")), _names(data.get("before", {}))
    swap = data.get("swap", "")
    if files is None or before is None or not isinstance(swap, str) or "/" in swap or "\\" in swap:
        return None
    return Listing(files, before, swap)


def _names(told: Any) -> dict[str, str] | None:
    if not isinstance(told, dict) or not all(isinstance(k, str) and isinstance(v, str) for k, v in told.items()):
        return None
    return {name: checksum for name, checksum in told.items() if _is_inside(name)}


def _is_inside(name: str) -> bool:
    """Tell whether a name in a list is one of a file in the directory."""
    pure = PurePosixPath(name)
    return bool(name) and not pure.is_absolute() and ".." not in pure.parts and "\\" not in name and "\0" not in name


def write_list(root: Path, hidden: Path, listing: Listing) -> None:
    """Write the list of a directory, whole or not at all, by way of a hidden directory in it."""
    tree: dict[str, Any] = {"format": FORMAT, "format_version": VERSION, "concio": concio.__version__}
    tree["files"] = listing.files
    if listing.swap:
        tree |= {"before": listing.before, "swap": listing.swap}
    fresh = hidden / "list.json"
    with fresh.open("w", encoding="utf-8") as file:
        file.write(json.dumps(tree, indent=1) + "\n")
        file.flush()
        with suppress(OSError):
            os.fsync(file.fileno())
    fresh.replace(root / CONTENTS)


def checksum_of(path: Path) -> str:
    """Return the checksum of a file; empty for what is not a file, or is none any more."""
    if path.is_symlink() or not path.is_file():
        return ""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except FileNotFoundError:
        return ""
