"""Whether rigid blocks that stand still are held where they stand: forces within friction that balance every one.

Iterations to an equilibrium move blocks by millionths of their width, and points of contact on edges that lie along
each other jump as they do: domes that stood for seconds never had an equilibrium. Where nothing moves, a dry joint may
carry any force within friction, so that forces in the cones of all contacts that touch are an equilibrium, whatever
brought the blocks there. Joints with stiffness, elastic blocks and ties carry what their deformation says, and are not
asked.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from concio.analysis.motion.certified import HIDDEN, Certificate
from concio.analysis.motion.small_displacements import SmallDisplacements
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.step_pairs import assembled
from concio.problem.tolerances import CERTIFIED
from concio.solvers.statics.existence import statically_admissible

Array = np.ndarray


def may_be_asked(statics: SmallDisplacements) -> bool:
    """Return whether all blocks are rigid on dry joints without stiffness, and no tie or support holds any."""
    maker = statics.maker
    joints = maker.joints
    deform = statics.frames.elastic or joints.any_stiffness or joints.any_bond or joints.any_cap
    return not (deform or len(maker.ties) or len(maker.held))


def held_still(statics: SmallDisplacements, certificate: Certificate, state: MotionState) -> bool:
    """Return whether forces within friction balance every block where it stands, certified on rows written again.

    Parameters
    ----------
    statics : SmallDisplacements
        Of a structure for which :func:`may_be_asked`.
    certificate : Certificate
    state : MotionState
        Without velocities.
    """
    look = statics.look(state, state.memory, np.zeros((0, statics.nowhere.size - 1)), 0.0)
    layout = statics.maker.search.layout
    assert layout is not None
    still = np.zeros_like(state.centre), np.zeros_like(state.spin)
    slots, rows = certificate.original.at(layout, state.centre, state.rotation, *still, state.strain)
    data, _ = certificate.joints.resting(rows, slots, look.memory, np.zeros_like(look.data.shift[:, 1:]), np.inf)
    closed = data.active & (data.shift[:, 0] <= statics.maker.joints.sag)
    acting = statics.acting(look, 0.0)
    force = float(np.abs(acting).sum()) or 1.0
    p = assembled(statics.bare, acting, (replace(data, active=closed),), force, statics.width)
    n, zero = len(acting), np.zeros(int(closed.sum()))
    given = p.contact_problem()
    hard = replace(given.laws, normal_compliance=zero, tangential_compliance=zero)
    asked = replace(given, gap=zero, R=sp.csc_array(sp.eye_array(n)), laws=hard)
    found = statically_admissible(asked, thorough=False)
    if not found.exists or not certificate.original.named(layout).sound:
        return False
    t = np.zeros((p.pairs, p.dim))
    t[closed, 0], t[closed, 1:] = found.normal_force, found.friction_force
    left = np.abs(acting + p.pull(t)).max(initial=0.0)
    beyond = np.linalg.norm(t[:, 1:], axis=1) - p.cone.friction * t[:, 0]
    worst = max(float(left), float(beyond.max(initial=0.0)), float(-t[:, 0].min(initial=0.0))) / force
    deep = certificate.original.deepest(state.centre, state.rotation, state.strain, HIDDEN)
    return worst <= CERTIFIED and bool(deep <= 1.0)
