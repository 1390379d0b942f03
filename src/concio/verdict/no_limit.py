"""Where no limit was found: a large multiple carried by joints that never crush, in the part that the load acts on."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from concio.verdict.question import Loaded, body_forces
from concio.verdict.unseen import connected

if TYPE_CHECKING:
    from concio.analysis.limit_result import LimitResult

HUGE = 1e3
"""Multiplied loads over all constant ones of their part from which on a number says only that nothing crushes."""

SAME = 1e-6
"""Multipliers closer than this, relative, are one number in words."""


def without_limit(found: LimitResult) -> float:
    """Return the multiplied loads carried over the constant ones where that says only that nothing crushes; else 0.

    It is asked of each connected part on which multiplied loads act, and the largest counts: what stands beside it
    weighs nothing here, and may crush.
    """
    if math.isnan(found.design) or found.collapse_shown:
        return 0.0
    if found.design < found.carried * (1 - SAME) or not found.associated.locked:
        return 0.0
    assembly = found.assembly
    part = connected(assembly.model, assembly.detection)
    share = found.design * _largest_share(assembly, part, found.groups, _crushes(found, part))
    return share if share > HUGE else 0.0


def _crushes(found: LimitResult, part: np.ndarray) -> np.ndarray:
    """Return which parts have a joint that crushes; the fill beside a ring has caps of its own and is none."""
    pairs, joints = found.assembly.pairs, found.assembly.detection.interfaces
    crushing = np.unique(np.asarray(pairs.interface)[np.isfinite(found.assembly.laws.cap)])
    model = found.assembly.model
    shown = np.zeros(part.max(initial=0) + 1, dtype=bool)
    for k in crushing[crushing >= 0]:
        ends = [b for b in (joints[k].a, joints[k].b) if model.bodies[b].kind != "fixed"]
        shown[part[ends]] = True
    return shown


def _largest_share(loaded: Loaded, part: np.ndarray, multiplied: tuple[str, ...], left_out: np.ndarray) -> float:
    """Return the largest ratio of multiplied to constant loads, at factor 1, of the parts that are not left out."""
    count = len(left_out)
    live, constant = np.zeros(count), np.zeros(count)
    for group, f in loaded.loads.items():
        forces = body_forces(loaded, f)
        total = np.array([np.bincount(part, weights=column, minlength=count) for column in forces.T])
        size = np.bincount(part, weights=np.linalg.norm(forces, axis=1), minlength=count)
        resultant = np.linalg.norm(total, axis=0)
        (live if group in multiplied else constant)[:] += np.where(resultant > 1e-9 * size, resultant, size)
    asked = (live > 0) & (constant > 0) & ~left_out
    return float(np.max(live[asked] / constant[asked], initial=0.0))
