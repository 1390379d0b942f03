"""A body in the plane: a polygon, with holes or without. Its sister in space: :mod:`concio.model.polyhedron`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal, get_args

import numpy as np

from concio.arguments import strict_class
from concio.errors import InputError
from concio.kinematics.mass import Moments, polygon_moments
from concio.model.rings import check_holes, checked_ring, following
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.model.polyhedron import Polyhedron

Array = np.ndarray
Kind = Literal["elastic", "rigid", "fixed"]


@strict_class
@short_repr
@dataclass(frozen=True, eq=False)
class Body:
    """A block, a mortar film or an obstacle: a polygon, with holes or without.

    Parameters
    ----------
    name : str
        Unique in the model.
    outline : (n, 2) array
        Vertices [m]; stored counter-clockwise without the closing repetition.
    material : str
        Key of ``Model.materials``; ignored for fixed bodies.
    kind : {"elastic", "rigid", "fixed"}
        A fixed body has no unknowns: it is an obstacle (ground, wall, bearing).
    role : str
        "block", "mortar", "obstacle"...: chooses joint laws and colours.
    layer : str
        Free label, for instance the layer of a drawing.
    thickness : float
        Out-of-plane thickness [m].
    grid : (xs, ys) or None
        Mesh lines of a rectangle with sides along x and y; None lets concio mesh.
    mesh_size : float or None
        Target element size [m]; None takes the model's.
    holes : sequence of (k, 2) arrays
        Interior rings, inside the outline and clear of it and of each other [m]; stored clockwise. Other bodies may
        stand in them, as a shelf in a frame.

    Examples
    --------
    >>> import concio
    >>> block = concio.Body("b01", [(0.0, 0.0), (0.6, 0.0), (0.6, 0.3), (0.0, 0.3)], kind="rigid", thickness=0.4)
    >>> round(block.volume, 6)
    0.072
    """

    name: str
    outline: Array
    material: str = "block"
    kind: Kind = "elastic"
    role: str = "block"
    layer: str = ""
    thickness: float = 1.0
    grid: tuple[Array, Array] | None = None
    mesh_size: float | None = None
    holes: Sequence[Array] = ()

    dim: ClassVar[int] = 2

    def __post_init__(self) -> None:
        where = f"block '{self.name}'"
        object.__setattr__(self, "outline", checked_ring(self.outline, "outline", where))
        holes = tuple(checked_ring(h, f"hole {k}", where, clockwise=True) for k, h in enumerate(self.holes, 1))
        object.__setattr__(self, "holes", holes)
        if holes:
            check_holes(self.outline, holes, where)
            if self.grid is not None:
                msg = "a body with holes has no grid of mesh lines"
                raise InputError(msg, where=where, hint="leave grid out; mesh_size says how fine its mesh is")
        if not (0 < self.thickness < math.inf):
            msg = f"thickness = {self.thickness:g} must be positive and finite"
            raise InputError(msg, where=where)
        check_kind_and_mesh(self.kind, self.mesh_size, where)

    @cached_property
    def moments(self) -> Moments:
        """Area, centroid and second moments."""
        return polygon_moments(self.outline, self.holes)

    @property
    def area(self) -> float:
        """Area [m2]."""
        return self.moments.measure

    @property
    def centroid(self) -> Array:
        """Centroid (2,) [m]."""
        return self.moments.centroid

    @property
    def rings(self) -> tuple[Array, ...]:
        """The outline, counter-clockwise, and the holes, clockwise: the body lies to the left of every side [m]."""
        return self.outline, *self.holes

    @cached_property
    def vertices(self) -> Array:
        """Vertices (n, 2) of the outline, then of the holes [m]; edge k runs from vertex k to ``following[k]``."""
        return np.concatenate(self.rings) if self.holes else self.outline

    @cached_property
    def following(self) -> Array:
        """Number (n,) of the vertex that comes after each on its ring."""
        return following([len(ring) for ring in self.rings])

    @property
    def volume(self) -> float:
        """Area times thickness [m3]."""
        return self.area * self.thickness


def check_kind_and_mesh(kind: str, mesh_size: float | None, where: str) -> None:
    """Refuse a kind that no body has, and a size of elements that is none; for bodies in the plane and in space."""
    if kind not in get_args(Kind):
        msg = f"kind '{kind}' is not one of {', '.join(get_args(Kind))}"
        raise InputError(msg, where=where)
    if mesh_size is not None and not (0 < mesh_size < math.inf):
        msg = f"mesh size {mesh_size:g} must be positive and finite"
        raise InputError(msg, where=where)


def called(word: str, body: Body | Polyhedron) -> bool:
    """Return whether a word is the name, role or layer of a body, or a pattern (with ``*``) of its name."""
    if "*" in word:
        return word == "*" or fnmatchcase(body.name, word)
    return word != "" and word in (body.name, body.role, body.layer)
