"""Arrays of a motion that was read: there, of the kind and shape they must have, and finite where that matters."""

from __future__ import annotations

from dataclasses import is_dataclass
from typing import Any

import numpy as np

from concio.errors import InputError

Array = np.ndarray

SHAPES: dict[str, dict[str, str]] = {
    "MotionState": {
        "centre": "f B 2", "rotation": "f B", "velocity": "f B 2", "spin": "f B", "strain": "f nodes 2",
        "nodal": "f nodes 2",
    },
    "Memory": {
        "key": "i m", "contact": "i m", "slip": "i m", "force": "f m 2", "stretch": "f m", "crushing": "f m",
        "raised": "f m", "broken": "b m", "slid": "f m", "area": "f m", "sunk": "f m", "stored": "f m",
    },
    "TieMemory": {"sunk": "f ties", "plastic": "f ties", "broken": "b ties"},
    "Shots": {
        "time": "f shots", "centre": "f shots B 2", "rotation": "f shots B", "strain": "f shots nodes 2",
        "opening": "f shots joints", "slip": "f shots joints",
    },
    "Steps": {
        "time": "f steps", "residual": "f steps", "how": "i steps", "factorisations": "i steps", "depth": "f steps",
        "point": "f steps points 2", "reaction": "f steps reactions 2",
    },
    "DynamicsResult": {"ground_time": "f steps", "ground": "f steps 2"},
    "PushResult": {
        "displacement": "f curve", "multiplier": "f curve", "residual": "f curve", "centre": "f curve B 2",
        "rotation": "f curve B", "strain": "f curve nodes 2", "reaction": "f curve reactions 2", "direction": "f 2",
        "force": "f 2",
    },
}  # fmt: skip
"""Kind (float, integer, boolean) and shape of every array; the same word is the same length throughout a file."""

KINDS = {"f": ("f", "numbers"), "i": ("iu", "integers"), "b": ("b", "yes or no")}

MAY_BE_INFINITE = ("residual",)

LARGEST = 1e100
"""Beyond any length, velocity, force or energy."""


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
