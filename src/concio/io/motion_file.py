"""Motions in one file: everything a push or a time history is, to look at later or to go on from.

An ``.npz`` archive: the model as the text of a model file, every array by its path ("shots.centre"), and the rest as
one JSON text. Nothing in it is ever executed.
"""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult, Ending
from concio.analysis.motion.energy import NAMES, EnergyBalance
from concio.analysis.motion.history import Shots, Steps
from concio.analysis.motion.joint_events import JointEvent
from concio.analysis.motion.push_result import PushEnding, PushResult
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import Memory, MotionState, TieMemory
from concio.arguments import strict
from concio.errors import InputError
from concio.files import whole_file
from concio.io.motion_check import check_array, check_arrays, sizes_of
from concio.io.owned_dir import settle
from concio.model.file.reading import loads
from concio.model.file.writing import dumps
from concio.model.stages import ControlPoint

FORMAT, VERSION = "concio motion", 3

MOST_BYTES = 8_000_000_000
"""What a file may unpack to."""


def _number(v: object) -> bool:
    return isinstance(v, int | float) and bool(np.isfinite(v))


def _words(v: object) -> bool:
    return isinstance(v, tuple) and all(isinstance(w, str) for w in v)


def _all(kind: type) -> Callable[[object], bool]:
    return lambda v: isinstance(v, tuple) and all(isinstance(part, kind) for part in v)


def _event(v: object) -> bool:
    return isinstance(v, JointEvent) and _words(v.bodies) and len(v.bodies) == 2


PLAIN: dict[str, Callable[[object], bool]] = {
    "gravity": _number, "seconds": _number, "lent_compliance": _number,
    "begun": _number, "ground_ends": _number, "stated": lambda v: v is None or _number(v),
    "until": lambda v: v is None or _number(v), "by_load": lambda v: isinstance(v, bool),
    "reversed": lambda v: isinstance(v, bool), "asked": lambda v: isinstance(v, str), "fallen": _words,
    "refuted": lambda v: isinstance(v, str),
    "rests": lambda v: isinstance(v, bool),
    "stands": lambda v: v is None or isinstance(v, bool),
    "reactions_of": _words, "notes": _words, "live": _words,
    "points": _all(ControlPoint),
    "events": lambda v: isinstance(v, tuple) and all(_event(e) for e in v),
    "scheme": lambda v: isinstance(v, Scheme),
    "control": lambda v: v is None or isinstance(v, ControlPoint),
    "joints": lambda v: isinstance(v, tuple) and all(_words(pair) and len(pair) == 2 for pair in v),
    "factors": lambda v: isinstance(v, dict) and all(isinstance(k, str) and _number(f) for k, f in v.items()),
    "steps": lambda v: isinstance(v, Steps) and _words(v.methods),
}  # fmt: skip
"""What is not an array, and how to tell whether it is what it must be."""

UNREADABLE = (
    ValueError, KeyError, OSError, EOFError, zipfile.BadZipFile, zlib.error, NotImplementedError, RecursionError,
    MemoryError, RuntimeError,
)  # fmt: skip
_PARTS = {
    c.__name__: c
    for c in (
        Shots,
        Steps,
        EnergyBalance,
        Scheme,
        Memory,
        TieMemory,
        MotionState,
        ControlPoint,
        JointEvent,
    )
}
_ENDINGS: dict[str, type[Ending] | type[PushEnding]] = {"Ending": Ending, "PushEnding": PushEnding}


@strict
def save_motion(result: PushResult | DynamicsResult, path: Path | str) -> Path:
    """Write a push or a time history to a file.

    Parameters
    ----------
    result : PushResult or DynamicsResult
    path : Path or str
        Usually ends in ``.npz``; what is there is replaced.

    Returns
    -------
    Path
        ``path``.

    Examples
    --------
    >>> import concio
    >>> import tempfile
    >>> from pathlib import Path
    >>> pushed = concio.push(concio.column(width=0.5, height=2.0, blocks=1, block="rigid"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = concio.save_motion(pushed, Path(folder) / "push.npz")
    ...     again = concio.load_motion(file)
    >>> again.peak == pushed.peak
    True
    """
    path = Path(path)
    arrays: dict[str, Any] = {}
    plain = {f.name: _packed(getattr(result, f.name), f.name, arrays) for f in fields(result) if f.name != "model"}
    head = {
        "format": FORMAT, "format_version": VERSION, "kind": type(result).__name__, "model": dumps(result.model),
        "values": plain,
    }  # fmt: skip
    with whole_file(path) as fresh, fresh.open("wb") as file:
        np.savez_compressed(file, head=np.array(json.dumps(head)), **arrays)
    return path


@strict
def load_motion(path: Path | str) -> PushResult | DynamicsResult:
    """Return the motion that a file holds.

    Where a run was killed while it put its files into the directory, that is ended first.

    Parameters
    ----------
    path : Path or str

    Raises
    ------
    InputError
        There is no such file, or it holds no motion; or a killed run left the directory half changed and it cannot be
        written.

    Examples
    --------
    >>> import concio
    >>> import tempfile
    >>> from pathlib import Path
    >>> pushed = concio.push(concio.column(width=0.5, height=2.0, blocks=1, block="rigid"))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = concio.save_motion(pushed, Path(folder) / "push.npz")
    ...     again = concio.load_motion(file)
    >>> round(float(again.capacity), 4)
    0.25
    """
    path = Path(path)
    settle(path.parent)
    if not path.is_file():
        msg = "there is no such file"
        raise InputError(msg, where=str(path), hint="give a file that save_motion, push or shake wrote: motion.npz")
    try:
        with zipfile.ZipFile(path) as packed:
            size = sum(entry.file_size for entry in packed.infolist())
        if size > MOST_BYTES:
            msg = f"the file unpacks to {size / 1e9:,.0f} GB, more than any motion"
            raise InputError(msg, where=str(path), hint=f"{MOST_BYTES / 1e9:.0f} GB at most are read")
        with np.load(path, allow_pickle=False) as archive:
            head = json.loads(str(archive["head"]))
            arrays = {name: archive[name] for name in archive.files if name != "head"}
    except UNREADABLE:
        head, arrays = {}, {}
    if not isinstance(head, dict) or head.get("format") != FORMAT:
        msg = "this file holds no motion"
        raise InputError(msg, where=str(path), hint="give a file that save_motion, push or shake wrote: motion.npz")
    if head.get("format_version") != VERSION:
        msg = f"the file has version {head.get('format_version')}, this program reads {VERSION}"
        raise InputError(msg, where=str(path), hint="write it again")
    try:
        model = loads(head["model"], name=f"{path}, model")
        values = {name: _unpacked(value, arrays) for name, value in head["values"].items()}
        kind = {"PushResult": PushResult, "DynamicsResult": DynamicsResult}[head["kind"]]
        made: PushResult | DynamicsResult = kind(model=model, **values)
        _check(made, str(path))
    except InputError:
        raise
    except (KeyError, TypeError, AttributeError, ValueError, IndexError, RecursionError) as fault:
        msg = f"damaged: {type(fault).__name__}, {str(fault)[:100]}"
        raise InputError(msg, where=str(path), hint="write the file again") from None
    return made


def _check(made: PushResult | DynamicsResult, where: str) -> None:
    """Refuse a motion whose parts are not what they must be."""
    for name in made.__dataclass_fields__:
        if name in PLAIN and not PLAIN[name](getattr(made, name)):
            msg = f"damaged: '{name}' is not what it must be"
            raise InputError(msg, where=where, hint="write the file again")
    if not isinstance(made.ending, Ending if isinstance(made, DynamicsResult) else PushEnding):
        msg = "damaged: the ending of the motion is missing"
        raise InputError(msg, where=where, hint="write the file again")
    for name, kind in (("end", MotionState), *((("shots", Shots), ("steps", Steps), ("energy", EnergyBalance))
                       if isinstance(made, DynamicsResult) else ())):  # fmt: skip
        if type(getattr(made, name)) is not kind:
            msg = f"damaged: '{name}' is missing"
            raise InputError(msg, where=where, hint="write the file again")
    end = made.end
    parts = type(end.memory) is Memory and type(end.ties) is TieMemory
    if not (parts and isinstance(end.time, float) and np.isfinite(end.time)):
        msg = "damaged: the final state is incomplete"
        raise InputError(msg, where=where, hint="write the file again")
    sizes = sizes_of(made.model) | {"reactions": len(made.reactions_of)}
    if isinstance(made, DynamicsResult):
        sizes |= {"points": len(made.points), "joints": len(made.joints)}
        steps = made.steps
        check_arrays(made, sizes, where)
        if set(made.energy.values) != set(NAMES):
            msg = "damaged: the energy balance is incomplete"
            raise InputError(msg, where=where, hint="write the file again")
        for name, energy in made.energy.values.items():
            check_array(energy, ["f", "shots"], sizes, where, f"energy.{name}")
        if len(steps.how) and not 0 <= steps.how.min() <= steps.how.max() < len(steps.methods):
            msg = "damaged: 'steps.how' names methods that are not there"
            raise InputError(msg, where=where, hint="write the file again")
    else:
        check_arrays(made, sizes, where)


def _packed(value: Any, place: str, arrays: dict[str, Any]) -> Any:
    if isinstance(value, np.ndarray):
        arrays[place] = value
        return {"array": place}
    if isinstance(value, Ending | PushEnding):
        return {"kind": type(value).__name__, "name": value.name}
    if is_dataclass(value) and not isinstance(value, type):
        inner = {f.name: _packed(getattr(value, f.name), f"{place}.{f.name}", arrays) for f in fields(value)}
        return {"kind": type(value).__name__, "fields": inner}
    if isinstance(value, tuple):
        return {"tuple": [_packed(v, f"{place}.{k}", arrays) for k, v in enumerate(value)]}
    if isinstance(value, dict):
        return {"mapping": {k: _packed(v, f"{place}.{k}", arrays) for k, v in value.items()}}
    return value


def _unpacked(value: Any, arrays: dict[str, Any]) -> Any:
    if not isinstance(value, dict):
        return value
    if "array" in value:
        return arrays[value["array"]]
    if "tuple" in value:
        return tuple(_unpacked(v, arrays) for v in value["tuple"])
    if "mapping" in value:
        return {k: _unpacked(v, arrays) for k, v in value["mapping"].items()}
    if value["kind"] in _ENDINGS:
        return _ENDINGS[value["kind"]][value["name"]]
    part = _PARTS[value["kind"]]
    return part(**{k: _unpacked(v, arrays) for k, v in value["fields"].items()})
