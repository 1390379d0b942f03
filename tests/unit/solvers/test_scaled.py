"""Units of a problem's own: a typical pair carries one, and there and back nothing changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from concio.problem.certificate import imbalance
from concio.problem.contact_problem import ContactProblem
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.methods import find
from contact_problems import wall
from lcp_problems import with_laws

LAWS = ("cohesion", "tension", "dilatancy", "springs", "cap", "gap", "origin")
PROBLEMS = {
    "hard": wall(2, 3),
    "pushed": wall(2, 3, alpha=0.2, soil=1.0),
    "every law": with_laws(wall(2, 2, alpha=0.1), 3, *LAWS),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_typical_pair_carries_one(name: str) -> None:
    scaled = scale(PROBLEMS[name])
    assert 0.1 < np.sqrt((scaled.start**2).mean()) < 1.5
    assert 0.1 < np.sqrt(np.mean(scaled.along(scaled.glued) ** 2)) < 10.0


def answer_of(problem: ContactProblem) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    found = find("sparse-lemke")(problem)
    assert found.solved
    return found.displacement, found.normal_force, found.friction_force


@pytest.mark.parametrize("name", PROBLEMS)
def test_equations_are_those_of_the_problem(name: str) -> None:
    """What is zero of a certified answer is zero in units of its own, for every joint law; what is not is the same."""
    problem, scaled = PROBLEMS[name], scale(PROBLEMS[name])
    u, t_n, t_t = answer_of(problem)
    v, t = scaled.bring(u, t_n, t_t)
    for there, back in zip(scaled.restore(v, t), (u, t_n, t_t), strict=True):
        np.testing.assert_allclose(there, back, atol=1e-14 * np.abs(back).max())
    assert np.abs(scaled.imbalance(v, t)).max() < 1e-9
    assert np.abs(scaled.natural_map(v, t)).max() < 1e-9 * max(1.0, np.abs(v).max())
    assert scaled.cone.tension.max() == 0.0
    rest = np.random.default_rng(0).normal(size=v.size)
    _, left = imbalance(problem, rest * scaled.length, t_n, t_t, 1.0)
    assert np.abs(left).max() == pytest.approx(np.abs(scaled.imbalance(rest, t)).max() * scaled.force, rel=1e-6)


def test_units_of_the_user_do_not_matter() -> None:
    problem = PROBLEMS["every law"]
    force, length = 1e3, 1e-2
    law = problem.laws
    other = replace(
        problem,
        K=problem.K * (force / length),
        f=problem.f * force,
        gap=problem.gap * length,
        slip_origin=problem.slip_origin * length,
        laws=replace(
            law,
            cohesion=law.cohesion * force,
            tension=law.tension * force,
            cap=law.cap * force,
            normal_compliance=law.normal_compliance * (length / force),
            tangential_compliance=law.tangential_compliance * (length / force),
        ),
    )
    one, two = scale(problem), scale(other)
    assert two.force == pytest.approx(one.force * force)
    assert two.length == pytest.approx(one.length * length)
    for name in ("f", "x", "compliance", "glued"):
        np.testing.assert_allclose(getattr(two, name), getattr(one, name), atol=1e-11)


def test_renewed_shares_the_factor_and_takes_the_rest() -> None:
    problem = PROBLEMS["hard"]
    scaled = scale(problem)
    other = replace(problem, f=2.0 * problem.f, gap=problem.gap + 1e-3)
    new: Scaled = scaled.renewed(other)
    assert new.factor is scaled.factor
    np.testing.assert_allclose(new.f, 2.0 * scaled.f)
    np.testing.assert_allclose(new.x[:, 0] - scaled.x[:, 0], 1e-3 / scaled.length)


def test_slips_of_the_past_are_no_measure_of_the_loads() -> None:
    """Units after a long slip are those before it, whichever way it went: a path counts its steps from where it is."""
    problem = with_laws(wall(2, 2, alpha=0.1), 3, "springs")
    slip = np.linspace(-0.3, 0.7, problem.pairs)[:, None]
    before = scale(problem)
    for sense in (1.0, -1.0):
        after = scale(replace(problem, slip_origin=sense * slip))
        assert (after.length, after.force) == (before.length, before.force)
