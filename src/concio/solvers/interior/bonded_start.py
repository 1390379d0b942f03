r"""Bonded joints: begin where every pair sticks, and let go only of pairs whose strength that exceeds.

Where joints carry tension, most pairs of a structure stick and none of them slides or opens. With every pair stuck the
problem is linear,

.. math:: K u - C^T t = f, \qquad x + C u + a\,t = 0,

and its answer is the answer of the contact problem where no force exceeds the strength of its pair. Otherwise Newton's
method on the return map (:mod:`concio.solvers.interior.newton_finish`) goes on from there: in each step the pairs whose
strength is exceeded slip, open or crush.

Forces are not shifted by the tensile strength here. A strength of 1e6 times the loads, which stands for "bonded", would
otherwise leave only ten digits of them, and the interior point begins so far outside that it does not come back.

Where several bodies meet in a node and their meshes do not match, rows of C are nearly dependent: the couplings of two
faces prescribe nearly the same motion of that node (decision 0185). A compliance ``delta`` in the factorised matrix
K + C'C / delta is removed again by repeated solves. Each leaves the share delta / (delta + a sigma^2) of what a
combination of rows of singular value sigma is missed by, a being the compliance of the bodies, so that delta is lowered
until the solves converge. It is no lower than that, because rounding of gaps, over delta, is the error of forces that
are left open.
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.tolerances import EXACT
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.newton_finish import finish, stuck
from concio.solvers.states.redundant_forces import least_forces
from concio.solvers.states.state_reading import Finished, natural_residual, read_states, sizes

DELTAS = (1e-8, 1e-10, 1e-12)
"""Compliances added to pairs of mean area, scaled units, tried in turn."""

HELD = 1e-10
"""Largest gap or slip, over the largest displacement, of pairs that stick."""

SHARE = 0.2
"""Largest share of the pairs whose strength may be exceeded where all stick: from further away others are as near."""

ROUNDS = 8
"""Largest number of Newton steps."""

PATIENCE = 2
"""How many of them in a row may bring no smaller residual."""


def applies(s: Scaled) -> bool:
    """Tell whether pairs carry tension between bodies, or in joints, that deform."""
    return s.deforms and bool(s.problem.laws.tension.any())


def from_sticking(s: Scaled) -> tuple[Scaled, Finished] | None:
    """Return an exact answer near the state in which every pair sticks; None where there is none near.

    Parameters
    ----------
    s : Scaled

    Returns
    -------
    Scaled
        The problem in forces that are not shifted, in which the answer is given.
    Finished
    """
    plain = s.unshifted()
    for delta in DELTAS:
        at = stuck(plain, delta)
        if at is not None and _missed(plain, *at) <= HELD:
            break
    else:
        return None
    exceeded = plain.cone.excess(at[1][:, 0], at[1][:, 1:]) > 0
    if exceeded.mean() > SHARE:
        return None
    error, _ = natural_residual(plain, *at)
    if not exceeded.any() and error <= EXACT:
        held = Finished(*at, read_states(plain, *at), error, 1, np.zeros(0, dtype=int))
        return plain, least_forces(plain, held)
    found = finish(plain, *at, rounds=ROUNDS, patience=PATIENCE, delta=delta)
    return (plain, found) if found.error <= EXACT else None


def _missed(s: Scaled, u: Array, t: Array) -> float:
    """Return the largest gap or slip of pairs that are to stick, over the largest displacement."""
    y = s.position(u, t)
    y[~s.rough, 1:] = 0.0
    return float(np.abs(y).max(initial=0.0)) / sizes(u, t)[1]
