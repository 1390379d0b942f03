"""The least friction of a structure, between two proofs, with its verdict."""

from __future__ import annotations

from dataclasses import dataclass, field

from concio.analysis.margin_of import MarginOf
from concio.representation import short_repr
from concio.solvers.statics.friction import FrictionBounds
from concio.verdict.margin_verdict import friction_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown


@short_repr
@dataclass(frozen=True)
class FrictionMargin(Shown, FrictionBounds):
    """Smallest common factor of the friction coefficients at which admissible forces still exist, as two proofs.

    Parameters
    ----------
    factor : float
        Smallest factor shown to hold: forces in balance were found with it. 0 where no friction is needed; above 1
        where the structure does not hold with the friction it has; ``inf`` where none was shown to hold.
    below : float
        Largest factor shown to be too small, by a mechanism; ``-inf`` where none was.
    programmes : int
        Linear programmes solved.
    of : MarginOf or None
        The structure and its loads; None of a bare problem.
    """

    of: MarginOf | None = field(default=None, repr=False, compare=False)

    @property
    def verdict(self) -> Verdict:
        """The least factor with its question, its two proofs, and what it leaves out."""
        return friction_verdict(self)
