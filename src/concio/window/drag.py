"""Limit loads while a load is dragged: certified bounds only, in the words of the limit's verdict."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import shapely

from concio.analysis.limit import limit_stages
from concio.contact.assembly import Assembly, assemble
from concio.errors import InputError
from concio.model.body import Body
from concio.model.model import Model
from concio.verdict.italian import in_italian
from concio.verdict.limit_words import bound_lines
from concio.window.read_models import own_loads, read
from concio.window.worker import Tell

_LAST: list[tuple[Model, Assembly]] = []
NEAR = 1e-6
"""A point as near to a block as this share of the size of the model is on it."""


def dragged(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return the associated bound of the group of a load that stands somewhere else.

    Parameters
    ----------
    request : mapping
        As for :func:`concio.window.read_models.read`; ``table``, the number of the load in ``[[loads]]`` from 0, and
        ``at``, where it stands [m], and ``body``, the block it acts on.
    tell : callable
        Not used: a bound is one number.

    Returns
    -------
    dict
        ``lines``, the bound in words; ``multiplier``; ``seconds``.

    Raises
    ------
    ConcioError
        There is no such load, it is on no block there, or its group has no bound.
    """
    begun = time.perf_counter()
    data, model = read(request)
    numbers = own_loads(data, model)
    number = numbers.get(request["table"])
    if number is None or model.loads[number].at is None:
        msg = "this load cannot be dragged"
        raise InputError(msg, hint="point loads of the file can")
    at, name = tuple(float(v) for v in request["at"]), str(request["body"])
    _check_on(model, name, at)
    moved = replace(model.loads[number], at=at, bodies=(name,))
    loads = (*model.loads[:number], moved, *model.loads[number + 1 :])
    assembly = _assembled(model).with_loads(loads)
    stages = limit_stages(assembly, [moved.group], path=False, steps=False, search=False)
    _, found = next(iter(stages))
    lines = [" ".join(line.split()) for line in bound_lines(found)]
    return {
        "lines": lines, "italian": [in_italian(line) for line in lines], "multiplier": found.associated.multiplier,
        "group": moved.group, "at": list(moved.at or ()), "seconds": time.perf_counter() - begun,
    }  # fmt: skip


def _assembled(model: Model) -> Assembly:
    """Return the assembly of a model; that of the last one is kept, for the next step of a drag."""
    if not _LAST or _LAST[0][0] is not model:
        _LAST[:] = [(model, assemble(model))]
    return _LAST[0][1]


def _check_on(model: Model, name: str, at: tuple[float, ...]) -> None:
    """Raise where a point is not on a block: what acts far off would be carried by an arm that is not there."""
    body = model.body(name)
    if isinstance(body, Body) and len(at) == 2:
        solid = shapely.Polygon(body.outline, body.holes)
        if shapely.Point(at).distance(solid) <= NEAR * model.size:
            return
    msg = f"the point ({', '.join(f'{v:.4g}' for v in at)}) is not on block '{name}'"
    raise InputError(msg, hint="drag the load onto a block")
