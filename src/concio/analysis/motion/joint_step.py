"""The pairs of a step problem, and what is known of joints before it is solved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.analysis.motion.springs import Springs
from concio.problem.cone import Cone

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class PairData:
    """Pairs of a step problem; see :class:`concio.solvers.stepping.problem.StepProblem`.

    ``shift`` (m, d) is what stands in the laws beside C v+: the gap, and minus the slip origin.
    """

    columns: Array
    values: Array
    shift: Array
    cone: Cone
    a_n: Array
    a_t: Array
    dilatancy: Array
    active: Array


@dataclass(frozen=True, eq=False)
class JointStep:
    """What is known of the joints before a step is solved.

    Parameters
    ----------
    springy : (m,) boolean array
        Pairs with a stiffness of their own.
    a_n, a_t : (m,) arrays
        Compliances, own or added [m/kN].
    gap : (m,) array
        In the middle of the step, by constant velocities [m].
    y0 : (m, d) array
        Relative velocities at the beginning [m/s].
    bonded : (m,) boolean array
    springs : Springs or None
        Those of compliant joints.
    area : (m,) array
        On which they stand [m2].
    sunk, stored : (m,) arrays
        Their deformation and energy at the beginning [m], [kN m].
    struck : (m,) boolean array
        Hard pairs that are hit in the step.
    overlap, drift : float
        What their energy grew by since the end of the last step: because common areas have changed, and because the
        gaps of turned bodies are not what straight motion makes them [kN m].
    """

    springy: Array
    a_n: Array
    a_t: Array
    gap: Array
    y0: Array
    bonded: Array
    springs: Springs | None
    area: Array
    sunk: Array
    stored: Array
    struck: Array
    overlap: float = 0.0
    drift: float = 0.0

    @property
    def impact(self) -> bool:
        """Whether anything is hit."""
        return bool(self.struck.any())


@dataclass(frozen=True, eq=False)
class JointAnswer:
    """What a step problem says of its contact pairs.

    Parameters
    ----------
    motion : (m, d) array
        Mean relative velocities in the step [m/s]; of an equilibrium, gaps without compliance and stretches with the
        slip on the way to it [m].
    force : (m, d) array
        [kN].
    contact : (m,) integer array
        State: codes of :class:`concio.problem.pair_state.Normal`.
    slip : (m, d-1) array
        Unit vector along which a pair slips, zero where it does not.
    """

    motion: Array
    force: Array
    contact: Array
    slip: Array
