"""The folder of a window: names that the page gives stay in it, and so do the files that a model names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from concio.errors import InputError

SOLIDS = (".obj", ".ply", ".stl", ".off", ".ifc", ".3dm")
PICTURES = (".png", ".jpg", ".jpeg", ".tif", ".tiff")
SUFFIXES = (".toml", ".dxf", *SOLIDS, *PICTURES)
"""Files that can be opened or dropped."""
FILE_KEYS = ("blocks_file", "solids_file", "file", "code", "record", "vertical")
"""Keys of a model file whose texts may be names of files."""
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
LONGEST_NAME = 120


def named(folder: Path, name: object) -> Path:
    """Return the file of a name that the page gives: in the folder itself, of a kind that can be opened.

    Raises
    ------
    InputError
        The name leads elsewhere, is hidden, or is not that of a model or a drawing.
    """
    plain = name if isinstance(name, str) else ""
    sound = (
        plain == plain.strip() != "" and len(plain) <= LONGEST_NAME and plain.isprintable()
        and PurePosixPath(plain).name == plain == PureWindowsPath(plain).name and not plain.startswith(".")
        and not RESERVED.fullmatch(plain) and not set(plain) & set('<>:"|?*')
    )  # fmt: skip
    if not sound:
        msg = f"{str(name)[:60]!r} is not the name of a file in the folder of this window"
        raise InputError(msg, hint="give a name without slashes, such as wall.toml")
    path = folder / plain
    if path.suffix.lower() not in SUFFIXES:
        msg = f"'{plain}' is neither a model file, nor a drawing, solids or a picture"
        raise InputError(msg, hint="names end in " + ", ".join(SUFFIXES))
    if not inside(folder, path):
        msg = f"'{plain}' leads out of the folder of this window"
        raise InputError(msg, hint="copy the file into the folder")
    return path


def inside(folder: Path, path: Path) -> bool:
    """Return whether a path, with its symbolic links followed, is in a folder."""
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):
        return False


def check_files(data: Any, base: Path, folder: Path) -> None:
    """Raise where the tables of a model file name a file outside the folder of the window.

    Raises
    ------
    InputError
        A file is outside.
    """
    for key, name in _names(data):
        if (key != "code" or name.endswith(".toml")) and not inside(folder, base / name):
            msg = f"{key} = '{name[:80]}' is outside the folder of this window"
            hint = f"start the window with that folder too: concio window FILE --folder {folder.parent}"
            raise InputError(msg, hint=hint)


def _names(data: Any, key: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(data, dict):
        for name, value in data.items():
            yield from _names(value, name)
    elif isinstance(data, list):
        for value in data:
            yield from _names(value, key)
    elif isinstance(data, str) and key in FILE_KEYS:
        yield key, data
