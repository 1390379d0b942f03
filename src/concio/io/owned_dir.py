"""Directories that concio writes into, and what in them is its own.

What concio wrote is listed in ``concio.json``, with a checksum of each file::

    {"format": "concio contents", "format_version": 1, "concio": "0.1.0", "files": {"summary.json": "sha256..."}}

A later run into the same place replaces what is listed and unchanged, and keeps the rest. It refuses a directory that
holds other things and no such list, one whose listed files were changed by hand, and one in which something else has a
name that it needs.

Files are written into a hidden directory inside the wanted one (:mod:`concio.io.hidden_dir`) and take their place when
all of them are complete. Before the first file moves, the list says what is to come: the files that were there
(``before``), those that will be (``files``), and the hidden directory they come from (``swap``). Then the old files go
aside, the new ones come, and a list without these two words ends it. A fault on the way undoes all of it. A process
that is killed leaves the list that says what was to come: whoever looks next finds every listed file either as it was
or as it will be, and the next run into that place, or whoever reads from it, carries on from there. A new file never
replaces another: it is linked to its place, which fails where something is. A file that goes aside is compared with its
checksum once more there, so that one that was changed in the last moment goes back. Runs that write into one directory
at the same time put their files there one after the other.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from concio.errors import ConcioError, InputError
from concio.io.hidden_dir import hidden_directory, is_hidden, is_left, locked, remove
from concio.io.listing import CONTENTS, Listing, checksum_of, read_list, write_list


class UnfinishedError(Exception):
    """A fault that could not be undone: the hidden directory is kept, and the next run goes on from it."""


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
        It is not a directory; it holds other things and no list of what is concio's, or something that concio wrote was
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
        with locked(path, where):
            return _look(path, where)
    except OSError as error:
        msg = f"the directory cannot be read: {error.strerror or error}"
        raise InputError(msg, where=where) from None


def _look(path: Path, where: str) -> Place:
    left = tuple(p for p in path.iterdir() if is_left(p))
    files = _files(path)
    listing = read_list(path)
    if listing is None:
        if files:
            msg = "the directory holds other things than results of concio"
            hint = "give the name of a new or empty directory; nothing was changed"
            raise InputError(msg, where=where, hint=hint)
        return Place(path, left=left)
    own = [name for name in files if name in listing.names]
    changed = [name for name in own if not listing.own(name, checksum_of(path / name))]
    if changed:
        names = ", ".join(changed[:5])
        msg = f"{names} {'was' if len(changed) == 1 else 'were'} changed since concio wrote the directory"
        raise InputError(msg, where=where, hint="move what you want to keep, or give another directory")
    folders = {f"{p.as_posix()}/" for name in listing.names for p in Path(name).parents}  # emptied by a killed run
    kept = [name for name in files if name not in own and name != CONTENTS and name not in folders]
    return Place(path, tuple(own), tuple(kept), left)


@contextmanager
def owned_directory(directory: Path | str) -> Iterator[Path]:
    """Give a directory to write into; when all went well its files take the place of those that concio wrote before.

    Raises
    ------
    InputError
        As :func:`look_at`; or something that concio did not write has a name that is needed; or another run keeps the
        directory locked.
    ConcioError
        The files cannot be written, for instance because the disk is full; what was there is as it was.
    """
    place, where = look_at(directory), str(directory)
    missing = [p for p in (place.path, *place.path.parents) if not p.exists()]
    try:
        with hidden_directory(place.path) as hidden:
            try:
                with locked(place.path, where):
                    _clear(place.path)
                new = hidden / "new"
                new.mkdir()
                yield new
                with locked(place.path, where):
                    _clear(place.path)
                    _swap(place.path, hidden, where)
            except UnfinishedError:
                raise
            except BaseException:
                remove(hidden)
                _remove_made(missing)
                raise
            remove(hidden)
    except UnfinishedError as error:
        msg = f"the result cannot be written, and what was there could not be put back: {error}"
        raise ConcioError(msg, where=where, hint="the next run into this directory goes on from it") from error
    except OSError as error:
        msg = f"the result cannot be written: {error.strerror or error}"
        hint = "choose another place; nothing was changed"
        raise ConcioError(msg, where=where, hint=hint) from error


def settle(directory: Path | str) -> None:
    """End what a killed run had begun to move in a directory, before it is read; nothing where there is no such thing.

    Raises
    ------
    InputError
        Files are on the move and do not come to rest, or what was begun cannot be ended.
    """
    root, where = Path(os.path.realpath(directory)), str(directory)
    listing = read_list(root) if root.is_dir() else None
    if listing is None or not listing.swap:
        return
    hint = "make the directory writable, or run again into it"
    try:
        with locked(root, where):
            _finish(root)
    except OSError as error:
        msg = f"a run was killed while it put its files there, and they cannot be moved: {error.strerror or error}"
        raise InputError(msg, where=where, hint=hint) from None
    listing = read_list(root)
    if listing is not None and listing.swap:
        msg = "a run was killed while it put its files there: some are of another run"
        raise InputError(msg, where=where, hint=hint)


def contents(path: Path) -> dict[str, str] | None:
    """Return the files that concio wrote into a directory with their checksums, None where it has no list of them."""
    listing = read_list(path)
    return None if listing is None else {**listing.before, **listing.files}


def is_own(path: Path) -> bool:
    """Tell whether a file is one that concio wrote into a directory of its own, and nobody changed."""
    real = Path(os.path.realpath(path))
    listing = read_list(real.parent)
    return listing is not None and listing.own(real.name, checksum_of(real))


def add_own(directory: Path, paths: Sequence[Path], *, begin: bool = False) -> None:
    """Add files to the list of a directory: what is exported into a result goes when it goes.

    Parameters
    ----------
    directory : Path
    paths : sequence of Path
    begin : bool
        Whether a list is begun where there is none; otherwise nothing is done there.
    """
    root = Path(os.path.realpath(directory))
    if not begin and read_list(root) is None:
        return
    with hidden_directory(root) as hidden:
        with locked(root, str(directory)):
            _finish(root)
            listing = read_list(root) or Listing()
            for path in paths:
                real = Path(os.path.realpath(path))
                if real.is_relative_to(root) and real.is_file():
                    listing.files[real.relative_to(root).as_posix()] = checksum_of(real)
            write_list(root, hidden, listing)
        remove(hidden)


def _clear(root: Path) -> None:
    """End what killed runs had begun, and remove what they left; the caller holds the lock."""
    _finish(root)
    for path in root.iterdir():
        if is_left(path):
            remove(path)


def _remove_made(made: Sequence[Path]) -> None:
    """Remove directories that were made, the innermost first, as far as they are empty."""
    with suppress(OSError):
        for path in made:
            path.rmdir()


def _files(path: Path) -> list[str]:
    """Return all files below a directory, relative, without those of hidden directories that runs left or write."""
    found = []
    for folder, folders, names in os.walk(path):
        here = Path(folder)
        if here == path:
            folders[:] = [name for name in folders if not is_hidden(name)]
        links = [name for name in folders if (here / name).is_symlink()]
        found += [(here / name).relative_to(path).as_posix() for name in (*names, *links)]
        if here != path and not folders and not names:
            found.append(here.relative_to(path).as_posix() + "/")
    return sorted(found)


def _swap(root: Path, hidden: Path, where: str) -> None:
    """Put the files of ``hidden/new`` into ``root`` in place of those that concio wrote; the caller holds the lock.

    Raises
    ------
    InputError
        Something that concio did not write, or that was changed since, has a name that is needed; all is as it was.
    OSError
        A file cannot be moved; all is as it was.
    UnfinishedError
        Neither the swap nor its undoing could be ended.
    """
    new, listing = hidden / "new", read_list(root) or Listing()
    names = sorted(p.relative_to(new).as_posix() for p in new.rglob("*") if p.is_file())
    files = {name: checksum_of(new / name) for name in names}
    found = {name: checksum_of(root / name) for name in sorted(listing.names)}
    before = {name: checksum for name, checksum in found.items() if listing.own(name, checksum)}
    _check_way(root, names, set(before), where)
    done: list[tuple[Path, Path]] = []
    try:
        write_list(root, hidden, Listing(files, before, hidden.name))
        for name, checksum in before.items():
            _move(root / name, hidden / "old" / name, done)
            if checksum_of(hidden / "old" / name) != checksum:
                msg = f"{name} was changed while the run put its files there"
                raise InputError(msg, where=where, hint="move what you want to keep, or give another directory")
        _remove_empty(root, before)
        for name in names:
            try:
                _move(new / name, root / name, done)
            except (FileExistsError, NotADirectoryError):
                raise _in_the_way(Path(name), where) from None
        write_list(root, hidden, Listing(files))
    except BaseException as error:
        if not _undone(root, hidden, listing, done, names):
            raise UnfinishedError(str(error)) from error
        raise


def _finish(root: Path) -> None:
    """End a swap that was killed, as far as its files are there; the caller holds the lock."""
    listing = read_list(root)
    if listing is None or not listing.swap:
        return
    left = root / listing.swap
    if not is_hidden(left.name) or (left.exists() and not is_left(left)):
        return
    new = left / "new"
    done: list[tuple[Path, Path]] = []
    for name, checksum in listing.before.items():
        waiting = name not in listing.files or (new / name).is_file()
        if waiting and checksum_of(root / name) == checksum:
            try:
                _move(root / name, left / "old" / name, done)
            except FileExistsError:  # killed between its two steps
                (root / name).unlink()
    _remove_empty(root, listing.before)
    for name in listing.files:
        if (new / name).is_file():
            with suppress(OSError):  # what stands in the way by now is the user's, and stays
                _move(new / name, root / name, done)
    files = {name: c for name, c in listing.files.items() if checksum_of(root / name) == c}
    left.mkdir(exist_ok=True)
    write_list(root, left, Listing(files))
    remove(left)


def _check_way(root: Path, names: Iterable[str], own: set[str], where: str) -> None:
    """Raise where something that is not concio's has a name that is needed."""
    for name in names:
        way = [p for p in (root / name, *(root / name).parents) if p.is_relative_to(root) and p != root]
        for p in way:
            if p.is_dir() and not p.is_symlink() and (p != root / name or _is_own_folder(root, p, own)):
                continue
            if os.path.lexists(p) and p.relative_to(root).as_posix() not in own:
                raise _in_the_way(p.relative_to(root), where)


def _is_own_folder(root: Path, folder: Path, own: set[str]) -> bool:
    """Tell whether a folder holds files of concio's alone: it goes when they go."""
    held = list(folder.rglob("*"))
    return all(p.relative_to(root).as_posix() in own or (p.is_dir() and not p.is_symlink()) for p in held)


def _in_the_way(name: Path, where: str) -> InputError:
    msg = f"'{name}' is in the way, which concio did not write"
    return InputError(msg, where=where, hint="move it, or give another directory")


def _move(start: Path, end: Path, done: list[tuple[Path, Path]]) -> None:
    """Move a file to a place that is free; raise FileExistsError where it is not, whoever was quicker."""
    end.parent.mkdir(parents=True, exist_ok=True)
    try:
        end.hardlink_to(start)
    except FileExistsError:
        raise
    except OSError:  # a disk without links
        if os.path.lexists(end):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(end)) from None
        start.rename(end)
        done.append((start, end))
    else:
        done.append((start, end))
        start.unlink()


def _undone(
    root: Path, hidden: Path, listing: Listing, done: list[tuple[Path, Path]], names: Iterable[str]
) -> bool:
    """Move everything back and write the list that was there; tell whether all of it could be done."""
    well = True
    _remove_empty(root, names)  # made for a file that did not come: one that was there may have the folder's name
    for start, end in reversed(done):
        try:
            if not os.path.lexists(start):
                start.parent.mkdir(parents=True, exist_ok=True)
                end.rename(start)
            elif hidden in start.parents:  # linked and not yet unlinked; else it is there, or a file of the user's is
                end.unlink()
        except OSError:
            well = False
        if hidden in start.parents:
            _remove_empty(root, [end.relative_to(root).as_posix()])
    if not well:
        return False
    try:
        if listing.names:
            write_list(root, hidden, listing)
        else:
            (root / CONTENTS).unlink(missing_ok=True)
    except OSError:
        return False
    return True


def _remove_empty(root: Path, names: Iterable[str]) -> None:
    """Remove the folders that the files of these names left empty."""
    folders = {p for name in names for p in (root / name).parents if p.is_relative_to(root) and p != root}
    for folder in sorted(folders, reverse=True):
        with suppress(OSError):
            folder.rmdir()
