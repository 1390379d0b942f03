"""Writing a directory of results so that nothing half written is ever left: aside first, then in place at once."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from concio.errors import InputError

MARK = "summary.json"
"""A directory that holds this file is a result directory, which may be replaced."""


def check_target(target: Path, *, force: bool = False) -> None:
    """Raise where results cannot go to ``target``, before any work is done.

    Raises
    ------
    InputError
        It is a file, holds something else than results, or its parent is not a directory one may write to.
    """
    where = str(target)
    if target.exists() and not target.is_dir():
        msg = "this is a file; results need a directory"
        raise InputError(msg, where=where, hint="give another name to --out")
    if target.is_dir() and not force and any(target.iterdir()) and not (target / MARK).exists():
        msg = "the directory holds other things than results of concio"
        raise InputError(msg, where=where, hint="give another name to --out, or --force to replace it")
    parent = target.absolute().parent
    if not parent.is_dir():
        msg = f"there is no directory '{target.parent}'"
        raise InputError(msg, where=where, hint="make it first, or give another --out")
    try:
        with tempfile.TemporaryDirectory(dir=parent, prefix=f".{target.name}."):
            pass
    except OSError as error:
        msg = f"the directory cannot be written: {error.strerror}"
        raise InputError(msg, where=where, hint="give another name to --out") from None


@contextmanager
def replaced_directory(target: Path) -> Iterator[Path]:
    """Give a directory to write into; when all went well it takes the place of ``target``, otherwise it goes away."""
    parent = target.absolute().parent
    aside = Path(tempfile.mkdtemp(dir=parent, prefix=f".{target.name}."))
    fresh, old = aside / "new", aside / "old"
    try:
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
    finally:
        shutil.rmtree(aside, ignore_errors=True)


@contextmanager
def replaced_file(target: Path) -> Iterator[Path]:
    """Give a file to write; when all went well it takes the place of ``target``, otherwise it goes away."""
    with tempfile.TemporaryDirectory(dir=target.absolute().parent, prefix=f".{target.name}.") as aside:
        fresh = Path(aside) / target.name
        yield fresh
        fresh.replace(target)
