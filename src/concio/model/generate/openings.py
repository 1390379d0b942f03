"""Doors and windows in a wall, and the lintels over them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from concio.arguments import strict_class
from concio.errors import InputError
from concio.model.generate.generator_arguments import check_keys, finite, not_negative, positive


@strict_class
@dataclass(frozen=True)
class Opening:
    """A rectangular hole in a wall, with a lintel over it or none.

    Parameters
    ----------
    x, y : float or str
        Lower left corner, from the lower left corner of the wall [m]; y = 0 is a door.
    width, height : float or str
        [m].
    lintel : float or str
        Height of the lintel [m]; 0 leaves it out, and the blocks above must carry themselves.
    bearing : float or str
        Length of the lintel's bearing on each side [m].

    Examples
    --------
    A window of 1 m2 in a wall of 9 m2:

    >>> import concio
    >>> from concio.generate import Opening
    >>> window = Opening(x=1.0, y=1.0, width=1.0, height=1.0, lintel=0.25)
    >>> model = concio.wall(length=3.0, height=3.0, block_size=(0.5, 0.25), openings=[window])
    >>> round(sum(block.area for block in model.free_bodies), 6)
    8.0
    """

    x: float
    y: float
    width: float
    height: float
    lintel: float = 0.0
    bearing: float = 0.2

    def __post_init__(self) -> None:
        for name, check in (
            ("x", finite), ("y", not_negative), ("width", positive), ("height", positive), ("lintel", not_negative),
            ("bearing", positive),
        ):  # fmt: skip
            object.__setattr__(self, name, check("opening", name, getattr(self, name)))

    @property
    def top(self) -> float:
        """Height of the head of the opening [m]."""
        return self.y + self.height

    @property
    def holes(self) -> tuple[tuple[float, float, float, float], ...]:
        """Rectangles (x0, x1, y0, y1) that the courses leave out: the opening, and its lintel."""
        hole = (self.x, self.x + self.width, self.y, self.top)
        if not self.lintel:
            return (hole,)
        return (hole, (self.x - self.bearing, self.x + self.width + self.bearing, self.top, self.top + self.lintel))


def checked_openings(
    where: str, openings: Sequence[Opening | Mapping[str, Any]], length: float, height: float
) -> tuple[Opening, ...]:
    """Return the openings, each inside a wall of ``length`` and ``height`` and clear of the others.

    Raises
    ------
    InputError
        Unknown key, an opening or its lintel beyond the wall, or two openings that overlap.
    """
    result: list[Opening] = []
    for number, item in enumerate(openings, 1):
        place = f"{where}, opening {number}"
        if not isinstance(item, Opening):
            check_keys(place, item, Opening)
            missing = [name for name in ("x", "y", "width", "height") if name not in item]
            if missing:
                msg = f"{missing[0]} is missing"
                raise InputError(msg, where=place, hint="an opening needs x, y, width and height in m")
            item = Opening(**item)
        tiny = 1e-9 * (length + height)
        if item.x < -tiny or item.x + item.width > length + tiny or item.top > height + tiny:
            corner = f"({item.x + item.width:g}, {item.top:g}) m"
            msg = f"the opening from ({item.x:g}, {item.y:g}) to {corner} leaves the wall"
            raise InputError(msg, where=place, hint=f"the wall is {length:g} m long and {height:g} m high")
        if item.lintel:
            x0, x1, _, top = item.holes[1]
            if x0 < -tiny or x1 > length + tiny or top > height + tiny:
                msg = f"its lintel, from x = {x0:g} to {x1:g} m and up to y = {top:g} m, leaves the wall"
                raise InputError(msg, where=place, hint="give a shorter bearing or a lower lintel")
        for other_number, other in enumerate(result, 1):
            for a in item.holes:
                for b in other.holes:
                    if min(a[1], b[1]) - max(a[0], b[0]) > tiny and min(a[3], b[3]) - max(a[2], b[2]) > tiny:
                        msg = f"it overlaps opening {other_number} (or one of the lintels does)"
                        raise InputError(msg, where=place, hint="move them apart")
        result.append(item)
    return tuple(result)
