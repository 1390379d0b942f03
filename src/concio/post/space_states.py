"""What each piece of a joint in space does in a mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.problem.pair_state import PairState
from concio.problem.solution import Status

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.post.joint_faces import JointFaces

Array = np.ndarray


def mechanism_states_in_space(result: Result, faces: JointFaces, tolerance: float = 1e-6) -> Array:
    """Return the state (T,) of each joint piece in a mechanism, codes of :class:`.PairState`.

    As in the plane: in the mechanism that proves a collapse a joint that only slides also opens by mu times its slip,
    which is distinguished from one that opens further.

    Parameters
    ----------
    result : Result
        With a mechanism.
    faces : JointFaces
        Moved with the velocities of the mechanism.
    tolerance : float
        Relative velocities below this share of the largest are none.
    """
    relative = (faces.moved_b - faces.moved_a).mean(axis=1)
    normal = result.assembly.pairs.normal[faces.pair]
    opening = (relative * normal).sum(1)
    sliding = np.linalg.norm(relative - opening[:, None] * normal, axis=1)
    largest = float(np.abs([faces.moved_a, faces.moved_b]).max(initial=0.0))
    little = tolerance * largest
    laws = result.assembly.laws
    swelling = laws.dilatancy if result.status is Status.COLLAPSES else laws.friction
    opens = opening > swelling[faces.pair] * sliding + little
    state = np.where(~opens & (sliding > little), PairState.SLIP, PairState.STICK)
    return np.where(opens, PairState.OPEN, state).astype(np.int8)
