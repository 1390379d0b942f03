"""Where a command may write, found out before any work is done; single files replaced only when complete."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from concio.errors import InputError

MARK = "summary.json"
"""A directory that holds this file is a result directory, which may be replaced."""


def check_directory(target: Path) -> None:
    """Raise where results cannot go to the directory ``target``.

    Raises
    ------
    InputError
        It is a file, it holds something else than results, or its place cannot be written to.
    """
    where = str(target)
    if target.exists() and not target.is_dir():
        msg = "this is a file; results need a directory"
        raise InputError(msg, where=where, hint="give another name to --out")
    if target.is_dir() and any(target.iterdir()) and not (target / MARK).exists():
        msg = "the directory holds other things than results of concio"
        raise InputError(msg, where=where, hint="give the name of a new directory to --out")
    check_writable(target)


def check_writable(target: Path) -> None:
    """Raise where nothing can be created at ``target``, its missing parents included.

    Raises
    ------
    InputError
        The nearest directory that exists cannot be written to.
    """
    parent = target.absolute().parent
    while not parent.exists():
        parent = parent.parent
    try:
        with tempfile.TemporaryDirectory(dir=parent, prefix=f".{target.name}."):
            pass
    except OSError as error:
        msg = f"cannot write into '{parent}': {error.strerror}"
        raise InputError(msg, where=str(target), hint="give another place") from None


@contextmanager
def replaced_file(target: Path) -> Iterator[Path]:
    """Give a file to write; when all went well it takes the place of ``target``, otherwise it goes away."""
    target.absolute().parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.absolute().parent, prefix=f".{target.name}.") as aside:
        fresh = Path(aside) / target.name
        yield fresh
        fresh.replace(target)


@contextmanager
def replaced_directory(target: Path) -> Iterator[Path]:
    """Give a directory to write into; when all went well it takes the place of ``target``, otherwise it goes away."""
    parent = target.absolute().parent
    parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=parent, prefix=f".{target.name}.") as aside:
        fresh, old = Path(aside) / "new", Path(aside) / "old"
        fresh.mkdir()
        yield fresh
        if target.exists():
            target.rename(old)
        try:
            fresh.rename(target)
        except OSError:
            if old.exists():
                old.rename(target)
            raise
