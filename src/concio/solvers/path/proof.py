r"""The certificate of a step of a path, from the original problems at its two ends.

A path keeps loads, obstacles and histories of its own and interpolates them. What it kept is not asked here: the state
is put into the problems that the model gives at the factors of this state and of the state before, made again. Two
things of the past enter. Slip is measured from where the pair was in the state before (10, 11), which follows from its
displacements, its forces and the problem at *its* factors. Crushing and dilatant opening are an offset o that the path
carried; it is held against the equation that defines it,

.. math:: x_n + C_n u + a_n t_n + o = 0 \text{ where a pair that crushes or dilates is in contact, else }
          \dot o = -\tan\psi\,|\dot y_t|.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.certificate import Certificate, certify
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.error_units import in_units, measure
from concio.solvers.path.path_state import OPEN, LinearPath, PathState, plastic_position, sizes, weakened


def certify_between(
    then: ContactProblem,
    now: ContactProblem,
    before: PathState,
    after: PathState,
    *,
    total_load: float | None = None,
    moved: Array | float = 0.0,
) -> Certificate:
    """Certify a state of a path as the answer of the step that starts from the state before it.

    Parameters
    ----------
    then, now : ContactProblem
        The original problems at the load factors and support positions of both states, slip measured from s = 0.
    before, after : PathState
    total_load : float, optional
        Force by which forces are measured, where the problem's own loads are not the measure [kN].
    moved : (m,) array or float
        How far obstacles have moved at each pair: displacements of its part are measured by no less [m].

    Returns
    -------
    Certificate
        Its complementarity includes the error of the offset, over the largest displacement of its part.
    """
    start = plastic_position(_resting(then), before)[1]
    problem = weakened(now, before.broken)
    problem = replace(problem, gap=problem.gap + before.offset, slip_origin=problem.slip_origin + start)
    answer = after.displacement, after.normal_force, after.friction_force
    found = certify(problem, *answer, total_load=total_load, moved=moved)
    units = measure(now, *answer, total_load=total_load, moved=moved)
    carried = float(in_units(np.abs(_offset_error(now, before, after, start)), units.pair_length).max(initial=0.0))
    return replace(found, complementarity=max(found.complementarity, carried))


def obstacles_moved(start: ContactProblem, now: ContactProblem, among: Array) -> Array:
    """Return how far obstacles have moved at each pair between two problems of one model (m,) [m], 0 but ``among``."""
    moved = np.maximum(np.abs(now.gap - start.gap), sizes(now.slip_origin - start.slip_origin))
    return np.where(among, moved, 0.0)


def _offset_error(now: ContactProblem, before: PathState, after: PathState, start: Array) -> Array:
    """Return by how much the offset (m,) of each pair is not what the original equations make it [m].

    ``start`` is where the pairs slipped to in the state before (m, d-1) [m].
    """
    law = now.laws
    opening, position = plastic_position(_resting(now), after)
    plastic = (after.contact != OPEN) & ((law.dilatancy > 0) | np.isfinite(law.cap))
    lifted = before.offset - law.dilatancy * sizes(position - start)
    error: Array = after.offset - np.where(plastic, -opening, lifted)
    return error


def _resting(problem: ContactProblem) -> LinearPath:
    """Return a path that stays at a problem: its position at any parameter is that of the problem."""
    return LinearPath(problem, np.zeros(problem.unknowns))
