"""A motion that goes on from the end of an earlier one: whether both are of the same bodies."""

from __future__ import annotations

import numpy as np

from concio.errors import InputError
from concio.model.body import Body
from concio.model.file.writing import dumps
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron

SAME = 1e-6
"""Corners nearer than this share of the size of the model are the same."""


def goes_on(earlier: Model, model: Model, where: str) -> list[str]:
    """Return what is to be said of a motion of ``model`` that begins where one of ``earlier`` ended.

    The state at its end says where every body is, by number; other bodies would stand at places of these.

    Raises
    ------
    InputError
        Bodies or ties are not the same, in the same order.
    """
    for what, before, now in (("block", earlier.bodies, model.bodies), ("tie", earlier.ties, model.ties)):
        names = [[one.name for one in things] for things in (before, now)]
        if names[0] != names[1]:
            msg = f"the {what}s of that motion are not those of this model, in this order"
            raise InputError(msg, where=where, hint="continue a motion with the model it was computed for")
    for old, new in zip(earlier.bodies, model.bodies, strict=True):
        if not _same(old, new, SAME * model.size):
            msg = f"block '{new.name}' is not the one of that motion: its shape or its place was changed"
            raise InputError(msg, where=where, hint="continue a motion with the model it was computed for")
    if dumps(earlier) != dumps(model):
        return ["the model is not that of the earlier motion: what was changed acts from the end of that motion on"]
    return []


def _same(old: Body | Polyhedron, new: Body | Polyhedron, near: float) -> bool:
    """Return whether two bodies are of the same kind and have the same corners."""
    if type(old) is not type(new) or old.kind != new.kind or old.vertices.shape != new.vertices.shape:
        return False
    if np.abs(old.vertices - new.vertices).max() > near:
        return False
    return not (isinstance(old, Body) and isinstance(new, Body)) or abs(old.thickness - new.thickness) <= near
