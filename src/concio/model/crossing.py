"""The vehicles that cross a bridge."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from concio.arguments import strict_class
from concio.errors import InputError
from concio.model.bounded import positive
from concio.units import quantity

STRETCH = 1.0
"""Footprints from this length on are stretches of uniform load, of which counts what stands on the road [m]."""
TONNES = 30.0
"""A bare axle load below this is reported as perhaps meant in tonnes [kN]."""


@strict_class
@dataclass(frozen=True)
class Axle:
    """An axle, or a stretch of uniform load.

    Parameters
    ----------
    at : float or str
        Middle, from the reference point of the vehicle; positive in the direction of travel [m].
    load : float or str
        Vertical force > 0 [kN]; of a stretch all of it.
    length : float or str or None
        Length of the footprint along the road [m]; None takes that of the vehicle.
    width : float or str or None
        Width over the wheels or of the sleeper [m]; None takes that of the vehicle.

    Examples
    --------
    >>> import concio
    >>> axle = concio.Axle(at=1.2, load="120 kN", width=2.5)
    >>> axle.load
    120.0
    """

    at: float
    load: float
    length: float | None = None
    width: float | None = None

    def __post_init__(self) -> None:
        where = "axle"
        object.__setattr__(self, "at", quantity(self.at, "length", where=f"{where}, at"))
        try:
            load = quantity(self.load, "force", where=f"{where}, load")
        except InputError as error:
            if "masses" not in (error.hint or ""):
                raise
            hint = "tonnes are a mass, not a force: write kN, or 'tf' for the weight of a tonne ('11.5 tf' is 112.8 kN)"
            raise InputError(error.what, where=error.where, hint=hint) from None
        if not 0 < load < math.inf or not math.isfinite(self.at):
            msg = f"load = {load:g} kN must be positive"
            raise InputError(msg, where=where, hint="loads act downwards")
        object.__setattr__(self, "load", load)
        for name in ("length", "width"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, positive(name, getattr(self, name), "length", where))


@strict_class
@dataclass(frozen=True)
class Vehicle:
    """A vehicle that crosses a bridge, its reference point at ``position``.

    Parameters
    ----------
    name : str
    axles : sequence of Axle
    position : float or str or None
        Coordinate x of the reference point [m]; None leaves the vehicle where the search will put it, and puts no load
        on the model.
    footprint : float or str
        Length of the contact of a wheel along the road, or of a sleeper [m].
    width : float or str
        Width over the wheels, or length of a sleeper [m].
        A spread rule takes the narrowest of all axles.
    direction : {"right", "left", "both"}
        Direction of travel; a search that is to try both takes "both", and a position then looks to the right.
    dynamic : float
        Factor >= 1 by which loads are multiplied for dynamic effects.
    factor : float
        Partial or conversion factor of the loads > 0.
    group : str
        Load group of the vehicle.
    source : str
        Where the axles come from.
    assumed : str
        What the source left open and was assumed.
    unfavourable : bool
        Whether its stretches of uniform load stand only where they are unfavourable, as codes prescribe: a search over
        positions looks for that part of the road at each.
    loaded : sequence of (float, float) or None
        From where to where on the road its stretches of uniform load stand [m]; None is wherever they reach.

    Examples
    --------
    The dynamic factor multiplies both axles:

    >>> import concio
    >>> lorry = concio.Vehicle("lorry", axles=(concio.Axle(0.0, 60.0), concio.Axle(3.2, 100.0)), dynamic=1.2)
    >>> round(lorry.total, 6)
    192.0
    """

    name: str
    axles: tuple[Axle, ...]
    position: float | None = None
    footprint: float = 0.3
    width: float = 1.8
    direction: Literal["right", "left", "both"] = "right"
    dynamic: float = 1.0
    factor: float = 1.0
    group: str = "live"
    source: str = ""
    assumed: str = ""
    unfavourable: bool = False
    loaded: tuple[tuple[float, float], ...] | None = None

    def __post_init__(self) -> None:
        where = f"vehicle '{self.name}'"
        if not self.axles:
            msg = "it has no axles"
            raise InputError(msg, where=where, hint="give axles = [[place in m, load in kN], ...]")
        object.__setattr__(self, "axles", tuple(self.axles))
        for name in ("footprint", "width"):
            object.__setattr__(self, name, positive(name, getattr(self, name), "length", where))
        if self.position is not None:
            object.__setattr__(self, "position", quantity(self.position, "length", where=f"{where}, position"))
        if self.loaded is not None:
            object.__setattr__(self, "loaded", tuple(_part(p, where) for p in self.loaded))
        if self.direction not in ("right", "left", "both"):
            msg = f"direction = '{self.direction}' is not one of right, left, both"
            raise InputError(msg, where=where)
        if not 1.0 <= self.dynamic <= 3.0:
            msg = f"dynamic = {self.dynamic:g} must lie between 1 and 3"
            raise InputError(msg, where=where, hint="1.8 means 80 % more")
        if not 0 < self.factor < math.inf:
            msg = f"factor = {self.factor:g} must be positive"
            raise InputError(msg, where=where)

    @property
    def total(self) -> float:
        """All of its load, with its factors [kN]."""
        return self.dynamic * self.factor * sum(axle.load for axle in self.axles)

    @property
    def points(self) -> tuple[Axle, ...]:
        """Its axles, without stretches of uniform load."""
        return tuple(a for a in self.axles if a.length is None or a.length < STRETCH)

    @property
    def uniform(self) -> tuple[float, ...]:
        """Load per length of each stretch of uniform load, without factors [kN/m]."""
        return tuple(a.load / a.length for a in self.axles if a.length is not None and a.length >= STRETCH)

    @property
    def narrowest(self) -> float:
        """Least width over the wheels of its axles and stretches of uniform load [m]."""
        return min(self.width if axle.width is None else axle.width for axle in self.axles)

    @property
    def heaviest(self) -> Axle:
        """The axle of the largest load, of several the first; stretches of uniform load only where nothing else is."""
        return max(self.points or self.axles, key=lambda axle: axle.load)

    def footprints(self, position: float, direction: str = "") -> tuple[tuple[float, float, float, bool], ...]:
        """Return of each axle middle x [m], length [m], load with all factors [kN], and whether it is a stretch.

        Examples
        --------
        >>> import concio
        >>> lorry = concio.Vehicle("lorry", axles=(concio.Axle(0.0, 60.0), concio.Axle(3.2, 100.0)))
        >>> [place[0] for place in lorry.footprints(10.0)]
        [10.0, 13.2]
        """
        sign = -1.0 if (direction or self.direction) == "left" else 1.0
        found: list[tuple[float, float, float, bool]] = []
        for a in self.axles:
            x, load = position + sign * a.at, self.dynamic * self.factor * a.load
            if a.length is None or a.length < STRETCH:
                found.append((x, self.footprint if a.length is None else a.length, load, False))
                continue
            whole = x - 0.5 * a.length, x + 0.5 * a.length
            for low, high in (whole,) if self.loaded is None else self.loaded:
                begin, end = max(low, whole[0]), min(high, whole[1])
                if end > begin:
                    found.append((0.5 * (begin + end), end - begin, load * (end - begin) / a.length, True))
        return tuple(found)


def _part(given: Sequence[float], where: str) -> tuple[float, float]:
    """Return a part of the road.

    Raises
    ------
    InputError
        It does not go from less to more.
    """
    if len(given) != 2:
        msg = f"loaded has {list(given)}, which is not a part of the road"
        raise InputError(msg, where=where, hint="write [from, to] in m")
    low, high = (quantity(v, "length", where=f"{where}, loaded") for v in given)
    if not low < high:
        msg = f"loaded goes from {low:g} to {high:g} m"
        raise InputError(msg, where=where, hint="write [from, to], the smaller x first")
    return low, high
