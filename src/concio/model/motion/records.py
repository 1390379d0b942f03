"""Records of ground motion from files: PEER's AT2 (VT2, DT2), and text of one or two columns.

An AT2 file has four lines of head, the fourth with the number of samples and their step, and values in units of g, any
number of them on a line. In text files lines that do not begin with a number, and empty ones, are skipped; two columns
are time and value, one column needs the step. Values of one column may stand several on a line.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.model.motion.signals import Pulse, Quantity, Record

Array = np.ndarray

STANDARD_GRAVITY = 9.80665
"""What one g of a record is [m/s2]."""

UNITS: dict[str, tuple[Quantity, float]] = {
    "m/s2": ("acceleration", 1.0), "cm/s2": ("acceleration", 0.01), "mm/s2": ("acceleration", 0.001),
    "g": ("acceleration", STANDARD_GRAVITY), "gal": ("acceleration", 0.01),
    "m/s": ("velocity", 1.0), "cm/s": ("velocity", 0.01), "mm/s": ("velocity", 0.001),
    "m": ("displacement", 1.0), "cm": ("displacement", 0.01), "mm": ("displacement", 0.001),
}  # fmt: skip
"""Units of records, with the quantity they belong to and their size in m and s."""

PEER: dict[str, str] = {".at2": "g", ".vt2": "cm/s", ".dt2": "cm"}
"""Units of PEER's files by the ends of their names."""

LARGEST = 5.0
"""Peak acceleration in g from which on a record is probably in another unit."""

SMALLEST = 2e-3
"""Peak acceleration in g up to which a record is probably in another unit, such as g read as cm/s2."""

BEGINS = 0.05
"""Share of its peak above which a record of velocities does not begin at rest."""

UNEVEN = 1e-3
"""Share by which steps of time may differ."""

COMPONENTS = (3, 4)
"""Numbers on a line that are as likely three components, with or without a time, as values one after the other."""

MOST_BYTES = 200_000_000
"""Size of a file from which on it is not a record of ground motion: days of samples."""

_HEAD = re.compile(r"NPTS\s*=?\s*(\d{1,15})\s*,?\s*DT\s*=?\s*([0-9.EeDd+-]+)", re.IGNORECASE)
_UNITS = re.compile(r"UNITS OF\s+([A-Z0-9/*^]+)", re.IGNORECASE)
_NUMBER = re.compile(r"^\s*[-+]?(\d|\.\d)")
_SEPARATOR = re.compile(r"[,;\s]+")


@strict
def read_record(path: Path | str, *, unit: str | None = None, step: float | None = None) -> Record:
    r"""Return the record of a file.

    Parameters
    ----------
    path : Path or str
        ``.at2``, ``.vt2`` and ``.dt2`` are PEER's formats, anything else is text.
    unit : str, optional
        One of :data:`UNITS`; PEER's files bring their own, of a text it must be said.
    step : float, optional
        Time between the samples of a text of one column [s].

    Raises
    ------
    InputError
        There is no such file; the unit is not known, or not what the name of the file says; the record has a gap or
        does not run forwards in time.

    Examples
    --------
    The largest acceleration of 0.2 g in m/s2:

    >>> import concio
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "record.txt"
    ...     written = file.write_text("0.0\n0.1\n-0.2\n0.0\n")
    ...     record = concio.read_record(file, unit="g", step=0.01)
    >>> round(float(abs(record.values).max()), 5)
    1.96133
    """
    path = Path(path)
    where = str(path)
    if not path.is_file():
        msg = "there is no such file"
        raise InputError(msg, where=where, hint="give the path of a record, such as record.at2")
    if path.stat().st_size > MOST_BYTES:
        msg = f"the file holds {path.stat().st_size / 1e6:,.0f} MB: that is not a record of an earthquake"
        raise InputError(msg, where=where, hint=f"cut it to what is needed, {MOST_BYTES / 1e6:.0f} MB at most")
    if unit is not None and unit not in UNITS:
        msg = f"unknown unit '{unit}' of a record"
        raise InputError(msg, where=where, hint="one of: " + ", ".join(UNITS))
    try:
        text = path.read_text(encoding="utf-8", errors="strict")
    except UnicodeDecodeError:
        text = path.read_text(encoding="latin-1")
    suffix = path.suffix.lower()
    head = _HEAD.search("\n".join(text.splitlines()[:6]))
    if suffix in PEER or (head is not None and unit is None and step is None):
        values, interval = _peer(text, head, where)
        begins = 0.0
        if step is not None and abs(step - interval) > UNEVEN * interval:
            msg = f"the header says DT = {interval:g} s, and a step of {step:g} s is given"
            raise InputError(msg, where=where, hint="leave the step out; a text beside it may have a column of times")
        unit = _unit_of_peer(text, suffix, where, unit)
    else:
        values, interval, begins = _columns(text, step, where)
        if unit is None:
            msg = f"the text does not say its unit; its largest value is {float(np.abs(values).max()):.4g}"
            hint = "give the unit: --record-unit g, m/s2, cm/s2, m/s, m ...; in a file: unit = \"g\"; here: unit=\"g\""
            raise InputError(msg, where=where, hint=hint)
    quantity, size = UNITS[unit]
    return Record(size * values, interval, quantity, path.name, begins)


def _unit_of_peer(text: str, suffix: str, where: str, given: str | None) -> str:
    """Return the unit that the head of a PEER file names, else the one that is given, or the usual one of its kind."""
    usual = PEER.get(suffix, "g")
    named = _UNITS.search("\n".join(text.splitlines()[:6]))
    word = "" if named is None else named.group(1).lower()
    other = {"cm/s/s": "cm/s2", "cm/sec2": "cm/s2", "cm/s**2": "cm/s2", "m/s/s": "m/s2", "cm/sec": "cm/s"}
    unit = other.get(word, word)
    if unit not in UNITS and given is None:
        if named is None:
            return usual
        msg = f"the header names the unit '{named.group(1)}', which is not known"
        raise InputError(msg, where=where, hint="give the unit: one of " + ", ".join(UNITS))
    if given is not None and given != unit:
        if unit in UNITS and UNITS[unit] != UNITS[given]:
            msg = f"the header says that the values are in {unit}, and the unit {given} is given"
            hint = "leave the unit out; a file whose header is wrong needs another header"
            raise InputError(msg, where=where, hint=hint)
        if UNITS[given][0] != UNITS[usual][0]:
            msg = f"the name of the file says {UNITS[usual][0]}, and the unit {given} is given"
            raise InputError(msg, where=where, hint="leave the unit out, or give the file another name")
        return given
    if given is None and UNITS[unit][0] != UNITS[usual][0]:
        msg = f"the header says {UNITS[unit][0]} in {unit}, the name of the file {UNITS[usual][0]}"
        raise InputError(msg, where=where, hint="give the unit, or the file another name")
    return unit


def attention(signal: Record | Pulse) -> str | None:
    """Return what is strange about a record or a pulse: a peak that suggests another unit, a beginning in motion."""
    if isinstance(signal, Pulse):
        peak = abs(signal.amplitude) / STANDARD_GRAVITY
        if peak <= LARGEST:
            return None
        return f"the {signal.shape} pulse has a peak of {peak:.3g} g, more than any earthquake: is that its unit?"
    record = signal
    if record.quantity == "velocity" and abs(record.values[0]) > BEGINS * float(np.abs(record.values).max()):
        speed = f"{record.values[0]:.3g} m/s"
        return (
            f"record '{record.name}' begins with a velocity of {speed}: is it cut? Forces of inertia leave that out, a "
            "base that moves has it at once"
        )
    if record.quantity != "acceleration":
        return None
    peak = float(np.abs(record.values).max()) / STANDARD_GRAVITY
    if 0 < peak < SMALLEST:
        told = "less than any damaging earthquake: is that its unit?"
        return f"record '{record.name}' has a peak of {peak:.3g} g, {told}"
    if peak <= LARGEST:
        return None
    return (
        f"record '{record.name}' has a peak of {peak:.3g} g, more than any earthquake: is it in m/s2 or cm/s2 "
        "where g was meant, or vice versa?"
    )


def _peer(text: str, head: re.Match[str] | None, where: str) -> tuple[Array, float]:
    """Return values and step of a PEER file."""
    if head is None:
        msg = "the header has no 'NPTS= ..., DT= ...'"
        raise InputError(msg, where=where, hint="is it an AT2 file? A text of one or two columns must not end in .at2")
    count, step = int(head.group(1)), _float(head.group(2), where)
    body = text[head.end() :].split("\n", 1)
    words = body[1].split() if len(body) > 1 else []
    values = np.array([_float(word, where) for word in words])
    if len(values) != count:
        msg = f"the header announces {count:,} samples, the file holds {len(values):,}"
        raise InputError(msg, where=where, hint="the file was cut, or the header belongs to another record")
    return values, step


def _columns(text: str, step: float | None, where: str) -> tuple[Array, float, float]:
    """Return values, step and first time of a text of one or two columns."""
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        if not _NUMBER.match(line):
            if rows and line.strip() and not line.lstrip().startswith(("#", "%", "!", "//")):
                msg = f"line {number} is not a number: the record has a gap"
                raise InputError(msg, where=where, hint="fill the gap, or cut the record before it")
            continue
        words = [w for w in _SEPARATOR.split(line.strip()) if w]
        rows.append([_float(w, f"{where}, line {number}") for w in words])
    widths = {len(r) for r in rows}
    if not rows:
        msg = "the file holds no numbers"
        raise InputError(msg, where=where)
    if widths == {2} and step is None:
        return _timed(np.array(rows), where)
    if widths == {2}:
        msg = "a step of time was given, but the file has a column of times"
        raise InputError(msg, where=where, hint="leave the step out")
    if widths != {1} and step is None:
        msg = f"the lines hold {', '.join(map(str, sorted(widths)))} numbers; one or two columns are read"
        raise InputError(msg, where=where, hint="time and value, or values alone with the time between them (step)")
    if step is None:
        msg = "the file has one column: the time between samples is not known"
        raise InputError(msg, where=where, hint="give it (step, or --record-step '0.01 s'), or a column of times")
    _refuse_components(rows, where)
    return np.concatenate([np.array(r) for r in rows]), step, 0.0


def _refuse_components(rows: list[list[float]], where: str) -> None:
    """Refuse lines that are not one series after the other: several components side by side, or a line of another kind.

    Raises
    ------
    InputError
        All lines hold three or four numbers, the first numbers of the lines run evenly as times do, or a line before
        the last one holds another count.
    """
    width = len(rows[0])
    for number, row in enumerate(rows[1:], 2):
        if len(row) != width and not (number == len(rows) and len(row) < width):
            msg = f"row {number} of numbers holds {len(row)}, the first one {width}"
            raise InputError(msg, where=where, hint="put what stands before the values behind a #")
    if width == 1:
        return
    first = np.diff([row[0] for row in rows])
    evenly = len(first) > 2 and first[0] > 0 and bool(np.allclose(first, first[0], rtol=UNEVEN, atol=0.0))
    if evenly or (width in COMPONENTS and len(rows) > 1 and len(rows[-1]) == width):
        times = ", the first of which run as times do" if evenly else ""
        msg = f"every line holds {width} numbers{times}: one record is read"
        hint = "write a file for each component: time and value, or one value on a line"
        raise InputError(msg, where=where, hint=hint)


def _timed(rows: Array, where: str) -> tuple[Array, float, float]:
    time, values = rows.T
    step = np.diff(time)
    if len(step) == 0:
        msg = "the record has one sample"
        raise InputError(msg, where=where)
    bad = np.flatnonzero(~(step > 0))
    if bad.size:
        k = int(bad[0])
        swapped = bool((np.diff(values) > 0).all())
        msg = f"time does not rise: after {time[k]:g} s comes {time[k + 1]:g} s (sample {k + 2})"
        raise InputError(msg, where=where, hint="the two columns are swapped" if swapped else "sort the record by time")
    usual = float(np.median(step))
    uneven = np.flatnonzero(np.abs(step - usual) > UNEVEN * usual)
    if uneven.size:
        k = int(uneven[0])
        gap = f"{step[k]:.6g} s between {time[k]:g} s and {time[k + 1]:g} s"
        msg = f"the record has a gap: {gap}, elsewhere {usual:.6g} s"
        raise InputError(msg, where=where, hint="fill it; samples must have a constant time step")
    return values, float((time[-1] - time[0]) / len(step)), float(time[0])


def _float(word: str, where: str) -> float:
    try:
        return float(word.replace("D", "E").replace("d", "e").replace("_", "?"))
    except ValueError:
        msg = f"'{word}' is not a number"
        raise InputError(msg, where=where, hint="numbers have a decimal point: 0.01") from None
