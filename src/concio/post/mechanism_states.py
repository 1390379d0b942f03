"""What each joint does in a collapse mechanism.

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
    from concio.post.joint_lines import JointLines

Array = np.ndarray


def mechanism_states(result: Result, pieces: JointLines, tolerance: float = 1e-6) -> Array:
    """Return the state (k,) of each joint piece in a mechanism, codes of :class:`.PairState`.

    Parameters
    ----------
    result : Result
        With a mechanism.
    pieces : JointLines
        Moved with the velocities of the mechanism.
    tolerance : float
        Relative velocities below this share of the largest are none.
    """
    relative = (pieces.moved_b - pieces.moved_a).mean(axis=1)
    pairs = result.assembly.pairs
    opening = (relative * pairs.normal[pieces.pair]).sum(1)
    sliding = (relative * pairs.tangent[pieces.pair]).sum(1)
    largest = float(np.abs([pieces.moved_a, pieces.moved_b]).max(initial=0.0))
    little = tolerance * largest
    laws = result.assembly.laws
    swelling = laws.dilatancy if result.status is Status.COLLAPSES else laws.friction
    opens = opening > swelling[pieces.pair] * np.abs(sliding) + little
    slides = ~opens & (np.abs(sliding) > little)
    state = np.where(slides, PairState.SLIP, PairState.STICK)
    return np.where(opens, PairState.OPEN, state).astype(np.int8)
