"""What a push is asked for: load groups, direction, control; and what is said where a structure does not stand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.statics import Balanced
from concio.analysis.motion.velocities import Frames
from concio.arguments import closest
from concio.contact.factors import load_factor, once
from concio.contact.reference import Reference
from concio.errors import InputError
from concio.model.stages import ControlPoint

Array = np.ndarray

LIVE = "live"
"""Load group that is multiplied unless another is named."""

ASIDE = 1e-6
"""Share of a resultant along a direction below which it points aside."""


def what_moves(reference: Reference, found: Balanced) -> tuple[str, tuple[str, ...]]:
    """Return words on the block that moves away most and how many others go with it, and the names of them all."""
    size = np.abs(found.moved)
    offsets = reference.disc.offsets
    away = {b: float(size[offsets[b] : offsets[b + 1]].max()) for b in reference.free.tolist()}
    first = max(away, key=away.__getitem__)
    if not away[first] > 0:
        return "", ()
    bodies = reference.model.bodies
    names = (bodies[first].name, *(bodies[b].name for b, v in away.items() if b != first and v > 0.1 * away[first]))
    others = len(names) - 1
    return f": '{names[0]}' moves away" + (f", and {others} other{'s' if others > 1 else ''}" if others else ""), names


def control_asked(control: object) -> tuple[ControlPoint | None, bool]:
    """Return the point that controls, if one does, and whether the load does."""
    if isinstance(control, ControlPoint):
        return control, False
    if control is not None and control != "load":
        msg = f"control = {control!r} is neither a ControlPoint nor 'load'"
        raise InputError(msg, hint="leave it out for the mean displacement on which the load works")
    return None, control == "load"


def positive(value: float, name: str) -> float:
    """Return a number that was given; raise where it is not positive and finite."""
    if not 0 < value < np.inf:
        msg = f"{name} = {value:g} must be positive and finite"
        raise InputError(msg)
    return float(value)


def factors_asked(reference: Reference, factors: Mapping[str, float] | None) -> dict[str, float]:
    """Return load factors that were given; raise where a group is not known."""
    chosen, known = dict(factors or {}), list(reference.model.load_groups)
    for group in chosen:
        if group not in known:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, where="factors", hint=closest(group, known, names="groups"))
    return chosen


def live_asked(reference: Reference, live: str | Sequence[str] | None) -> tuple[str, ...]:
    """Return the load groups that are multiplied; none where the weights are."""
    known = list(reference.model.load_groups)
    if live is None:
        return (LIVE,) if LIVE in known else ()
    wanted = once(live)
    for group in wanted:
        if group not in known:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, where="live", hint=closest(group, known, names="groups"))
    return wanted


def direction_asked(direction: float | Sequence[float], dim: int) -> Array:
    """Return the unit vector (d,) of a direction that was given; a horizontal one in space may have two components."""
    try:
        given = np.array([direction] if np.ndim(direction) == 0 else direction, dtype=float)
    except (TypeError, ValueError):
        given = np.zeros(0)  # words, or rows of different lengths
    size = float(np.linalg.norm(given)) if given.shape in ((1,), (2,), (dim,)) else np.nan
    if not 0 < size < np.inf:
        msg = f"direction = {direction} is not a direction"
        hint = "1 or -1 along x, or (x, y)" if dim == 2 else "1 or -1 along x, a horizontal (x, y), or (x, y, z)"
        raise InputError(msg, hint=hint)
    along: Array = np.append(given, np.zeros(dim - len(given))) / size
    return along


def side_asked(
    reference: Reference, groups: tuple[str, ...], factors: Mapping[str, float], along: Array | None
) -> float:
    """Return the sign with which load groups grow, so that they push along a direction that was asked for."""
    if along is None or not groups:
        return 1.0
    only = {g: load_factor(factors, g) if g in groups else 0.0 for g in reference.loads.groups}
    unit = reference.loads.forces(only, reference.at_rest().placement.turns)
    force = unit[Frames(reference, Scheme()).places].sum(axis=0)
    part = float(force @ along)
    if abs(part) <= ASIDE * float(np.linalg.norm(force)) or not part:
        way = ", ".join(f"{v:g}" for v in along)
        msg = f"the loads of {', '.join(groups)} have no resultant along the direction ({way})"
        hint = "leave the direction out, or multiply a share of the weights: live=(), on the command line --weights"
        raise InputError(msg, where="direction", hint=hint)
    return float(np.sign(part))
