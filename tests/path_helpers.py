"""Load paths of the rigid assemblies in ``rigid_walls``: rest, self-weight, then a second load."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from concio.problem.pair_state import PairStates
from concio.solvers.path.event_path import follow
from concio.solvers.path.path_state import CLOSED, LinearPath, PathState, certify_step, elastic_energy
from concio.solvers.path.record import EventPath
from rigid_walls import Assembly


def at_rest(path: LinearPath, parameter: float = 0.0) -> PathState:
    """No displacement, no force, every pair touching."""
    m = path.problem.pairs
    zero, still = np.zeros(m), np.zeros((m, 1))
    closed = PairStates(np.full(m, CLOSED, dtype=np.int8), still)
    return PathState(parameter, np.zeros(path.problem.unknowns), zero, still, closed, still, zero)


def weight_then(
    assembly: Assembly, mu, load, *, compliance=1e-4, ratio=2.0, until=1.0, control=None, **laws
) -> tuple[LinearPath, EventPath]:
    """Rigid blocks on compliant joints (a_n = compliance, a_t = ratio a_n): self-weight, then ``load``."""
    given = {"normal_compliance": compliance, "tangential_compliance": ratio * compliance, **laws}
    dead = LinearPath(assembly.problem(mu, assembly.load(0, 0), **given), assembly.load(0, -1))
    weight = follow(dead, at_rest(dead), until=1.0)
    assert weight.end.parameter == 1.0
    live = LinearPath(dead.problem.with_loads(assembly.load(0, -1)), load)
    start = replace(weight.end, parameter=0.0, work=0.0, dissipation=0.0)
    return live, follow(live, start, until=until, control=control)


def worst_certificate(path: LinearPath, found: EventPath) -> float:
    """Largest certificate entry of all corners, each as a step from the one before."""
    return max(certify_step(path, a, b).worst for a, b in pairwise(found.states))


def energy_turned_over(path: LinearPath, found: EventPath) -> float:
    """Return the largest of work and |f| . |u|, by which energies are measured [kN m].

    What a toppling block gains from the push it loses in lifting its weight, so that their sum, the work, is far
    smaller than the terms whose rounding it holds.
    """
    size = max(
        float(np.abs(path.problem.f + s.parameter * path.load_rate) @ np.abs(s.displacement)) for s in found.states
    )
    return max(size, *(abs(s.work) for s in found.states))


def energy_error(path: LinearPath, found: EventPath) -> float:
    """Largest |work - stored - dissipated| over the corners, relative to the energy exchanged."""
    first = found.states[0]
    kept = [s.work - first.work - s.dissipation + first.dissipation for s in found.states]
    stored = [elastic_energy(path.problem, s) for s in found.states]
    turned = energy_turned_over(path, found)
    return max(abs(k - e + stored[0]) for k, e in zip(kept, stored, strict=True)) / turned


def least_dissipation(path: LinearPath, found: EventPath) -> float:
    """Smallest dissipation of a corner's step, relative to the energy exchanged."""
    falls = min(b.dissipation - a.dissipation for a, b in pairwise(found.states))
    return falls / (energy_turned_over(path, found) or 1.0)
