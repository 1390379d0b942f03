r"""Does the structure move away as if nothing touched it? The unbounded motion that needs no forces at all.

A block between walls that nothing presses falls along them: every pair touches without force. That state is the tip
of every cone, where interior points and Newton's method have the least to hold on to, and with stiff joints they find
no step of the slow motion. But the motion is known without them,

.. math:: R^T M R\, q = R^T f, \qquad a = R q, \qquad t = 0,

and is a :class:`concio.problem.solution.Departure` if no pair closes in it, which its certificate decides.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Departure
from concio.solvers.relaxation.unbounded_motion import verify_motion

WAYS = 10.0 ** np.arange(0.0, -16.0, -3.0)
"""Largest displacements [m] at which the motion is examined, until its certificate holds at one.

Small ones are known to more digits beside joints that give way by next to nothing, large ones open overlaps."""


def free_motion(problem: ContactProblem) -> Departure | None:
    """Return the certified motion of all bodies under their loads alone, without any contact force; or None.

    Parameters
    ----------
    problem : ContactProblem
    """
    R = sp.csc_array(problem.R)
    masses = sp.csc_array(R.T @ problem.inertia @ R)
    if not R.shape[1] or not (masses.diagonal() > 0).all():
        return None
    a = R @ splu(sp.csc_matrix(masses)).solve(R.T @ problem.f)
    top = float(np.abs(a).max(initial=0.0))
    if not 0.0 < top < np.inf:
        return None
    nothing = np.zeros(problem.pairs), np.zeros((problem.pairs, problem.dim - 1))
    tried = (verify_motion(problem, a, way / top * a, *nothing) for way in WAYS)
    return next((found for found in tried if found.certified), None)
