"""Hidden directories in which files are made complete, and the lock of the directory they go to.

A hidden directory is called ``.concio-HOST-PROCESS.NUMBER``. It is locked as long as the run that made it lives, so
that another run can tell whether it was left behind. The lock of the directory itself is held while files change their
place, not while they are written: runs that write into one directory at the same time put their files there one after
the other. Locks are those of the system (``flock``), which go when a process dies, however it dies. Where there are
none, the number of the process says whether it lives, and runs into one directory are not distinguished.
"""

from __future__ import annotations

import itertools
import os
import re
import shutil
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from concio.errors import InputError

FORGOTTEN = 86_400.0
"""Where processes cannot be asked whether they live, what they left is removed after a day [s]."""
PATIENCE = 60.0
"""A run waits for another to put its files into place as long as this [s]."""
TRIES = 1000
"""Names that are tried for a hidden directory."""
PARTS = ("new", "old")
"""Directories in a hidden one: files that go to their place, and files that made room."""
_NAME = re.compile(r"\.concio-(?P<host>[A-Za-z0-9]*)-(?P<pid>\d+)(?:\.\d+)?")
_NUMBERS = itertools.count()
_ALIVE: set[str] = set()


def is_hidden(name: str) -> bool:
    """Tell whether a name is that of a hidden directory of concio."""
    return _NAME.fullmatch(name) is not None


def hidden_name() -> str:
    """Return a name that no other hidden directory has."""
    return f".concio-{_host()}-{os.getpid()}.{next(_NUMBERS)}"


@contextmanager
def hidden_directory(root: Path) -> Iterator[Path]:
    """Give an empty hidden directory in ``root``, which is made where it is missing; the caller removes it."""
    for _ in range(TRIES):
        path = root / hidden_name()
        _ALIVE.add(str(path))  # before it is there: no other thread takes it for one that was left
        try:
            root.mkdir(parents=True, exist_ok=True)
            path.mkdir()
            break
        except (FileNotFoundError, FileExistsError):  # another run may remove what it made, or have had our number
            _ALIVE.discard(str(path))
    else:
        msg = f"no directory can be made in {root}"
        raise OSError(msg)
    try:
        with _flock(path, patience=0.0):
            yield path
    finally:
        _ALIVE.discard(str(path))


def remove(path: Path) -> None:
    """Remove a hidden directory, where it holds nothing else than such a directory holds."""
    with suppress(OSError):
        if is_hidden(path.name) and {p.name for p in path.iterdir()} <= {*PARTS, "list.json"}:
            shutil.rmtree(path, ignore_errors=True)


def is_left(path: Path) -> bool:
    """Tell whether a path is a hidden directory whose run is over."""
    match = _NAME.fullmatch(path.name)
    if match is None or path.is_symlink() or not path.is_dir() or str(path) in _ALIVE:
        return False
    if os.name != "posix" or match["host"] != _host():
        try:
            return time.time() - path.stat().st_mtime > FORGOTTEN
        except FileNotFoundError:
            return False
    pid = int(match["pid"])
    if pid != os.getpid():
        try:
            os.kill(pid, 0)
        except (ProcessLookupError, OverflowError):
            pass
        except OSError:
            return False
        else:
            return False
    try:
        with _flock(path, patience=0.0):
            return True
    except TimeoutError:
        return False


@contextmanager
def locked(root: Path, where: str) -> Iterator[None]:
    """Hold the lock of a directory, as far as the system has one.

    Raises
    ------
    InputError
        Another run holds it for too long.
    """
    lock = _flock(root, patience=PATIENCE)
    try:
        lock.__enter__()
    except TimeoutError:
        msg = "another run is putting its files there, and has not finished"
        raise InputError(msg, where=where, hint="wait for it, stop it, or give another directory") from None
    try:
        yield
    finally:
        lock.__exit__(None, None, None)


@contextmanager
def _flock(path: Path, patience: float) -> Iterator[None]:
    """Hold the system's lock of a directory; raise TimeoutError where another holds it; nothing without such locks."""
    try:
        import fcntl

        handle = os.open(path, os.O_RDONLY)
    except (ImportError, OSError):
        yield
        return
    try:
        end = time.monotonic() + patience
        while True:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                if time.monotonic() >= end:
                    raise TimeoutError from None
                time.sleep(0.02)
            except OSError:  # a disk without locks
                break
            else:
                break
        yield
    finally:
        os.close(handle)


def _host() -> str:
    return re.sub(r"[^A-Za-z0-9]", "", socket.gethostname())[:40]
