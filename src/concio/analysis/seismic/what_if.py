"""What alpha_0 of a mechanism depends on: derivatives of its limit programme, the bodies that move being the same."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from concio.analysis.coulomb_sensitivity import coulomb_sensitivity
from concio.analysis.parameters import parameters_of
from concio.analysis.seismic.directions import Direction, pushes
from concio.analysis.seismic.local_mechanism import LocalMechanism
from concio.analysis.seismic.out_of_plane import EITHER, SENSES
from concio.analysis.seismic.tie_history import with_strength
from concio.analysis.seismic.weakest_mechanism import Mechanisms
from concio.analysis.sensitivity import Sensitivity, sensitivity_of
from concio.contact.assembly import assemble
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.solvers.statics.associated_limit import associated_limit

Array = np.ndarray

SAME = 1e-6
"""Relative difference below which alpha_0 is the multiplier of its state: no hinge is set back, no tie yields later."""

NEAR = 0.01
"""Largest relative difference of alpha_0 with hinges set back and the multiplier of joints that crush at points."""


def sensitivity_of_mechanism(
    model: Model, m: LocalMechanism, live: str | Sequence[str] | None = None
) -> Sensitivity | None:
    """Return the derivatives of alpha_0 of a mechanism; None where it depends on more than the forces of its state.

    Parameters
    ----------
    model : Model
        As it was given to the assessment.
    m : LocalMechanism
    live : str or sequence of str, optional
        As it was given to the assessment.
    """
    groups = (live,) if isinstance(live, str) else tuple(live or ())

    def loaded(changed: Model) -> tuple[ContactProblem, Array]:
        (push,) = pushes(with_strength(changed), way_of(m.direction), groups)
        seek = Mechanisms(assemble(push.model), push.groups, push.sign)
        return seek.loaded(m.found.moving)

    here = loaded(model)
    if m.found.flow != "no sliding":
        return _of_sliding(here, m, loaded, model, groups)
    limit = associated_limit(*here)
    if limit.mechanism is None or not abs(limit.multiplier - m.multiplier) <= NEAR * abs(m.multiplier):
        return None
    return sensitivity_of(here, loaded, limit, parameters_of(model, groups))


def _of_sliding(
    here: tuple[ContactProblem, Array],
    m: LocalMechanism,
    loaded: Callable[[Model], tuple[ContactProblem, Array]],
    model: Model,
    groups: Sequence[str],
) -> Sensitivity | None:
    """Return the derivatives of alpha_0 of a mechanism whose joints slide; None where it is not a Coulomb state."""
    if m.found.flow != "Coulomb":
        return None
    problem, push = here
    state = m.found.state
    if state is None or len(state.velocity) != problem.unknowns:
        return None
    if not abs(state.multiplier - m.multiplier) <= SAME * abs(m.multiplier):
        return None
    return coulomb_sensitivity(problem, push, state, loaded, parameters_of(model, groups))


def way_of(name: str) -> Direction:
    """Return the direction of a push as it is asked for, from its name."""
    if name.startswith("("):
        return tuple(float(v) for v in name.strip("()").split(","))
    return {sense: way for way, sense in (*SENSES.items(), ("left", EITHER))}.get(name, name)
