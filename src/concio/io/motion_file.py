"""Motions in one file: everything a push or a time history is, to look at later or to go on from.

An ``.npz`` archive: the model as the text of a model file, every array by its path ("shots.centre"), and the rest as
one JSON text. Nothing in it is ever executed.
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult, Ending
from concio.analysis.motion.energy import EnergyBalance
from concio.analysis.motion.history import Shots, Steps
from concio.analysis.motion.joint_events import JointEvent
from concio.analysis.motion.push_result import PushEnding, PushResult
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import Memory, MotionState, TieMemory
from concio.arguments import strict
from concio.errors import InputError
from concio.files import whole_file
from concio.model.file.reading import loads
from concio.model.file.writing import dumps
from concio.model.stages import ControlPoint

FORMAT, VERSION = "concio motion", 2
_PARTS = {
    c.__name__: c
    for c in (
        Shots, Steps, EnergyBalance, Scheme, Memory, TieMemory, MotionState, ControlPoint, JointEvent, Ending,
        PushEnding,
    )
}


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

    Parameters
    ----------
    path : Path or str

    Raises
    ------
    InputError
        There is no such file, or it holds no motion.
    """
    path = Path(path)
    if not path.is_file():
        msg = "there is no such file"
        raise InputError(msg, where=str(path), hint="give a file that save_motion, push or shake wrote: motion.npz")
    try:
        with np.load(path, allow_pickle=False) as archive:
            head = json.loads(str(archive["head"]))
            arrays = {name: archive[name] for name in archive.files if name != "head"}
    except (ValueError, KeyError, OSError, EOFError, zipfile.BadZipFile):
        head, arrays = {}, {}
    if not isinstance(head, dict) or head.get("format") != FORMAT:
        msg = "this file holds no motion"
        raise InputError(msg, where=str(path), hint="give a file that save_motion, push or shake wrote: motion.npz")
    if head["format_version"] != VERSION:
        msg = f"the file has version {head['format_version']}, this program reads {VERSION}"
        raise InputError(msg, where=str(path), hint="write it anew")
    model = loads(head["model"], name=f"{path}, model")
    values = {name: _unpacked(value, arrays) for name, value in head["values"].items()}
    kind = PushResult if head["kind"] == "PushResult" else DynamicsResult
    made: PushResult | DynamicsResult = kind(model=model, **values)
    return made


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
    part = _PARTS[value["kind"]]
    if "name" in value:
        return getattr(part, value["name"])
    return part(**{k: _unpacked(v, arrays) for k, v in value["fields"].items()})
