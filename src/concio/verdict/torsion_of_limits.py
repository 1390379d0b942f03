"""Joints that twist as a structure in space begins to move: what that does to limit loads, and what would settle it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from concio.contact.patch_points import SPREADING
from concio.display import counted
from concio.problem.limits_of_work import LARGEST_SEARCH
from concio.verdict.attention import MOTION_TURNED

if TYPE_CHECKING:
    from concio.analysis.limit_result import LimitResult


def twisting_joints(found: LimitResult) -> str:
    """Return how many joints twist, as in ``"3 joints twist"``."""
    return f"{counted(found.twisting, 'joint')} {'twists' if found.twisting == 1 else 'twist'}"


def torsion_open(found: LimitResult) -> bool:
    """Return whether joints at whose corners contact is stated twist, and their pressure was not spread."""
    return bool(found.twisting) and (found.spread is None or not found.spread.steps.multipliers)


def unless_torsion(found: LimitResult) -> str:
    """Return what the design value is subject to; empty where nothing is open."""
    return f", unless torsion governs ({twisting_joints(found)})" if torsion_open(found) else ""


def torsion_words(found: LimitResult) -> str:
    """Return what joints that twist do to the numbers, and what would spread their pressure where that was not done."""
    number, verb = twisting_joints(found).rsplit(" ", 1)
    corners = f"with contact at {'its' if found.twisting == 1 else 'their'} corners"
    joints = f"{number} {corners} {verb} as the structure begins to move"
    strong = f"friction resists torsion there up to {MOTION_TURNED:g} times better than under uniform pressure"
    if not torsion_open(found):
        return f"{joints}: {strong}; the design value does not include that"
    if found.spread is not None or not math.isfinite(found.associated.multiplier):
        more = "no load steps with that pressure were found; contact_points = 4 in the model spreads it"
    elif min(SPREADING) ** 2 * len(found.assembly.detection.interfaces) <= LARGEST_SEARCH:
        more = "load steps with that pressure are taken on request (--steps)"
    else:
        more = "the model is too large to repeat its load steps so; contact_points = 4 in the model spreads it"
    return f"whether torsion governs: {joints}, and {strong}, by which all numbers may be too large; {more}"
