"""What holds and loads the bodies: supports with their settlements, loads in groups, ties."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from concio.arguments import strict_class
from concio.representation import short_repr
from concio.units import quantity

Face = Literal["lower", "upper", "left", "right", "both"]
FACES: tuple[str, ...] = get_args(Face)
"""Faces of a joint that a load along it may act on."""
def _measured(value: Any, kind: str, where: str) -> Any:
    """Return a number or a sequence of numbers of which those that are texts were converted to base units."""
    if isinstance(value, str):
        return quantity(value, kind, where=where)
    return value if np.ndim(value) == 0 else tuple(_measured(v, kind, where) for v in value)


Point = tuple[float, ...]
"""A point or a vector with as many coordinates as the model has dimensions."""


@strict_class
@short_repr
@dataclass(frozen=True)
class Support:
    """Holds unknowns of elastic or rigid bodies, with or without an imposed displacement.

    Parameters
    ----------
    name : str
    body : str
        Body by name; a fixed body may be moved, which pushes or drags what touches it.
    edge : (point, point) or None
        Segment of the outline that is held, in space a line; a point is a segment of length zero. Without edge and
        polygon the whole body is held.
    directions : str
        Any of "x", "y" and, in space, "z"; or "all".
    displacement : (ux, uy) or (ux, uy, uz)
        Imposed displacement [m]; empty is none. It has no component along a direction that is not held.
    rotation : float, or (rx, ry, rz) in space
        Imposed rotation about the body's centroid, fixed and rigid bodies only [rad]. Texts with units, ``"2 mm"`` and
        ``"1 deg"``, are converted.
    group : str
        Load group that scales the imposed displacement.
    polygon : tuple of points, or None
        In space: the part of the body's faces that is held, as a planar polygon [m].

    Examples
    --------
    An elastic block of 40 kN is held at its foot:

    >>> import concio
    >>> block = concio.Body("block", [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)], "stone")
    >>> model = concio.Model(
    ...     bodies=(block,),
    ...     materials={"stone": concio.Elastic(E="5 GPa", unit_weight=20.0)},
    ...     laws={"joint": concio.JointLaw(friction=0.6)},
    ...     supports=(concio.Support("foot", "block", edge=((0.0, 0.0), (1.0, 0.0))),),
    ...     loads=(concio.Load("weight", (0.0, -1.0)),),
    ... )
    >>> round(float(concio.solve(model).reactions["foot"][1]), 6)
    40.0
    """

    name: str
    body: str
    edge: tuple[Point, Point] | None = None
    directions: str = "all"
    displacement: Point = ()
    rotation: float | Point = 0.0
    group: str = "settlement"
    polygon: tuple[Point, ...] | None = None

    def __post_init__(self) -> None:
        where = f"support '{self.name}'"
        object.__setattr__(self, "displacement", _measured(self.displacement, "length", where))
        object.__setattr__(self, "rotation", _measured(self.rotation, "angle", where))

    @property
    def moves(self) -> bool:
        """Whether a displacement or a rotation is imposed."""
        return bool(np.any(self.displacement) or np.any(self.rotation))


@strict_class
@short_repr
@dataclass(frozen=True)
class Load:
    """A load on the bodies it names.

    Parameters
    ----------
    kind : {"weight", "pressure", "traction", "point", "body"}
        weight: unit weight times volume, times the vector ``value``: (0, -1) is gravity, in space (0, 0, -1);
        (0.1, 0) a horizontal share of a tenth. pressure: ``value[0]`` [kN/m2], positive pushes against the face.
        traction: vector [kN/m2] on an edge or polygon. point: vector [kN] at ``at``. body: vector per volume [kN/m3].
    value : tuple of float
    bodies : tuple of str
        Names, roles, layers, or patterns of names such as ``"tower-*"``; empty means every body that is not fixed.
    edge : (point, point) or None
        Segment for pressure and traction in the plane; only outline parts that lie on it are loaded.
    at : point or None
        Point of a point load [m].
    group : str
        Load group; groups are scaled by load factors.
    face : {"lower", "upper", "left", "right", "both"} or None
        Which of the two faces of a joint a pressure or traction acts on that lies in a joint between two of the
        bodies; None is the lower one, the top of the body below. Where the edge lies on one face only, it is that one.
    polygon : tuple of points, or None
        Planar polygon for pressure and traction in space; only parts of faces that lie in it are loaded [m].

    Examples
    --------
    A force at the head of a block of 40 kN, 1 m wide and 2 m high, overturns it from 40 * 0.5 / 2 = 10 kN on:

    >>> import concio
    >>> import dataclasses
    >>> pillar = concio.column(width=1.0, height=2.0, blocks=1, block="rigid", unit_weight=20.0)
    >>> push = concio.Load("point", (1.0, 0.0), bodies=("b01",), at=(-0.5, 2.0), group="live")
    >>> model = dataclasses.replace(pillar, loads=(*pillar.loads, push))
    >>> round(concio.limit(model).design, 6)
    10.0
    """

    kind: Literal["weight", "pressure", "traction", "point", "body"]
    value: tuple[float, ...]
    bodies: tuple[str, ...] = ()
    edge: tuple[Point, Point] | None = None
    at: Point | None = None
    group: str = "dead"
    face: Face | None = None
    polygon: tuple[Point, ...] | None = None


@strict_class
@short_repr
@dataclass(frozen=True)
class Temperature:
    """A change of temperature of bodies, uniform or linear over them, which makes them expand or shrink.

    The strain is the change times the ``expansion`` of their material in every direction. In a body that is free to
    expand it makes no stress. Load factors scale it, as they scale loads.

    Parameters
    ----------
    change : float or str
        Of the temperature at ``at`` [K]; negative cools.
    bodies : tuple of str
        Names, roles, layers, or patterns of names such as ``"tower-*"``; empty means every body that is not fixed.
    gradient : (gx, gy) or (gx, gy, gz)
        How the change grows along x, y and z [K/m]; empty is uniform.
    at : point or None
        Where ``change`` is reached [m]; by default the centroid of each body.
    group : str
        Load group that scales the change. In a load path it begins at factor 0, like a support that moves.

    Examples
    --------
    >>> import concio
    >>> summer = concio.Temperature("25 K")
    >>> summer.change
    25.0
    """

    change: float
    bodies: tuple[str, ...] = ()
    gradient: Point = ()
    at: Point | None = None
    group: str = "temperature"

    def __post_init__(self) -> None:
        where = f"load group '{self.group}'"
        object.__setattr__(self, "change", quantity(self.change, "temperature", where=where))
        along = tuple(quantity(g, "temperature gradient", where=where) for g in self.gradient)
        object.__setattr__(self, "gradient", along)

    @property
    def kind(self) -> str:
        """Word of messages."""
        return "temperature"


@strict_class
@short_repr
@dataclass(frozen=True)
class Tie:
    """A straight bar that takes tension only, with prestress, between two bodies or a body and a fixed point.

    Of the kind "soil" it is earth that presses: it takes compression only, and stretching is shortening in what
    follows. Its other end is a fixed point in the ground (:mod:`concio.model.road.earth`).

    Parameters
    ----------
    name : str
    body_a, body_b : str
        Body names; one of them may be "" for a fixed point in space.
    at_a, at_b : points
        Ends [m].
    stiffness : float
        E A / L > 0 [kN/m].
    prestress : float
        Tension at zero elongation >= 0 [kN].
    yield_force : float or None
        Largest tension, of the bar or of its anchors [kN]; None is unlimited.
    break_elongation : float or None
        Elongation at which it breaks [m]; None is never.
    kind : {"bar", "soil"}
        A bar pulls its ends together, soil pushes them apart.

    Examples
    --------
    A tie of 10 MN/m with a prestress of 5 kN, at elongations of 1 and 2 mm. It yields at 20 kN:

    >>> import concio
    >>> tie = concio.Tie("t1", "left", (0.0, 3.0), "right", (4.0, 3.0), stiffness=10e3, prestress=5.0, yield_force=20.0)
    >>> round(tie.force(0.001), 6), round(tie.force(0.002), 6)
    (15.0, 20.0)
    """

    name: str
    body_a: str
    at_a: Point
    body_b: str
    at_b: Point
    stiffness: float
    prestress: float = 0.0
    yield_force: float | None = None
    break_elongation: float | None = None
    kind: Literal["bar", "soil"] = "bar"

    def __post_init__(self) -> None:
        kinds = {"stiffness": "stiffness", "prestress": "force", "yield_force": "force", "break_elongation": "length"}
        for name, kind in kinds.items():
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, quantity(value, kind, where=f"tie '{self.name}', {name}"))

    @property
    def sign(self) -> float:
        """1 where it takes tension, -1 where it takes compression."""
        return -1.0 if self.kind == "soil" else 1.0

    @property
    def most(self) -> float:
        """Largest tension [kN]; ``inf`` where it is unlimited."""
        return math.inf if self.yield_force is None else self.yield_force

    @property
    def strength(self) -> float:
        """Largest tension it ever has [kN]: the least of its yield force and of what it carries as it breaks."""
        if self.break_elongation is None:
            return self.most
        return min(self.most, self.prestress + self.stiffness * self.break_elongation)

    def force(self, elongation: float) -> float:
        """Return the tension [kN] at an elongation [m] that was never larger: elastic, then plastic, then broken."""
        if self.break_elongation is not None and elongation >= self.break_elongation:
            return 0.0
        return min(max(self.prestress + self.stiffness * elongation, 0.0), self.most)
