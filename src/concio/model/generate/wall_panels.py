"""Panels of a wall: rectangles with a bond and openings of their own, side by side or on each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from concio.arguments import strict_class
from concio.errors import InputError
from concio.model.generate.bonds import Course
from concio.model.generate.generator_arguments import check_keys, finite, positive, two
from concio.model.generate.openings import Opening

Bond = str | Sequence[Course | Sequence[float]]


@strict_class
@dataclass(frozen=True)
class Panel:
    """One rectangular part of a wall, with a bond of its own.

    Parameters
    ----------
    length, height : float or str
        [m].
    at : (x, y)
        Lower left corner [m].
    bond : str or sequence, optional
        As in :func:`concio.wall`; None takes the wall's.
    openings : sequence of Opening or mapping
        Measured from the panel's own corner.

    Examples
    --------
    A panel of 1 by 0.5 m on a wall of 2 by 1 m:

    >>> import concio
    >>> from concio.generate import Panel
    >>> panels = [Panel(length=2.0, height=1.0), Panel(length=1.0, height=0.5, at=(0.5, 1.0))]
    >>> model = concio.wall(block_size=(0.5, 0.25), panels=panels)
    >>> round(sum(block.area for block in model.free_bodies), 6)
    2.5
    """

    length: float
    height: float
    at: tuple[float, float] = (0.0, 0.0)
    bond: Bond | None = None
    openings: Sequence[Opening | Mapping[str, Any]] = ()


def checked_panels(
    where: str,
    panels: Sequence[Panel | Mapping[str, Any]],
    length: float | str | None,
    height: float | str | None,
    openings: Sequence[Opening | Mapping[str, Any]],
) -> list[Panel]:
    """Return the panels with their numbers checked; one panel where none are given."""
    if panels and (length is not None or height is not None or openings):
        msg = "panels are given together with length, height or openings"
        raise InputError(msg, where=where, hint="give each panel its own length, height, at and openings")
    if not panels:
        for name, value in (("length", length), ("height", height)):
            if value is None:
                msg = f"{name} is missing"
                raise InputError(msg, where=where, hint="give length and height of the wall in m")
        panels = [{"length": length, "height": height, "openings": openings}]
    result = []
    for number, item in enumerate(panels, 1):
        place = f"{where}, panel {number}"
        if not isinstance(item, Panel):
            check_keys(place, item, Panel)
            if "length" not in item or "height" not in item:
                msg = "length or height is missing"
                raise InputError(msg, where=place)
            item = Panel(**item)
        x, y = (finite(place, "at", v) for v in two(place, "at", item.at))
        result.append(
            Panel(
                positive(place, "length", item.length), positive(place, "height", item.height), (x, y), item.bond,
                item.openings,
            )
        )  # fmt: skip
    for p in range(len(result)):
        for q in range(p):
            a, b = result[p], result[q]
            common = [min(a.at[k] + e, b.at[k] + f) - max(a.at[k], b.at[k]) for k, e, f in
                      ((0, a.length, b.length), (1, a.height, b.height))]  # fmt: skip
            if min(common) > 1e-9:
                msg = f"panels {q + 1} and {p + 1} overlap by {common[0]:.4g} x {common[1]:.4g} m"
                raise InputError(msg, where=where, hint="move one of them with 'at'")
    return result
