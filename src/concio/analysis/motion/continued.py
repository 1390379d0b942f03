"""A motion that goes on from the end of an earlier one: whether both are of the same bodies on the same ground."""

from __future__ import annotations

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.ground_motion import Ground
from concio.analysis.motion.state import MotionState
from concio.contact.factors import load_factor
from concio.contact.reference import Reference
from concio.errors import InputError
from concio.model.body import Body
from concio.model.file.writing import dumps
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron

SAME = 1e-6
"""Corners nearer than this share of the size of the model are the same."""


SAME_SPEED = 1e-6
"""Velocities of the ground that differ by less are the same [m/s]."""


def goes_on(earlier: Model, model: Model, where: str) -> list[str]:
    """Return what is to be said of a motion of ``model`` that begins where one of ``earlier`` ended.

    The state at its end says where every body is, by number; other bodies would stand at places of these.

    Raises
    ------
    InputError
        Bodies or ties are not the same, in the same order.
    """
    for what, before, now in (("block", earlier.bodies, model.bodies), ("tie", earlier.ties, model.ties)):
        names = [[one.name for one in things] for things in (before, now)]
        if names[0] != names[1]:
            msg = f"the {what}s of that motion are not those of this model, in this order"
            raise InputError(msg, where=where, hint="continue a motion with the model it was computed for")
    for old, new in zip(earlier.bodies, model.bodies, strict=True):
        if not _same(old, new, SAME * model.size):
            msg = f"block '{new.name}' is not the one of that motion: its shape or its place was changed"
            raise InputError(msg, where=where, hint="continue a motion with the model it was computed for")
    if dumps(earlier) != dumps(model):
        return ["the model is not that of the earlier motion: what was changed acts from the end of that motion on"]
    return []


def otherwise(before: DynamicsResult, now: DynamicsResult) -> list[str]:
    """Return what a motion has otherwise than the one it goes on from: load factors, gravity, impacts, damping."""
    groups = dict.fromkeys((*before.factors, *now.factors))
    told = [f"{g} x {load_factor(before.factors, g):g}" for g in groups
            if load_factor(before.factors, g) != load_factor(now.factors, g)]  # fmt: skip
    if before.gravity != now.gravity:
        told.append(f"gravity {before.gravity:.6g} m/s2")
    for name in ("restitution", "theta", "mass_damping", "stiffness_damping"):
        own = getattr(before.scheme, name)
        if own != getattr(now.scheme, name):
            told.append(f"{name.replace('_', ' ')} {own:g}")
    return [f"the earlier motion had {', '.join(told)}: what is stated here acts from its end on"] if told else []


def _same(old: Body | Polyhedron, new: Body | Polyhedron, near: float) -> bool:
    """Return whether two bodies are of the same kind and have the same corners."""
    if type(old) is not type(new) or old.kind != new.kind or old.vertices.shape != new.vertices.shape:
        return False
    if np.abs(old.vertices - new.vertices).max() > near:
        return False
    return not (isinstance(old, Body) and isinstance(new, Body)) or abs(old.thickness - new.thickness) <= near


def check_ground(reference: Reference, state: MotionState, ground: Ground, base: str, step: float) -> list[str]:
    """Return what is to be said of the ground where a motion goes on from an earlier one.

    Velocities of a state are those of the earlier motion: seen from the ground with forces of inertia, and not with a
    base that moves.

    Raises
    ------
    InputError
        The ground moved with a velocity in the earlier motion, and this one is seen from it, or vice versa.
    """
    fixed = [b for b, body in enumerate(reference.model.bodies) if body.kind == "fixed"]
    if not fixed:
        return []
    before = state.velocity[fixed[0]]
    times = state.time + step * np.linspace(-2.0, 2.0, 9)
    now = ground.velocity(times[4:5])[0] if base == "moving" else np.zeros_like(before)
    change = step * float(np.abs(ground.acceleration(times)).max()) if base == "moving" else 0.0
    if ground.turning or float(np.abs(now - before).max()) <= 2.0 * change + SAME_SPEED:
        return []
    was, comes = (f"{float(np.linalg.norm(v)):.4g} m/s" for v in (before, now))
    if base == "inertia":
        msg = f"the ground moved at {was} at the end of the earlier motion, and this one is seen from the ground"
        raise InputError(msg, where="base", hint='go on with base="moving", as the earlier motion')
    if not before.any():
        msg = f"the ground moves at {comes} at {state.time:g} s, and in the earlier motion the fixed bodies stood still"
        raise InputError(msg, where="base", hint='go on with base="inertia", as the earlier motion')
    return [f"the ground moved at {was} at the end of the earlier motion and moves at {comes} from there on"]
