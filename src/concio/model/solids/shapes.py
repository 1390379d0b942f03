"""What stands in a file of solids before it is judged: vertices and faces, a name and a layer for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from concio.errors import InputError

Array = np.ndarray

MOST = 5_000_000
"""A file of more vertices is refused."""
FIXED = ("fixed", "ground", "support", "supports", "abutment", "abutments", "obstacle", "concio_fixed")
"""Layers and names that mean fixed bodies, in small letters."""


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
    tags : tuple of str
        Further words that choose it: class, type, storey of a building model. Capital letters do not matter in them.
    source : str
        Which instance of the file it is, for messages; empty where its name says that.
    unreadable : (sentence, hint), optional
        Why it has no surface.
    """

    name: str
    layer: str
    points: Array
    faces: Sequence[Sequence[int]]
    fixed: bool = False
    tags: tuple[str, ...] = ()
    source: str = ""
    unreadable: tuple[str, str] | None = None

    @property
    def words(self) -> tuple[str, ...]:
        """All that chooses it."""
        return tuple(word for word in (self.layer, self.name, *self.tags) if word)

    def answers(self, pattern: str) -> bool:
        """Return whether a name or a pattern (``"pier-*"``) chooses it."""
        own = fnmatchcase(self.layer, pattern) or fnmatchcase(self.name, pattern)
        return own or any(fnmatchcase(tag.lower(), pattern.lower()) for tag in self.tags)


@dataclass(frozen=True, eq=False)
class Scene:
    """All surfaces of a file, metres in one unit of it (None where the format has no unit), and what has no surface."""

    shapes: tuple[Shape, ...]
    metres: float | None = None
    left_out: tuple[str, ...] = ()


def check_size(count: int, where: str) -> None:
    """Refuse a file of more than :data:`MOST` vertices."""
    if count > MOST:
        msg = f"the file has more than {MOST:,} vertices"
        raise InputError(msg, where=where, hint="a scanned surface is not a structure of blocks: model the blocks")
