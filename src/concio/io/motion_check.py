"""Arrays of a motion that was read: there, of the kind and shape they must have, and finite where that matters."""

from __future__ import annotations

from dataclasses import is_dataclass
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.model.model import Model

Array = np.ndarray

SHAPES: dict[str, dict[str, str]] = {
    "MotionState": {
        "centre": "f B d", "rotation": "f B turn", "velocity": "f B d", "spin": "f B spin", "strain": "f nodes d",
        "nodal": "f nodes d",
    },
    "Memory": {
        "key": "i m", "contact": "i m", "slip": "f m t", "force": "f m d", "stretch": "f m t", "crushing": "f m",
        "raised": "f m", "broken": "b m", "slid": "f m t", "area": "f m", "sunk": "f m", "stored": "f m",
    },
    "TieMemory": {"sunk": "f ties", "plastic": "f ties", "broken": "b ties"},
    "Shots": {
        "time": "f shots", "centre": "f shots B d", "rotation": "f shots B turn", "strain": "f shots nodes d",
        "opening": "f shots joints", "slip": "f shots joints",
    },
    "Steps": {
        "time": "f steps", "residual": "f steps", "how": "i steps", "factorisations": "i steps", "depth": "f steps",
        "point": "f steps points d", "reaction": "f steps reactions d",
    },
    "DynamicsResult": {"ground_time": "f steps", "ground": "f steps d"},
    "PushResult": {
        "displacement": "f curve", "multiplier": "f curve", "residual": "f curve", "centre": "f curve B d",
        "rotation": "f curve B turn", "strain": "f curve nodes d", "reaction": "f curve reactions d",
        "direction": "f d", "force": "f d",
    },
}  # fmt: skip
"""Kind (float, integer, boolean) and shape of every array; the same word is the same length throughout a file.

d and t are the dimension and the number of tangents, turn and spin the axes of rotations: see :func:`sizes_of`."""

AXES = {("turn", 2): (), ("spin", 2): (), ("turn", 3): ("3", "3"), ("spin", 3): ("3",)}
"""Axes of the rotation of a body and of its spin, by dimension."""

KINDS = {"f": ("f", "numbers"), "i": ("iu", "integers"), "b": ("b", "yes or no")}

MAY_BE_INFINITE = ("residual",)

LARGEST = 1e100
"""Beyond any length, velocity, force or energy."""


def sizes_of(model: Model) -> dict[str, int]:
    """Return the lengths that a model says: bodies, dimension, tangents."""
    return {"B": len(model.bodies), "d": model.dim, "t": model.dim - 1}


def check_arrays(thing: Any, sizes: dict[str, int], where: str, place: str = "") -> None:
    """Refuse what a motion cannot be made of.

    Parameters
    ----------
    thing : dataclass
        A result or a part of one.
    sizes : dict of str to int
        Lengths known so far; those found are added.
    where : str
        The file.
    place : str
        Of the part in the file.

    Raises
    ------
    InputError
        An array is missing, of another kind or shape, or not finite.
    """
    for name, wanted in SHAPES.get(type(thing).__name__, {}).items():
        check_array(getattr(thing, name), wanted.split(), sizes, where, f"{place}{name}")
    for name in thing.__dataclass_fields__:
        part = getattr(thing, name)
        if name != "model" and is_dataclass(part) and not isinstance(part, type):
            check_arrays(part, sizes, where, f"{place}{name}.")


def check_array(array: object, wanted: list[str], sizes: dict[str, int], where: str, place: str) -> None:
    """Refuse an array that is not of the kind and shape ``wanted``, one word each; see :data:`SHAPES`."""
    kinds, words = KINDS[wanted[0]]
    if not isinstance(array, np.ndarray) or array.dtype.kind not in kinds:
        msg = f"damaged: '{place}' does not hold {words}"
        raise InputError(msg, where=where, hint="write the file again")
    d = sizes["d"]
    wanted = [axis for word in wanted for axis in AXES.get((word, d), (word,))]
    shape = tuple(int(w) if w.isdigit() else sizes.get(w, -1) for w in wanted[1:])
    fits = array.ndim == len(shape) and all(n in (-1, k) for n, k in zip(shape, array.shape, strict=True))
    if not fits:
        said = ", ".join(w if n < 0 else str(n) for n, w in zip(shape, wanted[1:], strict=True))
        msg = f"damaged: '{place}' has the shape {array.shape}, not ({said})"
        raise InputError(msg, where=where, hint="write the file again")
    sizes.update((w, k) for w, k in zip(wanted[1:], array.shape, strict=True) if not w.isdigit())
    beyond = array.dtype.kind == "f" and not (np.abs(array.astype(float)) < LARGEST).all()
    if beyond and place.rpartition(".")[2] not in MAY_BE_INFINITE:
        msg = f"damaged: '{place}' holds what no motion has"
        raise InputError(msg, where=where, hint="write the file again")
