"""Methods that claim success certify, and agree on what is unique.

What is unique: the stresses of associated friction (a strictly convex problem in the strains), and in practice the
displacements of walls on a full base with moderate friction. Contact forces are not (redundant corners): only their
resultants on each body are, and those follow from equilibrium, which the certificate checks.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from concio.problem.certificate import certify
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Solution
from concio.solvers.methods import find
from contact_problems import wall
from samples import sample

QUICK: dict[str, dict[str, int]] = {
    "lagrange": {"limit": 100},
    "alart-curnier": {"limit": 80},
    "simo-laursen": {"limit": 150},
    "de-saxce": {"steps": 300},
    "panagiotopoulos": {"steps": 300},
    "uzawa": {"limit": 2000},
    "admm": {"limit": 1500},
    "gauss-seidel": {"limit": 150},
}
"""The iterative family, each with a patience that keeps the test short."""

few = settings(
    max_examples=sample(2, 5, 12), deadline=None, suppress_health_check=[HealthCheck.too_slow]
)


@st.composite
def walls(draw: st.DrawFn) -> ContactProblem:
    friction = draw(st.sampled_from([0.0, 0.2, 0.4, 0.6]))
    problem = wall(
        draw(st.integers(1, sample(2, 3))), draw(st.integers(1, 3)), mu=friction, sides=draw(st.booleans()),
        alpha=draw(st.sampled_from([0.0, 0.1, 0.3])) if friction > 0.3 else 0.0, top=draw(st.sampled_from([0.0, 2.0])),
    )  # fmt: skip
    m = problem.pairs
    laws = problem.laws
    if draw(st.booleans()):
        cohesion = draw(st.sampled_from([0.02, 0.1]))
        tension = draw(st.sampled_from([0.0, 0.02]))
        laws = replace(laws, cohesion=np.full(m, cohesion), tension=np.full(m, tension))
    if draw(st.booleans()):
        compliance = draw(st.sampled_from([1e-4, 2e-3]))
        laws = replace(laws, normal_compliance=np.full(m, compliance), tangential_compliance=np.full(m, 2 * compliance))
    return replace(problem, laws=laws)


def answers(problem: ContactProblem) -> dict[str, Solution]:
    """Certified answers by method; what is not certified must not say so."""
    solved = {}
    for name, options in QUICK.items():
        solution = find(name)(problem, **options)
        again = certify(problem, solution.displacement, solution.normal_force, solution.friction_force)
        assert solution.solved == again.certified, name
        if solution.solved:
            solved[name] = solution
    return solved


@few
@given(walls())
def test_coulomb_answers_agree(problem: ContactProblem) -> None:
    solved = answers(problem)
    assert len(solved) >= 3
    first = next(iter(solved.values())).displacement
    strain = problem.K @ first
    for name, solution in solved.items():
        stress = problem.K @ solution.displacement - strain
        assert np.abs(stress).max() <= 1e-6 * np.abs(problem.f).sum(), name
        if problem.laws.friction.any() or problem.laws.cohesion.any():  # else a wall may stand anywhere on its base
            apart = np.abs(solution.displacement - first).max()
            assert apart <= 1e-6 * np.abs(first).max(), name


@few
@given(walls(), st.sampled_from([0.2, 0.5]))
def test_associated_stresses_agree(problem: ContactProblem, friction: float) -> None:
    mu = np.maximum(problem.laws.friction, friction)  # what is pushed must not slide away
    cohesion = np.maximum(problem.laws.cohesion, mu * problem.laws.tension)
    solved = answers(replace(problem, laws=replace(problem.laws, friction=mu, cohesion=cohesion, dilatancy=mu)))
    assert len(solved) >= 3
    first = problem.K @ next(iter(solved.values())).displacement
    for name, solution in solved.items():
        difference = np.abs(problem.K @ solution.displacement - first).max()
        assert difference <= 1e-6 * np.abs(problem.f).sum(), name
