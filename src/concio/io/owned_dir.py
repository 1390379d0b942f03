"""Directories that concio writes into, and what in them is its own.

What concio wrote is listed in ``concio.json``, with a checksum of each file::

    {"format": "concio contents", "format_version": 1, "concio": "0.1.0", "files": {"summary.json": "sha256..."}}

A later run into the same place replaces what is listed and unchanged, and keeps the rest. It refuses a directory that
holds other things and no such list, one whose listed files were changed by hand, and one in which something else has a
name that it needs.

Files are written into a hidden directory inside the wanted one and moved into place when all of them are complete; the
list goes first and comes last. An interruption leaves what was there before. A run that is killed leaves its hidden
directory, which the next run into that place removes.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import socket
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import concio
from concio.errors import ConcioError, InputError

CONTENTS = "concio.json"
FORMAT, VERSION = "concio contents", 1
LARGEST_LIST = 50_000_000
"""A longer list of contents is not believed [bytes]."""
FORGOTTEN = 86_400.0
"""Where processes cannot be asked whether they live, what they left is removed after a day [s]."""
_HIDDEN = re.compile(r"\.concio-(?P<host>.*)-(?P<pid>\d+)")


@dataclass(frozen=True)
class Place:
    """What is at a place where results are to go.

    Parameters
    ----------
    path : Path
        The directory itself, symbolic links followed; it need not exist.
    owned : tuple of str
        Files that concio wrote and nobody changed, relative.
    kept : tuple of str
        Other files, which stay.
    left : tuple of Path
        Hidden directories that killed runs left.
    """

    path: Path
    owned: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()
    left: tuple[Path, ...] = ()

    def notes(self) -> list[str]:
        """Return what a user should know about the place."""
        found = [f"removed {path}, which a run that was stopped had left" for path in self.left]
        if self.kept:
            names = ", ".join(self.kept[:5]) + (f" and {len(self.kept) - 5} more" if len(self.kept) > 5 else "")
            found.append(f"{self.path} holds files that concio did not write; they stay: {names}")
        return found


def look_at(directory: Path | str) -> Place:
    """Return what is at a place where results are to go; nothing is changed.

    Raises
    ------
    InputError
        It is no directory; it holds other things and no list of what is concio's, or something that concio wrote was
        changed since.
    """
    where = str(directory)
    path = Path(os.path.realpath(directory))
    if not path.exists():
        return Place(path)
    if not path.is_dir():
        msg = "this is a file; results need a directory"
        raise InputError(msg, where=where, hint="give another name")
    try:
        left = tuple(p for p in path.iterdir() if _forgotten(p))
        files = _files(path)
        listed = contents(path)
    except OSError as error:
        msg = f"the directory cannot be looked at: {error.strerror or error}"
        raise InputError(msg, where=where) from None
    if listed is None:
        if files:
            msg = "the directory holds other things than results of concio"
            hint = "give the name of a new or empty directory; nothing was changed"
            raise InputError(msg, where=where, hint=hint)
        return Place(path, left=left)
    own = [name for name in files if name in listed]
    changed = [name for name in own if _checksum(path / name) != listed[name]]
    if changed:
        names = ", ".join(changed[:5])
        msg = f"{names} {'was' if len(changed) == 1 else 'were'} changed since concio wrote the directory"
        raise InputError(msg, where=where, hint="move what you want to keep, or give another directory")
    return Place(path, tuple(own), tuple(name for name in files if name not in listed and name != CONTENTS), left)


@contextmanager
def owned_directory(directory: Path | str) -> Iterator[Path]:
    """Give a directory to write into; when all went well its files take the place of those that concio wrote before.

    Raises
    ------
    InputError
        As :func:`look_at`; or something that concio did not write has a name that is needed.
    ConcioError
        The files cannot be written, for instance because the disk is full; what was there is as it was.
    """
    place = look_at(directory)
    made: list[Path] = []
    hidden = place.path / f".concio-{_host()}-{os.getpid()}"
    try:
        made = _make(place.path)
        for left in (*place.left, hidden):
            shutil.rmtree(left, ignore_errors=True)
        hidden.mkdir()
        new = hidden / "new"
        new.mkdir()
        yield new
        _put_in_place(place, new, hidden, str(directory))
    except OSError as error:
        _clean(hidden, made)
        msg = f"the result cannot be written: {error.strerror or error}"
        hint = "choose another place; nothing was changed"
        raise ConcioError(msg, where=str(directory), hint=hint) from error
    except BaseException:
        _clean(hidden, made)
        raise
    shutil.rmtree(hidden, ignore_errors=True)


def contents(path: Path) -> dict[str, str] | None:
    """Return the files that concio wrote into a directory with their checksums, None where it has no list of them."""
    listing = path / CONTENTS
    if listing.is_symlink() or not listing.is_file() or listing.stat().st_size > LARGEST_LIST:
        return None
    try:
        data = json.loads(listing.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        return None
    files = data.get("files") if isinstance(data, dict) and data.get("format") == FORMAT else None
    if not isinstance(files, dict) or not all(isinstance(k, str) and isinstance(v, str) for k, v in files.items()):
        return None
    return {name: checksum for name, checksum in files.items() if _is_inside(name)}


def is_own(path: Path) -> bool:
    """Tell whether a file is one that concio wrote into a directory of its own, and nobody changed."""
    real = Path(os.path.realpath(path))
    listed = contents(real.parent)
    return listed is not None and real.is_file() and listed.get(real.name) == _checksum(real)


def add_own(directory: Path, paths: Sequence[Path]) -> None:
    """Add files to the list of a directory, where it has one: what is exported into a result goes when it goes."""
    root = Path(os.path.realpath(directory))
    listed = contents(root)
    if listed is None:
        return
    for path in paths:
        real = Path(os.path.realpath(path))
        if real.is_relative_to(root) and real.is_file():
            listed[real.relative_to(root).as_posix()] = _checksum(real)
    _write_list(root, listed)


def _is_inside(name: str) -> bool:
    """Tell whether a name in a list is one of a file in the directory."""
    pure = PurePosixPath(name)
    return bool(name) and not pure.is_absolute() and ".." not in pure.parts and "\\" not in name and "\0" not in name


def _files(path: Path) -> list[str]:
    """Return all files below a directory, relative, without those of hidden directories that runs left or write."""
    found = []
    for folder, folders, names in os.walk(path):
        here = Path(folder)
        if here == path:
            folders[:] = [name for name in folders if not _HIDDEN.fullmatch(name)]
        links = [name for name in folders if (here / name).is_symlink()]
        found += [(here / name).relative_to(path).as_posix() for name in (*names, *links)]
        if here != path and not folders and not names:
            found.append(here.relative_to(path).as_posix() + "/")
    return sorted(found)


def _forgotten(path: Path) -> bool:
    """Tell whether a path is the hidden directory of a run that is over."""
    match = _HIDDEN.fullmatch(path.name)
    if match is None or path.is_symlink() or not path.is_dir():
        return False
    old = time.time() - path.stat().st_mtime > FORGOTTEN
    if os.name != "posix" or match["host"] != _host():
        return old
    try:
        os.kill(int(match["pid"]), 0)
    except (ProcessLookupError, OverflowError):
        return True
    except OSError:
        return False
    return int(match["pid"]) == os.getpid()


def _host() -> str:
    return re.sub(r"[^A-Za-z0-9]", "", socket.gethostname())[:40]


def _checksum(path: Path) -> str:
    if path.is_symlink() or not path.is_file():
        return ""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _make(path: Path) -> list[Path]:
    """Make a directory with its parents; return those that were made, the innermost first."""
    missing = [p for p in (path, *path.parents) if not p.exists()]
    path.mkdir(parents=True, exist_ok=True)
    return missing


def _clean(hidden: Path, made: Sequence[Path]) -> None:
    shutil.rmtree(hidden, ignore_errors=True)
    with suppress(OSError):
        for path in made:
            path.rmdir()


def _write_list(path: Path, files: Mapping[str, str]) -> None:
    tree = {"format": FORMAT, "format_version": VERSION, "concio": concio.__version__, "files": dict(files)}
    fresh = path / f"{CONTENTS}.{os.getpid()}"
    fresh.write_text(json.dumps(tree, indent=1) + "\n", encoding="utf-8")
    fresh.replace(path / CONTENTS)


def _put_in_place(place: Place, new: Path, hidden: Path, where: str) -> None:
    """Move what concio wrote before out of the way and the new files into place; undo all of it where one fails."""
    root = place.path
    names = sorted(p.relative_to(new).as_posix() for p in new.rglob("*") if p.is_file())
    listed = {name: _checksum(new / name) for name in names}
    own = set(place.owned)
    for name in names:
        in_the_way = [p for p in (root / name, *(root / name).parents) if p.is_relative_to(root) and p != root]
        for p in in_the_way:
            folder = p != root / name
            if os.path.lexists(p) and p.relative_to(root).as_posix() not in own and not (folder and _is_folder(p)):
                msg = f"'{p.relative_to(root)}' is in the way, which concio did not write"
                raise InputError(msg, where=where, hint="move it, or give another directory")
    done: list[tuple[Path, Path]] = []
    try:
        for name in place.owned:
            _move(root / name, hidden / "old" / name, done)
        for name in names:
            _move(new / name, root / name, done)
        _write_list(root, listed)
    except BaseException:
        for start, end in reversed(done):
            with suppress(OSError):
                end.rename(start)
        raise
    for emptied in sorted({p for name in place.owned for p in (root / name).parents}, reverse=True):
        if emptied.is_relative_to(root) and emptied != root:
            with suppress(OSError):
                emptied.rmdir()


def _is_folder(path: Path) -> bool:
    return path.is_dir() and not path.is_symlink()


def _move(start: Path, end: Path, done: list[tuple[Path, Path]]) -> None:
    end.parent.mkdir(parents=True, exist_ok=True)
    start.rename(end)
    done.append((start, end))
