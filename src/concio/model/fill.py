"""The fill above the arches of a bridge, with the road on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from concio.arguments import strict_class
from concio.errors import InputError
from concio.model.bounded import not_negative, positive
from concio.units import degrees, quantity

Side = Literal["none", "active", "at rest"]

RADIANS = 1.6
"""Friction angles up to this number of degrees are taken for radians, and refused."""
DEEPEST = 100.0
"""No arch lies deeper under its road [m]."""
COVER_OR_ROAD = (
    "cover is the depth of road over the crown of the extrados; of a drawing, road in [bridge_drawing] names the layer"
)


@strict_class
@dataclass(frozen=True)
class Layer:
    """A layer of the road above the fill: surfacing, ballast.

    Parameters
    ----------
    depth : float or str
        Thickness > 0, measured down from the layer above or from the road line [m].
    unit_weight : float or str
        Weight per volume >= 0 [kN/m3].
    name : str

    Examples
    --------
    >>> import concio
    >>> surfacing = concio.Layer("8 cm", unit_weight=23.0)
    >>> fill = concio.Fill(cover=0.5, layers=(surfacing,))
    >>> round(fill.layers[0].depth, 6)
    0.08
    """

    depth: float
    unit_weight: float
    name: str = "surfacing"

    def __post_init__(self) -> None:
        object.__setattr__(self, "depth", positive("depth", self.depth, "length", f"layer '{self.name}'"))
        object.__setattr__(self, "unit_weight", _weight(self.unit_weight, f"layer '{self.name}'"))


@strict_class
@dataclass(frozen=True)
class Fill:
    """Fill between the arches of a plane model and the road, its pressure on them, and how it spreads live load.

    Parameters
    ----------
    cover : float, str or None
        Depth from the road line to the highest point of the masonry, layers included > 0 [m]; None where ``road`` is
        given.
    gradient : float
        Slope of the road line through that point; positive rises to the right.
    road : sequence of points
        Road line in place of cover and gradient, from left to right [m].
    unit_weight : float or str
        [kN/m3].
    layers : sequence of Layer
        From the road line down; the rest is fill.
    fill_line : sequence of points
        Line between fill and surfacing in place of layers, from left to right over the whole bridge [m].
    surfacing_weight : float or str
        Weight per volume of what lies between ``fill_line`` and road [kN/m3].
    spandrels : float or str
        Thickness of each of two spandrel walls at the edges of the bridge, which stand on the arches up to the road and
        take their share of the width from the fill; their weight counts, nothing else of them [m].
    spandrel_weight : float or str
        Their weight per volume [kN/m3].
    parapet : float or str
        Height of both walls above the road [m].
    spread : str or mapping
        Name of a rule by which live load reaches the masonry, or a rule of the user's
        (:mod:`concio.model.road.spread`).
    width : "full", "rule" or float or str
        Width of the structure that is computed: that of the bodies; that which the rule gives below the crown, at most
        that of the bodies; or a length [m].
    friction_angle : float, str or None
        phi of the fill [degrees]; gives the passive, active and at-rest coefficients.
    cohesion : float or str
        c of the fill, which adds 2 c sqrt(K_p) to the passive pressure [kN/m2].
    mobilised : float
        Share m_p of the passive pressure that counts, 0 to 1.
    passive : float or None
        Largest horizontal pressure over the vertical stress in place of m_p K_p(phi).
    pressure : {"none", "active", "at rest"}
        Horizontal pressure before anything moves: none; active, which never falls away; or at rest (1 - sin phi), which
        falls to nothing where the arch moves away.
    stiffness : float or str
        Horizontal pressure per displacement into the fill [kN/m3]. It enters displacements, not limit loads.
    group : str
        Load group of the weight.
    bridge_width : float, str or None
        Width of the bodies before ``width`` made the structure narrower [m]; written by :func:`concio.with_fill`.

    Notes
    -----
    Weights are those of vertical strips. Horizontal pressure acts on each block at the middle of its upper face, on the
    vertical projection of that face, from the side where the fill is.

    Examples
    --------
    Rankine's passive coefficient is 3 for 30 degrees. Half of it is mobilised:

    >>> import concio
    >>> fill = concio.Fill(cover=0.5, friction_angle=30.0, mobilised=0.5)
    >>> round(fill.passive_coefficient, 6)
    1.5
    """

    cover: float | None = None
    gradient: float = 0.0
    road: tuple[tuple[float, float], ...] = ()
    unit_weight: float = 20.0
    layers: tuple[Layer, ...] = ()
    fill_line: tuple[tuple[float, float], ...] = ()
    surfacing_weight: float = 23.0
    spandrels: float = 0.0
    spandrel_weight: float = 22.0
    parapet: float = 0.0
    spread: str | dict[str, object] = "uniform 1:2"
    width: float | str = "full"
    friction_angle: float | None = None
    cohesion: float = 0.0
    mobilised: float = 1.0
    passive: float | None = None
    pressure: Side = "none"
    stiffness: float = 20_000.0
    group: str = "fill"
    bridge_width: float | None = None

    def __post_init__(self) -> None:
        where = "fill"
        put = object.__setattr__
        if (self.cover is None) == (not self.road):
            msg = "one of cover and road is needed, and not both"
            raise InputError(msg, where=where, hint=COVER_OR_ROAD)
        if self.cover is not None:
            cover = quantity(self.cover, "length", where=f"{where}, cover")
            if not 0 < cover < math.inf:
                msg = f"cover = {cover:g} m must be positive: the road would lie below the crown of the extrados"
                raise InputError(msg, where=where, hint="cover is the depth from the road to the highest masonry")
            if cover > DEEPEST:
                msg = f"cover = {cover:g} m is deeper than fill on any bridge"
                raise InputError(msg, where=where, hint="a bare number is in m: write '400 mm' where it is not")
            put(self, "cover", cover)
        for key in ("road", "fill_line"):
            line = tuple((float(x), float(y)) for x, y in getattr(self, key))
            put(self, key, line)
            if line and (len(line) < 2 or any(b[0] <= a[0] for a, b in pairwise(line))):
                msg = f"{key} needs two points or more, each further to the right than the one before"
                raise InputError(msg, where=where, hint="for example [[-2.0, 1.9], [9.0, 1.9]]")
        if self.fill_line and self.layers:
            msg = "fill_line and layers are both given"
            raise InputError(msg, where=where, hint="both say where the fill ends: give one of them")
        if not abs(self.gradient) <= 0.5:
            msg = f"gradient = {self.gradient:g} is not a slope of a road"
            raise InputError(msg, where=where, hint="0.03 rises by 3 m in 100 m")
        put(self, "unit_weight", _weight(self.unit_weight, where))
        for key in ("surfacing_weight", "spandrel_weight"):
            put(self, key, not_negative(key, getattr(self, key), "unit weight", where))
        for key in ("spandrels", "parapet"):
            put(self, key, not_negative(key, getattr(self, key), "length", where))
        put(self, "cohesion", not_negative("cohesion", self.cohesion, "stress", where))
        put(self, "stiffness", positive("stiffness", self.stiffness, "joint stiffness", where))
        put(self, "layers", tuple(self.layers))
        if isinstance(self.width, str) and self.width not in ("full", "rule"):
            put(self, "width", quantity(self.width, "length", where=f"{where}, width"))
        if not isinstance(self.width, str) and not 0 < self.width < math.inf:
            msg = f"width = {self.width:g} m must be positive"
            raise InputError(msg, where=where, hint="'full', 'rule' or a length")
        if self.bridge_width is not None:
            put(self, "bridge_width", positive("bridge_width", self.bridge_width, "length", where))
        if self.friction_angle is not None:
            put(self, "friction_angle", _friction_angle(self.friction_angle, where))
        if not 0 <= self.mobilised <= 1:
            msg = f"mobilised = {self.mobilised:g} must lie between 0 and 1"
            raise InputError(msg, where=where, hint="the share of the passive pressure that counts; often 0.33 to 0.5")
        if self.passive is not None and not 0 <= self.passive < math.inf:
            msg = f"passive = {self.passive:g} must be zero or positive"
            raise InputError(msg, where=where, hint="horizontal over vertical pressure; 0 leaves the fill its weight")
        if self.passive is not None and self.mobilised != 1.0:
            msg = "passive and mobilised are both given"
            raise InputError(msg, where=where, hint="passive is already m_p K_p: leave mobilised out")
        idle = [key for key, stated in (("cohesion", self.cohesion), ("mobilised", self.mobilised != 1.0)) if stated]
        if idle and self.friction_angle is None and self.passive is None:
            msg = f"{idle[0]} is given without friction_angle: without it the fill presses nothing sideways"
            raise InputError(msg, where=where, hint="add friction_angle (30 degrees, 0 undrained), or leave it out")
        if self.pressure not in ("none", "active", "at rest"):
            msg = f"pressure = '{self.pressure}' is not one of none, active, at rest"
            raise InputError(msg, where=where)
        if self.pressure != "none" and self.friction_angle is None:
            msg = f"pressure = '{self.pressure}' needs friction_angle"
            raise InputError(msg, where=where, hint="for example friction_angle = 30 (degrees)")

    @property
    def passive_coefficient(self) -> float:
        """Largest horizontal pressure over the vertical stress: ``passive``, else m_p K_p(phi); 0 without phi."""
        if self.passive is not None:
            return self.passive
        return 0.0 if self.friction_angle is None else self.mobilised * rankine(self.friction_angle)

    @property
    def passive_cohesion(self) -> float:
        """Part of the passive pressure that cohesion adds, m_p 2 c sqrt(K_p) [kN/m2]."""
        if not self.cohesion or self.passive_coefficient == 0:
            return 0.0
        k = self.passive if self.friction_angle is None else rankine(self.friction_angle)
        return 2.0 * self.mobilised * self.cohesion * math.sqrt(k or 0.0)

    @property
    def initial_coefficient(self) -> float:
        """Horizontal pressure before anything moves, over the vertical stress."""
        if self.pressure == "none" or self.friction_angle is None:
            return 0.0
        if self.pressure == "active":
            return 1.0 / rankine(self.friction_angle)
        return 1.0 - math.sin(math.radians(self.friction_angle))


def rankine(angle: float) -> float:
    """Return K_p = (1 + sin phi) / (1 - sin phi) of an angle in degrees."""
    s = math.sin(math.radians(angle))
    return (1.0 + s) / (1.0 - s)


def _friction_angle(value: float | str, where: str) -> float:
    angle = degrees(value, where=f"{where}, friction_angle")
    if not 0 <= angle < 60:
        msg = f"friction_angle = {angle:g} degrees must lie between 0 and 60"
        raise InputError(msg, where=where, hint="fills have some 25 to 45 degrees")
    if 0 < angle <= RADIANS:
        msg = f"friction_angle = {angle:g} degrees is implausible"
        hint = f"a bare number is in degrees: {math.degrees(angle):.3g}, or write '{angle:g} rad'"
        raise InputError(msg, where=where, hint=hint)
    return angle


def _weight(value: float | str, where: str) -> float:
    return not_negative("unit_weight", value, "unit weight", where)
