"""What contact pairs remember of a step or of an equilibrium, and the energy they took in it.

The slip of a step is partly elastic (of compliant joints, their own or added) and partly plastic; plastic slip opens
joints that dilate and breaks brittle bonds. What presses a pair beyond its cap crushes it. The work of the forces goes,
but for what the springs store, into friction, impacts, damping and crushing.

Along the normal a hard pair works where it is hit: at half of 1 - e times the velocity of the impact, which is never a
gain. What the others work, for they sink into the compliance added to them and turn within a step, is drift. Where
friction at what is hit turns a slip back it gives, and takes what the impact gives it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.analysis.motion.joint_step import JointAnswer, JointStep, PairData
from concio.analysis.motion.joints import Joints
from concio.analysis.motion.state import Memory
from concio.kinematics.frames import dot, norm
from concio.problem.pair_state import Normal

Array = np.ndarray


def after_step(
    joints: Joints, memory: Memory, step: JointStep, data: PairData, found: JointAnswer, h: float
) -> tuple[Memory, dict[str, float]]:
    """Return what pairs remember after a step, and the energy they took by column [kN m].

    Parameters
    ----------
    joints : Joints
    memory : Memory
        At the beginning.
    step : JointStep
    data : PairData
    found : JointAnswer
    h : float
        [s].
    """
    y, t = found.motion, found.force
    contact, slip = np.where(data.active, found.contact, np.int8(Normal.OPEN)), found.slip
    lost_n, lost_t = -h * t[:, 0] * y[:, 0], -h * dot(t[:, 1:], y[:, 1:])
    slid, stretch, stuck = _plastic_slip(memory, step, t, contact, slip, h * y[:, 1:])
    raised, damped = memory.raised, 0.0
    if data.dilatancy.any():
        lifted = data.dilatancy * norm(slid)
        raised, lost_n, lost_t = raised + lifted, lost_n + t[:, 0] * lifted, lost_t - t[:, 0] * lifted
    sunk = step.sunk + h * y[:, 0] - (raised - memory.raised)
    crushing, squeezed, crushed = memory.crushing, np.zeros(len(t)), 0.0
    if joints.any_cap:
        yields = np.where(step.springy, -step.a_n * data.cone.cap - sunk, -h * y[:, 0])
        squeezed = np.where(contact == Normal.CRUSHED, np.maximum(yields, 0.0), 0.0)
        crushing, crushed = crushing + squeezed, float((t[:, 0] * squeezed).sum())
    broken, stored = _broken(joints, memory, step, contact, slip), step.stored
    if step.springs is not None:
        springs, active = step.springs.broken(broken), data.active
        away = np.maximum(sunk, joints.reach)  # what touches nothing is not pressed
        sunk = np.where(active, sunk + squeezed, away)
        after, before = springs.parts(sunk, stretch), step.springs.parts(step.sunk, memory.stretch)
        stored = np.where(active, after[0] + after[1], 0.0)
        lost_n = lost_n - np.where(active, after[0] - before[0], 0.0)
        lost_t = lost_t - np.where(active, after[1] - before[1], 0.0)
        if joints.scheme.stiffness_damping:
            stuck = stuck & springs.shear
            damped = float(lost_n[springs.normal].sum() + lost_t[stuck].sum())
            lost_n, lost_t = np.where(springs.normal, 0.0, lost_n), np.where(stuck, 0.0, lost_t)
    new = replace(
        memory, contact=contact, slip=slip, force=t, stretch=stretch, crushing=crushing, raised=raised,
        broken=broken, slid=memory.slid + slid, area=step.area, sunk=sunk, stored=stored,
    )  # fmt: skip
    smooth = ~(step.springy | step.struck)
    gained = -float((lost_n - t[:, 0] * squeezed)[smooth].sum())
    back = -min(float(lost_t[step.struck].sum()), 0.0)
    works = {
        "friction": float(lost_t.sum()) + back,
        "impact": float(lost_n.sum()) - crushed + gained - back,
        "damping": damped,
        "crushing": crushed,
        "overlap": step.overlap - float(memory.stored.sum()) if joints.any_stiffness else 0.0,
        "drift": step.drift + gained,
    }
    return new, works


def after_equilibrium(
    joints: Joints, memory: Memory, step: JointStep, data: PairData, found: JointAnswer
) -> Memory:
    """Return what pairs remember of an equilibrium.

    Parameters
    ----------
    joints : Joints
    memory : Memory
        Of the last one.
    step : JointStep
    data : PairData
    found : JointAnswer
    """
    y, t = found.motion, found.force
    contact, slip = np.where(data.active, found.contact, np.int8(Normal.OPEN)), found.slip
    touches = contact != Normal.OPEN
    stretch = np.where(touches[:, None], -step.a_t[:, None] * t[:, 1:], 0.0)
    slid = np.where((touches & slip.any(axis=1))[:, None], y[:, 1:] - stretch, 0.0)
    crushing = memory.crushing
    if joints.any_cap:
        depth = -(y[:, 0] + step.a_n * t[:, 0])
        crushing = crushing + np.where(contact == Normal.CRUSHED, np.maximum(depth, 0.0), 0.0)
    sunk = stored = np.zeros(len(t))
    if step.springs is not None:
        sunk = np.where(touches, -step.a_n * t[:, 0], np.maximum(y[:, 0], step.springs.longest))
        stored = np.where(touches, step.springs.stored(sunk, stretch), 0.0)
    return replace(
        memory, contact=contact, slip=slip, force=t, stretch=stretch, crushing=crushing,
        raised=memory.raised + data.dilatancy * norm(slid), broken=_broken(joints, memory, step, contact, slip),
        slid=memory.slid + slid, area=step.area, sunk=sunk, stored=stored,
    )  # fmt: skip


def _plastic_slip(
    memory: Memory, step: JointStep, t: Array, contact: Array, slip: Array, moved: Array
) -> tuple[Array, Array, Array]:
    """Divide what pairs moved along their tangents (m, d-1): plastic slip, stretch at the end [m], what only stretches.

    A hard pair that is hit keeps no stretch: what an impact moves was never elastic.
    """
    soft, slips, elastic = step.a_t > 0, slip.any(axis=1), -step.a_t[:, None] * t[:, 1:]
    hit = (contact != Normal.OPEN) & (memory.force[:, 0] == 0) & ~step.springy
    stuck = soft & ~slips & (contact != Normal.OPEN) & ~hit
    stretch = np.where(stuck[:, None], memory.stretch + moved, np.where((soft & ~hit)[:, None], elastic, 0.0))
    slid = moved - np.where(soft[:, None], stretch - memory.stretch, 0.0)
    return np.where(((contact != Normal.OPEN) & slips)[:, None], slid, 0.0), stretch, stuck


def _broken(joints: Joints, memory: Memory, step: JointStep, contact: Array, slip: Array) -> Array:
    """Return which joints (m,) have lost cohesion and tensile strength: brittle ones that opened or slipped."""
    if not (joints.any_bond and joints.scheme.brittle):
        return memory.broken
    return np.asarray(memory.broken | (step.bonded & ((contact == Normal.OPEN) | slip.any(axis=1))))
