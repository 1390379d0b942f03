r"""Checks of the anchor of a tie: steel, punching and bearing of the wall under its plate, cone of the masonry.

With the force T of the tie, the plate b x h, the wall of thickness t and design strengths,

.. math::

    T \le A_s f_s, \qquad T \le 2\,[(b + t) + (h + t)]\, t\, f_v, \qquad T \le b\,h\,f_m, \qquad
    T \le \pi\, l\,(l + D)\, f_v

steel; punching on the control section of a cone at 45 degrees, half way through the wall; bearing; and for an anchor
bonded over the depth l in a hole D the cone at 45 degrees that it pulls out. Strengths are given as design values.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from concio.arguments import closest
from concio.errors import InputError
from concio.model.model import Model


@dataclass(frozen=True)
class AnchorCheck:
    """One line of the checks of an anchor.

    Parameters
    ----------
    kind : {"steel", "punching", "bearing", "cone"}
    capacity, demand : float
        [kN].
    """

    kind: str
    capacity: float
    demand: float

    @property
    def ratio(self) -> float:
        """Capacity over demand."""
        return self.capacity / self.demand if self.demand > 0 else math.inf

    @property
    def holds(self) -> bool:
        """Whether capacity is not less than demand."""
        return self.demand <= self.capacity


@dataclass(frozen=True)
class Anchor:
    """The anchor of a tie; what is not given is not checked.

    Parameters
    ----------
    tie : str
        Name of the tie.
    steel_area : float, optional
        [m2].
    steel_strength : float, optional
        [kN/m2].
    plate : (b, h), optional
        Sides of the plate [m].
    wall_thickness : float, optional
        t [m].
    shear_strength, bearing_strength : float, optional
        Of the masonry [kN/m2].
    depth, hole : float, optional
        l and D of a bonded anchor [m].
    """

    tie: str
    steel_area: float | None = None
    steel_strength: float | None = None
    plate: tuple[float, float] | None = None
    wall_thickness: float | None = None
    shear_strength: float | None = None
    bearing_strength: float | None = None
    depth: float | None = None
    hole: float | None = None

    def check(self, model: Model, where: str) -> None:
        """Refuse an anchor of a tie that does not exist, that has sizes that are not positive, or nothing to check.

        Raises
        ------
        InputError
        """
        names = [t.name for t in model.ties]
        if self.tie not in names:
            msg = f"there is no tie called '{self.tie}'"
            raise InputError(msg, where=where, hint=closest(self.tie, names) if names else "add one under [[ties]]")
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            numbers = value if isinstance(value, tuple) else (value,) if isinstance(value, float) else ()
            if any(not 0 < v < math.inf for v in numbers):
                msg = f"{name} = {value} must be positive"
                raise InputError(msg, where=where)
        if not self.capacities:
            msg = "this anchor has no data to check"
            hint = "steel: steel_area and steel_strength; punching: plate, wall_thickness and shear_strength"
            raise InputError(msg, where=where, hint=hint)

    @property
    def capacities(self) -> dict[str, float]:
        """What each check allows [kN]."""
        found = {}
        if self.steel_area is not None and self.steel_strength is not None:
            found["steel"] = self.steel_area * self.steel_strength
        if self.plate is not None and self.wall_thickness is not None and self.shear_strength is not None:
            (b, h), t = self.plate, self.wall_thickness
            found["punching"] = 2.0 * ((b + t) + (h + t)) * t * self.shear_strength
        if self.plate is not None and self.bearing_strength is not None:
            found["bearing"] = self.plate[0] * self.plate[1] * self.bearing_strength
        if self.depth is not None and self.shear_strength is not None:
            found["cone"] = math.pi * self.depth * (self.depth + (self.hole or 0.0)) * self.shear_strength
        return found

    def checks(self, force: float) -> tuple[AnchorCheck, ...]:
        """Return the checks under the force of the tie [kN]."""
        return tuple(AnchorCheck(kind, capacity, force) for kind, capacity in self.capacities.items())
