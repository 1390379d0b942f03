"""The directory of a study: its table of values first, then one line a run, appended as runs end.

``study.json`` says what the study is, with a fingerprint of everything that decides its rows; ``sample.csv`` holds the
values; ``rows.jsonl`` one line of JSON a run. A line that was not finished when a process died is dropped when the
study is taken up again, and its run is made again. Nothing else in the directory is touched.
"""

from __future__ import annotations

import contextlib
import csv
import hashlib
import io
import json
import os
import time
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import concio
from concio.errors import ConcioError, InputError
from concio.studies.functions import function_text
from concio.studies.sampling import Sample
from concio.studies.study_rows import Row, Tables, Task

DESCRIPTION, SAMPLE, ROWS = "study.json", "sample.csv", "rows.jsonl"
FILE_KEYS = ("blocks_file", "solids_file", "file")
"""Keys of a model file that name another file, which decides rows as well."""
NOT_READ = "record"
"""The table of a model file that says how it was made."""
SYNC = 0.5
"""Seconds after which written rows are forced to the disk."""


class StorageError(ConcioError):
    """Rows cannot be written; those written before are kept (exit code 1)."""


def describe(task: Task, sample: Sample) -> dict[str, Any]:
    """Return what a study is, in plain values; its ``fingerprint`` differs where any row could differ."""
    source: Any
    if isinstance(task.source, Tables):
        source = {"tables": task.source.data, "keys": [[p.text for p in places] for places in task.source.places]}
    else:
        source = {"function": function_text(task.source)}
    told: dict[str, Any] = {
        "concio": concio.__version__,
        "source": source,
        "variables": [asdict(v) for v in task.variables],
        "outputs": [
            {
                "name": o.name,
                "unit": o.unit,
                "read": function_text(o.read),
                "meaning": o.meaning,
                "end": o.end,
                "event": o.event,
                "multiplies": o.multiplies,
            }
            for o in task.outputs
        ],
        "settings": asdict(task.settings),
        "design": sample.design,
        "seed": sample.seed,
        "rows": len(sample),
        "numbers": hashlib.sha256(sample.numbers.tobytes()).hexdigest(),
    }
    files = _files(task)
    if files:
        told["files"] = files
    text = json.dumps(told, sort_keys=True, default=str)
    return {**told, "fingerprint": hashlib.sha256(text.encode()).hexdigest()}


def _files(task: Task) -> dict[str, str]:
    """Return the files that the model file names, and those that they name, each with a hash of what it holds."""
    if not isinstance(task.source, Tables):
        return {}
    found: dict[str, str] = {}
    folder = Path(task.source.folder).resolve()
    for name in _named(task.source.data):
        _add_file(folder / name, found)
    for v, places in zip(task.variables, task.source.places, strict=True):
        if any(place.parts[-1] in FILE_KEYS for place in places):
            for value in v.values:
                _add_file(folder / str(value), found)
    return {_beside(folder, path): told for path, told in sorted(found.items())}


def _beside(folder: Path, path: str) -> str:
    """Return a path relative to a folder, both without links; as it is where it is on another drive."""
    try:
        return os.path.relpath(path, folder)
    except ValueError:
        return path


def _named(tables: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names of files in the tables of a model file, but those of how it was made, which decide no row."""
    yield from _names_in({key: value for key, value in tables.items() if key != NOT_READ})


def _names_in(data: Any) -> Iterator[str]:
    if isinstance(data, Mapping):
        for key, value in data.items():
            if key in FILE_KEYS and isinstance(value, str):
                yield value
            else:
                yield from _names_in(value)
    elif isinstance(data, list | tuple):
        for value in data:
            yield from _names_in(value)


def _add_file(path: Path, found: dict[str, str]) -> None:
    """Add the hash of a file, and of those that it names if it is a model file; one that cannot be read fails rows."""
    try:
        key, content = str(path.resolve()), path.read_bytes()
    except (OSError, ValueError):
        return
    if key in found:
        return
    found[key] = hashlib.sha256(content).hexdigest()
    with contextlib.suppress(ValueError):
        for name in _named(tomllib.loads(content.decode()) if path.suffix.lower() == ".toml" else {}):
            _add_file(path.parent / name, found)


class Store:
    """Appends the rows of a study to a directory, or keeps them in memory where there is none.

    Parameters
    ----------
    directory : Path or None
    description : mapping
        As :func:`describe` returns it.
    sample : Sample
    resume : bool
        Whether rows that the directory holds already are taken over.

    Raises
    ------
    InputError
        The directory holds another study, or this one and ``resume`` is not set, or is in use.
    """

    def __init__(
        self, directory: Path | None, description: Mapping[str, Any], sample: Sample, *, resume: bool = False
    ) -> None:
        self.directory = directory
        self.rows: dict[int, Row] = {}
        self._file: io.FileIO | None = None
        self._synced = 0.0
        if directory is None:
            if resume:
                msg = "there is nothing to resume without a directory"
                raise InputError(msg, hint="give the directory of the study")
            return
        if directory.exists() and not directory.is_dir():
            msg = "this is a file; a study needs a directory"
            raise InputError(msg, where=str(directory))
        with _storing(directory):
            directory.mkdir(parents=True, exist_ok=True)
            if (directory / DESCRIPTION).exists() or (directory / ROWS).exists():
                self._take_over(description, len(sample), resume=resume)
                if not (directory / SAMPLE).exists():  # killed before it was written
                    _write_whole(directory / SAMPLE, _sample_text(sample))
            else:
                if resume:
                    msg = "there is no study to resume"
                    raise InputError(msg, where=str(directory), hint="leave resume out to begin one")
                if (directory / SAMPLE).exists():
                    msg = f"there is a {SAMPLE} already, and no study that it belongs to"
                    raise InputError(msg, where=str(directory), hint="move it, or give another directory")
                _write_whole(directory / DESCRIPTION, json.dumps(description, indent=1, default=str) + "\n")
                _write_whole(directory / SAMPLE, _sample_text(sample))
            self._file = (directory / ROWS).open("ab", buffering=0)  # what is not on the disk is nowhere
        self._lock()

    def _take_over(self, description: Mapping[str, Any], count: int, *, resume: bool) -> None:
        """Read the rows that are there, and cut off what was not finished."""
        assert self.directory is not None
        where = str(self.directory)
        try:
            held = json.loads((self.directory / DESCRIPTION).read_text(encoding="utf-8"))
            fingerprint, version = held["fingerprint"], held["concio"]
        except (FileNotFoundError, ValueError, KeyError, TypeError):
            msg = "the directory holds a study that cannot be read"
            raise InputError(msg, where=where, hint="give the name of a new directory") from None
        if not resume:
            msg = "the directory holds a study already"
            raise InputError(msg, where=where, hint="resume it, or give the name of a new directory")
        if fingerprint != description["fingerprint"]:
            changed = _changed(_plain(description), held)
            said = f" (made with concio {version})" if version != description["concio"] else ""
            msg = f"the directory holds another study{said}: {', '.join(changed) or 'something'} differs"
            raise InputError(msg, where=where, hint="give the name of a new directory; rows of both must not be mixed")
        path = self.directory / ROWS
        raw = path.read_bytes() if path.exists() else b""
        whole = raw[: raw.rfind(b"\n") + 1]
        for number, line in enumerate(whole.splitlines(), 1):
            try:
                row = Row.from_dict(json.loads(line))
            except (ValueError, KeyError, TypeError, AttributeError):
                msg = f"line {number} is not a row of a study"
                hint = "the file was changed by something else; give the name of a new directory"
                raise InputError(msg, where=str(path), hint=hint) from None
            if 0 <= row.index < count:
                self.rows.setdefault(row.index, row)
        if len(whole) < len(raw):
            with path.open("r+b") as file:
                file.truncate(len(whole))

    def _lock(self) -> None:
        """Take the directory for this process alone, as far as the system can say so."""
        with contextlib.suppress(ImportError):
            import fcntl

            assert self._file is not None
            try:
                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                self._file.close()
                msg = "another process is at work on this study"
                raise InputError(msg, where=str(self.directory), hint="wait for it, or stop it") from None

    def add(self, row: Row) -> None:
        """Keep a row; it is in the file when this returns.

        Raises
        ------
        StorageError
            The disk is full, or the file cannot be written.
        """
        if row.index in self.rows:
            return
        if self._file is not None:
            end = os.fstat(self._file.fileno()).st_size
            rest = json.dumps(row.as_dict(), separators=(",", ":")).encode() + b"\n"
            try:
                with _storing(self.directory, len(self.rows)):
                    while rest:
                        rest = rest[self._file.write(rest) or 0 :]
                    if time.monotonic() - self._synced > SYNC:
                        os.fsync(self._file.fileno())
                        self._synced = time.monotonic()
            except StorageError:
                with contextlib.suppress(OSError):  # an unfinished line goes; where even that fails, resuming drops it
                    os.truncate(self._file.fileno(), end)
                raise
        self.rows[row.index] = row

    def close(self) -> None:
        """Force everything to the disk and let the directory go."""
        if self._file is not None:
            with contextlib.suppress(OSError):
                os.fsync(self._file.fileno())
            self._file.close()
            self._file = None


@contextlib.contextmanager
def _storing(directory: Path | None, kept: int = 0) -> Iterator[None]:
    """Tell what the system says of a disk as one sentence."""
    try:
        yield
    except OSError as error:
        msg = f"cannot write: {(error.strerror or str(error)).lower()}"
        hint = f"{kept} rows are kept; make room, then resume" if kept else "give another directory"
        raise StorageError(msg, where=str(directory), hint=hint) from None


def _write_whole(path: Path, text: str) -> None:
    fresh = path.with_name(f".{path.name}.new")
    fresh.write_text(text, encoding="utf-8")
    fresh.replace(path)


def _sample_text(sample: Sample) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["row", *(f"{v.name} [{v.unit}]" if v.unit else v.name for v in sample.variables), "seed"])
    for index in range(len(sample)):
        values = sample.row(index).values()
        writer.writerow([index, *(repr(v) if isinstance(v, float) else v for v in values), int(sample.seeds[index])])
    return out.getvalue()


def _changed(told: Mapping[str, Any], held: Mapping[str, Any]) -> list[str]:
    """Return what of a study differs from one that a directory holds; of the files beside its model, which ones."""
    keys = [k for k in {**held, **told} if k not in ("fingerprint", "files") and told.get(k) != held.get(k)]
    files, before = told.get("files", {}), held.get("files", {})
    return keys + [f"'{name}'" for name in {**before, **files} if files.get(name) != before.get(name)]


def _plain(value: Any) -> Any:
    return json.loads(json.dumps(value, default=str))


def missing(count: int, done: Iterable[int]) -> list[int]:
    """Return the numbers of the runs that are still to be made, in order."""
    made = set(done)
    return [index for index in range(count) if index not in made]
