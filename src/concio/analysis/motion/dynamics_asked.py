"""What a motion is asked for: duration, step, initial velocities; and what is refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from concio.analysis.motion.ground_motion import Ground
from concio.analysis.motion.state import MotionState
from concio.contact.reference import Reference
from concio.errors import InputError
from concio.kinematics.rigid import motions, swept
from concio.problem.limits_of_work import MOTION_STEPS

STEP = 2e-3
"""Step where none is given and no record is finer [s]."""


def positive(value: float, name: str) -> float:
    """Return a number that was given; raise where it is not positive and finite."""
    if not 0 < value < np.inf:
        msg = f"{name} = {value:g} must be positive and finite"
        hint = "give the time to compute, or a ground motion" if name == "duration" else None
        raise InputError(msg, hint=hint)
    return float(value)


def step_asked(step: float | None, ground: Ground, duration: float) -> float:
    """Return the step that was asked for, or the usual one; raise where the ground would not be seen in it."""
    if step is None:
        return min(STEP, ground.sample, duration)
    step = positive(step, "step")
    if step > ground.sample * (1 + 1e-9):
        most = f"that of the record or a quarter of a half wave, {ground.sample:g} s"
        msg = f"the step of {step:g} s is larger than {most}"
        raise InputError(msg, hint=f"take at most {ground.sample:g} s: what happens between would be lost")
    return min(step, duration)


def check_length(duration: float, step: float) -> None:
    """Refuse a motion of more steps than can be computed and kept."""
    if duration > MOTION_STEPS * step:
        msg = f"a motion of {duration:g} s has {duration / step:.2g} steps of {step:g} s"
        raise InputError(msg, where="duration", hint=f"at most {MOTION_STEPS:,}: take a shorter one, or larger steps")


def check_masses(reference: Reference) -> None:
    """Refuse bodies without mass."""
    without = [reference.model.bodies[b].name for b in reference.free.tolist() if not reference.body_mass[b] > 0]
    if without:
        others = len(without) - 1
        more = f", and {others} other{'s' if others > 1 else ''}" if others else ""
        msg = f"block '{without[0]}' has no mass{more}"
        raise InputError(msg, hint="give its material a unit_weight: mass is weight over gravity")


def check_base(reference: Reference, base: str, *, turning: bool) -> None:
    """Refuse a base that does not take along what it should: ties to what is fixed, and supports where it turns."""
    if base not in ("inertia", "moving"):
        msg = f"base = '{base}' is not 'inertia' or 'moving'"
        raise InputError(msg)
    if base == "inertia":
        if turning:
            msg = "a rotation of the ground needs a base that moves"
            raise InputError(msg, where="motion", hint='give base="moving"')
        return
    fixed = {b.name for b in reference.model.bodies if b.kind == "fixed"} | {""}
    for tie in reference.model.ties:
        if tie.body_a in fixed or tie.body_b in fixed:
            msg = f"tie '{tie.name}' ends at what is fixed: a base that moves does not stretch it"
            raise InputError(msg, where="base", hint='give base="inertia", without rotations, or leave the tie out')
    for support in reference.model.supports:
        if turning and support.body not in fixed:
            msg = f"support '{support.name}' holds '{support.body}': it does not turn with the base"
            raise InputError(msg, where="motion", hint="leave the rotations of the ground out, or the support")


def thrown(reference: Reference, state: MotionState, velocities: Mapping[str, Sequence[float]]) -> MotionState:
    """Return a state with other velocities of some bodies."""
    number = {b.name: i for i, b in enumerate(reference.model.bodies)}
    velocity, spin, nodal = state.velocity.copy(), state.spin.copy(), state.nodal.copy()
    for name, given in velocities.items():
        if name not in number or reference.model.bodies[number[name]].kind == "fixed":
            msg = f"there is no body called '{name}' that can move"
            raise InputError(msg, where="velocities", hint="see the names with 'concio check'")
        values, d = [float(v) for v in given], reference.disc.dim
        if len(values) not in (d, motions(d)) or not np.isfinite(values).all():
            words = "(v_x, v_y) or (v_x, v_y, spin)" if d == 2 else "(v_x, v_y, v_z) or (v_x, v_y, v_z, w_x, w_y, w_z)"
            msg = f"the velocity of '{name}' is {words}, all finite"
            raise InputError(msg, where="velocities")
        b = number[name]
        turn = values[d:] or [0.0] * (motions(d) - d)
        velocity[b], spin[b] = values[:d], turn[0] if d == 2 else turn
        if reference.disc.shape_of[b] >= 0:
            own = np.flatnonzero(reference.body_of_node == b)
            placed = state.configuration(reference).nodes(b) - state.centre[b]
            nodal[own] = velocity[b] + swept(spin[b], placed)
    return replace(state, velocity=velocity, spin=spin, nodal=nodal)
