"""The joint that moves most beside its own length."""

from __future__ import annotations

from dataclasses import dataclass

from concio.representation import short_repr

LARGE = 0.1
"""Share of a joint's length from which on its motion is called large."""


@short_repr
@dataclass(frozen=True)
class JointMotion:
    """How far the joint that moves most beside its length has opened or slid.

    Parameters
    ----------
    joint : str
        The names of its bodies, "a|b"; empty where nothing moves.
    motion : float
        Opening beyond the initial gap or slip, whichever is larger [m].
    share : float
        The same over the length of the joint, in space over its least width.
    """

    joint: str
    motion: float
    share: float

    @property
    def large(self) -> bool:
        """Whether small displacements, on which the analysis rests, can no longer be meant."""
        return self.share > LARGE

    @property
    def sentence(self) -> str:
        """What to think of a large motion, in one sentence."""
        return (
            f"joint {self.joint} opens or slides by {1e3 * self.motion:.4g} mm, {100 * self.share:.3g} % of its "
            "length: too far for small displacements, in which contacts stay where they were"
        )
