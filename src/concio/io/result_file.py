"""A result as two files, ``result.json`` and ``result.npz``, that reload to the same object years later.

The files hold the model, the discretisation, the contact pairs, the solution with its certificate and the name of the
engine: everything :class:`concio.analysis.result.Result` is made of, as numbers. Reading them meshes nothing and solves
nothing, so a later concio with another mesher or another solver shows the same answer. Only the stiffness is formed
again, from the stored strain operators.
"""

from __future__ import annotations

import json
import platform
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import scipy

import concio
from concio.analysis.result import Result
from concio.arguments import strict
from concio.contact.assembly import Assembly
from concio.contact.pairs import Pairs
from concio.contact.supports import Condition, Supported
from concio.display import Units
from concio.errors import InputError
from concio.fem.discretisation import Discretisation
from concio.fem.elements import Elements
from concio.fem.shape import Shape
from concio.fem.solid import SolidShape
from concio.io.codec import Decoder, Encoder
from concio.io.owned_dir import settle
from concio.model.actions import Temperature
from concio.model.crossing import Axle, Vehicle
from concio.model.fill import Fill, Layer
from concio.model.interfaces.detect import Detection, Interface
from concio.model.interfaces.near import NearMiss, Overlap
from concio.model.interfaces.patch import Patch
from concio.model.interfaces.point_contact import PointContact
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Body, JointRule, Load, Model, Support, Tie
from concio.model.polyhedron import Polyhedron
from concio.model.stages import ControlPoint, Stage
from concio.problem.certificate import Certificate, Kinematics
from concio.problem.contact_problem import Laws
from concio.problem.solution import Departure, Mechanism, PartOutcome, Solution, Status

FORMAT = "concio result"
VERSION = 1
"""Version of the format; raised when a file of the new version could not be read by an older concio."""

CLASSES: dict[str, type] = {
    cls.__name__: cls
    for cls in (
        Assembly, Axle, Body, Certificate, Condition, ControlPoint, Departure, Detection, Discretisation, Elastic,
        Elements, Fill, Interface, JointLaw, JointRule, Kinematics, Laws, Layer, Load, Mechanism, Model, NearMiss,
        Overlap, Pairs, PartOutcome, Patch, PointContact, Polyhedron, Result, Rigid, Shape, SolidShape, Solution,
        Stage, Status, Support, Supported, Temperature, Tie, Units, Vehicle,
    )
}  # fmt: skip
"""Classes that may appear in a file, by the names they have there. A renamed class keeps its name here."""

LEFT_OUT = {"Assembly": ("K",)}


def save_result(result: Result, directory: Path) -> list[Path]:
    """Write ``result.json`` and ``result.npz`` into an existing directory.

    Parameters
    ----------
    result : Result
    directory : Path

    Returns
    -------
    list of Path
        The two files.
    """
    encoder = Encoder(CLASSES, LEFT_OUT)
    stored = replace(result, solution=_storable(result.solution))
    tree = {
        "format": FORMAT,
        "format_version": VERSION,
        "concio": concio.__version__,
        "written": datetime.now(UTC).isoformat(timespec="seconds"),
        "engine": {
            "method": result.method,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
        "certificate": result.summary()["certificate"],
        "result": encoder.encode(stored),
    }
    text, arrays = directory / "result.json", directory / "result.npz"
    text.write_text(json.dumps(tree, allow_nan=False, separators=(",", ":")) + "\n", encoding="utf-8")
    named: dict[str, Any] = dict(encoder.arrays)
    with arrays.open("wb") as file:
        np.savez_compressed(file, **named)
    return [text, arrays]


@strict
def load_result(directory: Path | str) -> Result:
    """Return the result that :func:`save_result` or :func:`concio.io.write_result` left in a directory.

    Parameters
    ----------
    directory : Path or str

    Raises
    ------
    InputError
        There is no result, it is damaged, or a newer concio wrote it in a format this one does not know.
    """
    directory = Path(directory)
    settle(directory)
    text, arrays = directory / "result.json", directory / "result.npz"
    for path in (text, arrays):
        if not path.is_file():
            msg = "there is no such file"
            raise InputError(msg, where=str(path), hint="give the directory that 'concio run --out' wrote")
    try:
        tree = json.loads(text.read_text(encoding="utf-8"))
    except ValueError as error:
        msg = "the file is damaged: it is not JSON"
        raise InputError(msg, where=str(text), hint="write the result again") from error
    if not isinstance(tree, dict) or tree.get("format") != FORMAT:
        msg = "this is not a result of concio"
        raise InputError(msg, where=str(text), hint="give the directory that 'concio run --out' wrote")
    if tree.get("format_version", 0) > VERSION:
        msg = f"format version {tree['format_version']} is newer than {VERSION}, the newest this concio reads"
        raise InputError(msg, where=str(text), hint=f"install concio {tree.get('concio', '')} or later")
    try:
        with np.load(arrays, allow_pickle=False) as file:
            found = {name: file[name] for name in file.files}
    except (ValueError, OSError, zipfile.BadZipFile) as error:
        msg = "the file is damaged"
        raise InputError(msg, where=str(arrays), hint="write the result again") from error
    result = Decoder(CLASSES, found, COMPUTED, str(text)).decode(tree["result"])
    if not isinstance(result, Result):
        msg = f"the file holds a {type(result).__name__}, not a result"
        raise InputError(msg, where=str(text))
    return result


def _with_tangents(fields: dict[str, Any]) -> None:
    """Read the pairs of a version that knew the plane alone."""
    if "tangent" in fields:
        fields["tangents"] = fields.pop("tangent")[:, None]
        fields["rule"] = np.zeros(len(fields["gap"]), dtype=int)


def _add_stiffness(fields: dict[str, Any]) -> None:
    fields["K"] = fields["disc"].stiffness()


COMPUTED = {"Assembly": _add_stiffness, "Pairs": _with_tangents}
"""What is put right in the fields of a class before it is made."""


def _storable(solution: Solution) -> Solution:
    """Return the solution with what a method says of itself reduced to numbers, texts, lists and arrays."""
    return replace(solution, info=_plain(solution.info))


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, bool | int | float | str | np.generic):
        return value
    if isinstance(value, np.ndarray):
        return value if value.dtype.kind in "biuf" else value.astype(str).tolist()
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(_plain(v) for v in value) if type(value) in (list, tuple) else [_plain(v) for v in value]
    return str(value)
