"""What stands in a file of solids before it is judged: vertices and faces, a name and a layer for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.errors import InputError

Array = np.ndarray

MOST = 5_000_000
"""A file of more vertices is refused."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A surface in a file.

    Parameters
    ----------
    name, layer : str
        Empty where the file gives none.
    points : (n, 3) array
        In units of the file.
    faces : sequence of sequences of int
    fixed : bool
        Whether the file says that it is a support.
    """

    name: str
    layer: str
    points: Array
    faces: Sequence[Sequence[int]]
    fixed: bool = False


@dataclass(frozen=True, eq=False)
class Scene:
    """All surfaces of a file, and metres in one unit of it (None where the format has no unit)."""

    shapes: tuple[Shape, ...]
    metres: float | None = None


def check_size(count: int, where: str) -> None:
    """Refuse a file of more than :data:`MOST` vertices."""
    if count > MOST:
        msg = f"the file has more than {MOST:,} vertices"
        raise InputError(msg, where=where, hint="a scanned surface is no structure of blocks: model the blocks")
