"""Plane or space: what a model's bodies say of its dimension, and that everything else has as many coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.errors import InputError

if TYPE_CHECKING:
    from concio.model.model import Load, Model, Support, Temperature, Tie
    from concio.model.stages import Stage

ELEMENTS: dict[int, tuple[str, ...]] = {
    2: ("Q4", "Q4I", "Q8", "Q9", "T3", "T6"),
    3: ("H8I", "H8", "H27", "T4", "T10"),
}
"""Element families by dimension, the default first."""
AXES = "xyz"
WORDS = {2: "in the plane", 3: "in space"}


def dimension_of(bodies: Sequence[Any]) -> int:
    """Return the dimension of bodies, which must all have the same.

    Raises
    ------
    InputError
        There are outlines and polyhedra.
    """
    dim = int(bodies[0].dim)
    for body in bodies:
        if body.dim != dim:
            msg = f"'{bodies[0].name}' is {WORDS[dim]}, '{body.name}' {WORDS[int(body.dim)]}"
            raise InputError(msg, hint="a model is plane or in space: concio.extrude makes blocks of outlines")
    return dim


def resolved(model: Model) -> dict[str, Any]:
    """Return the fields of a model that its dimension decides: element, and supports, loads, ties, stages in full.

    Raises
    ------
    InputError
        Something has the wrong number of coordinates, or the element is of another dimension.
    """
    dim = dimension_of(model.bodies)
    element = model.element or ELEMENTS[dim][0]
    if dim == 3 and element not in ELEMENTS[3]:
        msg = f"unknown element '{element}' for a model in space"
        raise InputError(msg, hint="one of: " + ", ".join(ELEMENTS[3]))
    if dim == 3 and model.periods is not None:
        msg = "a periodic cell is plane, but the bodies are in space"
        raise InputError(msg, hint="describe the cell by outlines")
    return {
        "element": element,
        "supports": tuple(_support(s, dim) for s in model.supports),
        "loads": tuple(_load(load, dim) for load in model.loads),
        "temperatures": tuple(_temperature(change, dim) for change in model.temperatures),
        "ties": tuple(_tie(tie, dim) for tie in model.ties),
        "stages": tuple(_stage(stage, dim) for stage in model.stages),
    }


def _numbers(values: Any, count: int, what: str, where: str, dim: int) -> tuple[float, ...]:
    found = np.asarray(values, dtype=float)
    if found.shape != (count,):
        shown = found.tolist() if found.size <= 6 else f"{found.size} numbers"
        msg = f"{what} = {shown}: {count} number{'s' if count > 1 else ''} expected, for the model is {WORDS[dim]}"
        raise InputError(msg, where=where)
    return tuple(found.tolist())


def _support(support: Support, dim: int) -> Support:
    where = f"support '{support.name}'"
    turns = 1 if dim == 2 else 3
    given = support.rotation
    rotation: Any = np.zeros(turns) if np.ndim(given) == 0 and not given else np.atleast_1d(given)
    turned = _numbers(rotation, turns, "rotation", where, dim)
    moved = _numbers(support.displacement or np.zeros(dim), dim, "displacement", where, dim)
    _region(support, where, dim)
    held = AXES[:dim] if support.directions == "all" else support.directions
    _moves_what_it_holds(held, moved, where)
    return replace(
        support,
        directions=held,
        displacement=moved,
        rotation=turned[0] if dim == 2 else turned,
    )


def _moves_what_it_holds(held: str, moved: tuple[float, ...], where: str) -> None:
    """Refuse directions that are none, and a displacement along one that the support does not hold."""
    known = AXES[: len(moved)]
    if not held or set(held) - set(known):
        msg = f"directions '{held}' are not made of '{known}'"
        raise InputError(msg, where=where)
    free = [axis for axis, value in zip(known, moved, strict=True) if value and axis not in held]
    if free:
        msg = f"a displacement along {' and '.join(free)} is imposed, but it holds only '{held}'"
        raise InputError(msg, where=where, hint=f"directions = '{''.join(sorted({*held, *free}))}' holds what is moved")


PLACES = {"weight": (), "body": (), "point": ("at",), "pressure": ("edge", "polygon", "face"),
          "traction": ("edge", "polygon", "face")}  # fmt: skip
"""What says where a load of a kind acts, beside its bodies."""


def _load(load: Load, dim: int) -> Load:
    where = f"load group '{load.group}'"
    idle = [name for name in ("at", "edge", "polygon", "face")
            if getattr(load, name) is not None and name not in PLACES.get(load.kind, (name,))]  # fmt: skip
    if idle:
        msg = f"a {load.kind} load takes no '{idle[0]}'"
        own = " or ".join(f"'{name}'" for name in PLACES[load.kind])
        told = "it acts on all of its bodies: name them in 'bodies'" if not own else f"it acts where {own} says"
        raise InputError(msg, where=where, hint=f"leave it out: {told}")
    _region(load, where, dim)
    if load.at is not None:
        _numbers(load.at, dim, "at", where, dim)
    return load


def _temperature(change: Temperature, dim: int) -> Temperature:
    where = f"load group '{change.group}'"
    if change.at is not None:
        _numbers(change.at, dim, "at", where, dim)
    if change.gradient:
        _numbers(change.gradient, dim, "gradient", where, dim)
    return change


def _region(thing: Support | Load, where: str, dim: int) -> None:
    for k, point in enumerate(thing.edge or (), 1):
        _numbers(point, dim, f"point {k} of the edge", where, dim)
    if thing.polygon is None:
        return
    if dim == 2:
        msg = "a polygon bounds faces of blocks in space, but the model is plane"
        raise InputError(msg, where=where, hint="give an edge: the two ends of a line")
    if thing.edge is not None:
        msg = "an edge and a polygon are given"
        raise InputError(msg, where=where, hint="leave one of them out")
    if len(thing.polygon) < 3:
        msg = f"the polygon has {len(thing.polygon)} vertices, it needs at least 3"
        raise InputError(msg, where=where)
    for k, point in enumerate(thing.polygon, 1):
        _numbers(point, 3, f"vertex {k} of the polygon", where, dim)


def _tie(tie: Tie, dim: int) -> Tie:
    for name in ("at_a", "at_b"):
        _numbers(getattr(tie, name), dim, name, f"tie '{tie.name}'", dim)
    return tie


def _stage(stage: Stage, dim: int) -> Stage:
    control = stage.control
    if control is None:
        return stage
    where = f"stage '{stage.name}'"
    _numbers(control.at, dim, "at", where, dim)
    direction = control.direction
    if dim == 3 and len(direction) == 2:  # the default, or a direction in plan
        direction = (*direction, 0.0)
    _numbers(direction, dim, "direction", where, dim)
    return replace(stage, control=replace(control, direction=tuple(direction)))
