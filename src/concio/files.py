"""Files of users: read only where they are files, written whole or not at all, and never over something else."""

from __future__ import annotations

import os
import re
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from concio.errors import InputError

LARGEST = 200_000_000
"""A text file of more bytes is refused."""


def check_regular(path: Path, *, hint: str | None = None, pipes: bool = False) -> int:
    """Raise where a path is not a file that can be read to its end; return its size [bytes].

    Parameters
    ----------
    path : Path
    hint : str, optional
        What to do where there is no such file.
    pipes : bool
        Whether a pipe will do.

    Raises
    ------
    InputError
        There is nothing, a directory, a device, or something that cannot be examined.
    """
    where = str(path)
    try:
        found = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        msg = "there is no such file"
        raise InputError(msg, where=where, hint=hint) from None
    except (OSError, ValueError) as error:
        msg = f"the file cannot be read: {getattr(error, 'strerror', None) or error}"
        raise InputError(msg, where=where) from None
    if stat.S_ISDIR(found.st_mode):
        msg = "this is a directory, not a file"
        raise InputError(msg, where=where)
    if not (stat.S_ISREG(found.st_mode) or (pipes and stat.S_ISFIFO(found.st_mode))):
        msg = "this is a device or a pipe, not a file"
        raise InputError(msg, where=where, hint="give the name of a file on a disk")
    return found.st_size


def read_text(
    path: Path, *, hint: str | None = None, pipes: bool = False, too_large: str | None = None, latin: bool = False
) -> str:
    """Return a text file in UTF-8, without a byte order mark, with lines that end in a line feed.

    Parameters
    ----------
    path : Path
    hint : str, optional
        What to do where there is no such file.
    pipes : bool
        Whether a pipe will do.
    too_large : str, optional
        What to do where it is larger than :data:`LARGEST`.
    latin : bool
        Whether a text that is not UTF-8 is taken for Latin-1, in which every byte is a letter.

    Raises
    ------
    InputError
        It is not a file, cannot be read, is too large, or is not UTF-8.
    """
    where = str(path)
    size = check_regular(path, hint=hint, pipes=pipes)
    try:
        with path.open("rb") as file:
            raw = b"" if size > LARGEST else file.read(LARGEST + 1)
    except OSError as error:
        msg = f"the file cannot be read: {error.strerror or error}"
        raise InputError(msg, where=where) from None
    if max(size, len(raw)) > LARGEST:
        msg = f"the file has more than {LARGEST / 1e6:.0f} MB"
        raise InputError(msg, where=where, hint=too_large)
    try:
        return raw.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        if latin:
            return raw.decode("latin-1").replace("\r\n", "\n")
        if b"\0" in raw:
            msg = "it is not a text: it holds bytes that no text has"
            raise InputError(msg, where=where, hint=hint) from None
        line = raw[: error.start].count(b"\n") + 1
        msg = f"byte {error.start} (line {line}) is not UTF-8"
        raise InputError(msg, where=where, hint="save the file with the encoding UTF-8") from None


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Give a file to write; when all went well it takes the place of ``target``, otherwise it goes away.

    A symbolic link stays one: what it points to is replaced. Nothing else in the directory is touched.
    """
    real = Path(os.path.realpath(target))
    with tempfile.TemporaryDirectory(dir=real.parent, prefix=f".{real.name[:100]}.") as aside:
        fresh = Path(aside) / real.name
        yield fresh
        if real.exists():
            fresh.chmod(stat.S_IMODE(real.stat().st_mode))
        fresh.replace(real)


_FORMULA = re.compile(r"'*[=+\-@\t\r]")


def guarded(text: str) -> str:
    """Return a text for a cell of a table; an apostrophe goes before what a spreadsheet would take for a formula."""
    return f"'{text}" if isinstance(text, str) and _FORMULA.match(text) else text


def unguarded(text: str) -> str:
    """Return the text that :func:`guarded` was given."""
    return text[1:] if text.startswith("'") and _FORMULA.match(text[1:]) else text
