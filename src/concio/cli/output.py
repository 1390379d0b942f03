"""Where a command may write, checked before any work is done; files of the user are never replaced."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from concio.errors import InputError

PICTURES = {
    ".png": ({"Software": "concio"}, b"Software\0concio"),
    ".svg": ({"Creator": "concio"}, b"<dc:title>concio<"),
    ".pdf": ({"Creator": "concio"}, b"/Creator (concio)"),
}
"""What concio writes into the pictures it draws beside the drawing, and how that stands in the file."""
LARGEST_PICTURE = 100_000_000
"""A larger file is not taken for a picture of concio's [bytes]."""


def check_directory(target: Path) -> None:
    """Raise where results cannot go to the directory ``target``; say what stays there and what is removed.

    Raises
    ------
    InputError
        It is a file, it holds something else than results, or its place cannot be written to.
    """
    from concio.cli.outcome import note
    from concio.io.owned_dir import look_at

    place = look_at(target)
    check_writable(target)
    for line in place.notes():
        note(f"Note: {line}")


def check_writable(target: Path) -> None:
    """Raise where nothing can be created at ``target``, its missing parents included.

    Raises
    ------
    InputError
        The nearest directory that exists cannot be written to.
    """
    from concio.io.hidden_dir import hidden_name

    try:
        nearest = target.resolve()
        while not nearest.is_dir():
            nearest = nearest.parent
        tried = nearest / hidden_name()  # a name that is known for what it is where the process dies here
        tried.mkdir()
        tried.rmdir()
    except (OSError, RuntimeError, ValueError) as error:
        msg = f"cannot write there: {getattr(error, 'strerror', None) or error}"
        raise InputError(msg, where=str(target), hint="give another place") from None


def check_file(target: Path, *, force: bool = False) -> None:
    """Raise where a file cannot be written to ``target``, or where a file of others exists.

    Raises
    ------
    InputError
        A file of that name is there, and is neither a picture that concio drew nor listed as concio's in its
        directory; it is a directory or a device; or its place cannot be written to.
    """
    from concio.io.owned_dir import is_own

    where = str(target)
    if target.exists():
        if not target.is_file():
            msg = "this is a directory or a device; a file is to be written"
            raise InputError(msg, where=where, hint="give another name")
        if not (force or is_own(target) or _is_picture(target)):
            msg = "there is a file of that name already"
            raise InputError(msg, where=where, hint="give another name, or --force to replace it")
    check_writable(target.parent)


def _is_picture(path: Path) -> bool:
    if path.suffix not in PICTURES or path.stat().st_size > LARGEST_PICTURE:
        return False
    return PICTURES[path.suffix][1] in path.read_bytes()


@contextmanager
def replaced_file(target: Path) -> Iterator[Path]:
    """Give a file to write; when all went well it takes the place of ``target``, otherwise it goes away."""
    from concio.files import whole_file

    target.absolute().parent.mkdir(parents=True, exist_ok=True)
    with whole_file(target) as fresh:
        yield fresh


@contextmanager
def replaced_directory(target: Path) -> Iterator[Path]:
    """Give a directory to write into; when all went well its files replace those that concio wrote there before."""
    from concio.io.owned_dir import owned_directory

    with owned_directory(target) as fresh:
        yield fresh
