"""What each joint does in a collapse mechanism, in the plane and in space.

The mechanism that proves a collapse obeys ``y_n >= mu |y_t|`` (theory page, section 6): a joint that only slides also
opens by mu times its slip. Such a joint is distinguished from one that opens further. In an unbounded motion the joints
that slide stay closed, as they do in reality.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.problem.pair_state import PairState
from concio.problem.solution import Status

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.post.joint_faces import JointFaces
    from concio.post.joint_lines import JointLines

Array = np.ndarray

LITTLE = 1e-6
"""Relative velocities below this share of the largest are none."""


def mechanism_states(result: Result, pieces: JointLines | JointFaces) -> Array:
    """Return the state (k,) of each joint piece in a mechanism, codes of :class:`.PairState`.

    Parameters
    ----------
    result : Result
        With a mechanism.
    pieces : JointLines or JointFaces
        Moved with the velocities of the mechanism.
    """
    relative = (pieces.moved_b - pieces.moved_a).mean(axis=1)
    normal = result.assembly.pairs.normal[pieces.pair]
    opening = (relative * normal).sum(1)
    sliding = np.linalg.norm(relative - opening[:, None] * normal, axis=1)
    little = LITTLE * float(np.abs([pieces.moved_a, pieces.moved_b]).max(initial=0.0))
    laws = result.assembly.laws
    swelling = laws.dilatancy if result.status is Status.COLLAPSES else laws.friction
    opens = opening > swelling[pieces.pair] * sliding + little
    state = np.where(~opens & (sliding > little), PairState.SLIP, PairState.STICK)
    return np.where(opens, PairState.OPEN, state).astype(np.int8)
