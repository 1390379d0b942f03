"""Which way the earthquake pushes, in words: the model with its horizontal forces, for each way that is asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from concio.arguments import closest
from concio.contact.applied import applied_forces, free_group, resultants, sideways
from concio.errors import InputError
from concio.model.model import Model

Array = np.ndarray
Direction = str | Sequence[float]

PLANE = {"right": (1.0,), "left": (-1.0,)}
SPACE = {"+x": (1.0, 0.0), "-x": (-1.0, 0.0), "+y": (0.0, 1.0), "-y": (0.0, -1.0)}
ALIAS = {"right": "+x", "left": "-x"}
SEVERAL: dict[int, dict[str, tuple[str, ...]]] = {
    2: {"both": ("right", "left")},
    3: {"both": ("+x", "-x"), "all": ("+x", "-x", "+y", "-y"), "corners": ("+x+y", "-x+y", "-x-y", "+x-y"),
        "every": ("+x", "-x", "+y", "-y", "+x+y", "-x+y", "-x-y", "+x-y")},
}  # fmt: skip
"""Words for several ways; corners are pushed along their diagonals."""

DIAGONALS = {a + b: (SPACE[a][0], SPACE[b][1]) for a in ("+x", "-x") for b in ("+y", "-y")}
"""Along both axes alike."""

USUAL = {2: "both", 3: "all"}
"""What is examined unless another is asked for."""

ALONG = 0.999
"""Cosine above which a direction is that of the load that pushes."""


@dataclass(frozen=True, eq=False)
class Push:
    """One way of pushing.

    Parameters
    ----------
    way : str
        In a word: "right", "+x", "(0.6, 0.8)".
    model : Model
        With the loads that push.
    groups : tuple of str
        Their load groups.
    sign : {1, -1}
        Which way these are multiplied.
    origin : mapping of int to int
        For each load made of a weight, the number of the load that is that weight.
    """

    way: str
    model: Model
    groups: tuple[str, ...]
    sign: float
    origin: Mapping[int, int] = field(default_factory=dict)

    @property
    def numbers(self) -> tuple[int, ...]:
        """Which loads of its model push."""
        return tuple(k for k, load in enumerate(self.model.loads) if load.group in self.groups)

    def by_group(self) -> dict[str, tuple[Array, float]]:
        """Return what pushes for a multiplier of one, by the group it was stated in: resultant (d,) and size [kN]."""
        found: dict[str, tuple[Array, float]] = {}
        for k in self.numbers:
            own = self.model.loads[self.origin.get(k, k)].group
            for force, size in resultants(self.model, [k]).values():
                total, before = found.get(own, (np.zeros(self.model.dim), 0.0))
                found[own] = total + self.sign * force, before + size
        return found


def pushes(model: Model, direction: Direction | None, groups: tuple[str, ...]) -> list[Push]:
    """Return the ways in which a model is pushed: by its weights, or by load groups of its own.

    Parameters
    ----------
    model : Model
    direction : str, (2,) vector or None
        In the plane "right", "left" or "both" (the default); in space "+x", "-x", "+y", "-y", "both" (along x), "all"
        (the default), or a horizontal vector.
        "corners" are the four diagonals, "every" is "all" and those.
    groups : tuple of str
        Load groups that push instead of the weights. In the plane "right" is along them, "left" against them; in space
        a direction is looked for along and against them.

    Raises
    ------
    InputError
        There is no such direction, or the groups do not push that way.
    """
    ways = _asked(model.dim, direction)
    if not groups:
        return [_by_weights(model, way, vector) for way, vector in ways.items()]
    if model.dim == 2:
        return [Push(way, model, groups, vector[0]) for way, vector in ways.items()]
    numbers = [k for k, load in enumerate(model.loads) if load.group in groups]
    total = np.sum([f.force[:2] for f in applied_forces(model, numbers)], axis=0)
    total = total / (float(np.linalg.norm(total)) or 1.0)
    if direction is None:
        return [Push(_name(sign * total), model, groups, sign) for sign in (1.0, -1.0)]
    found = [
        Push(way, model, groups, float(np.sign(total @ vector)))
        for way, vector in ways.items()
        if abs(float(total @ vector)) > ALONG
    ]
    if not found:
        msg = f"the load of '{', '.join(groups)}' pushes along {_name(total)}, not along {', '.join(ways)}"
        raise InputError(msg, hint="leave direction out, or leave live out so that the weights push that way")
    return found


def _by_weights(model: Model, way: str, vector: Array) -> Push:
    """Return the push of all weights, in a load group of its own whatever the groups of the model are called."""
    group = free_group(model)
    made, numbers = sideways(model, vector.tolist(), group)
    first = len(model.loads)
    whole = replace(model, loads=(*model.loads, *made))
    return Push(way, whole, (group,), 1.0, {first + i: k for i, k in enumerate(numbers)})


def _asked(dim: int, direction: Direction | None) -> dict[str, Array]:
    """Return the ways that are asked for, with their vectors (1,) in the plane and (2,) in space."""
    known: dict[str, tuple[float, ...]] = dict(PLANE) if dim == 2 else {**SPACE, **DIAGONALS}
    several = SEVERAL[dim]
    if direction is None:
        direction = USUAL[dim]
    if isinstance(direction, str):
        word = ALIAS.get(direction, direction) if dim == 3 else direction
        names = several.get(word, (word,))
        if not set(names) <= set(known):
            msg = f"there is no direction '{direction}'"
            raise InputError(msg, hint=closest(direction, (*known, *several)))
        vectors = [np.array(known[name]) / float(np.linalg.norm(known[name])) for name in names]
        return {name if name not in DIAGONALS else _name(v): v for name, v in zip(names, vectors, strict=True)}
    vector = np.array(direction, dtype=float)
    if dim == 2 or vector.shape != (2,) or not 0 < float(np.linalg.norm(vector)) < np.inf:
        msg = f"{direction!r} is not a direction"
        words = ", ".join((*known, *several))
        more = " or a horizontal vector (x, y)" if dim == 3 else ""
        raise InputError(msg, hint=f"one of {words}{more}")
    vector = vector / float(np.linalg.norm(vector))
    return {_name(vector): vector}


def _name(vector: Array) -> str:
    """Return a direction in a word."""
    for word, known in SPACE.items():
        if float(vector @ np.array(known)) > 1 - 1e-9:
            return word
    return "(" + ", ".join(f"{v:.3g}" for v in vector) + ")"
