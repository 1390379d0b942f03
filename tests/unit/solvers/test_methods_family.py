"""Each method of the family on problems with known answers, and on problems it must not claim to have solved."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from concio.errors import MethodError
from concio.problem.contact_problem import ContactProblem, Laws
from concio.problem.solution import Progress, Solution, Status
from concio.solvers.methods import find
from concio.solvers.methods.iterative import (
    admm,
    alart_curnier,
    gauss_seidel,
    lagrange,
    panagiotopoulos,
    penalty,
    simo_laursen,
    uzawa,
)
from contact_problems import rigid, wall
from samples import first

FAMILY = ("lagrange", "alart-curnier", "uzawa", "simo-laursen", "de-saxce", "panagiotopoulos", "gauss-seidel", "admm")
QUICKEST = sorted(FAMILY, key=lambda name: name == "gauss-seidel")
ALL = ("penalty", *FAMILY)

SHORT: dict[str, dict[str, int]] = {
    "lagrange": {"limit": 60},
    "de-saxce": {"steps": 150},
    "panagiotopoulos": {"steps": 150},
    "gauss-seidel": {"limit": 300},
    "uzawa": {"limit": 1000},
    "admm": {"limit": 1000},
}
"""Limits for problems without an answer: no method should need its patience to fail there."""


def with_law(problem: ContactProblem, **law: float) -> ContactProblem:
    fields = {name: np.full(problem.pairs, float(value)) for name, value in law.items()}
    return replace(problem, laws=replace(problem.laws, **fields))


def block_on_plane(push: float, d: int = 2, mu: float = 0.5) -> ContactProblem:
    """A point mass of weight 1 on springs of stiffness 100 to a plate that lies on a plane, pushed sideways.

    The plate is the second node; the spring is isotropic, so the pushed node moves by push / 100 against the plate.
    """
    eye = sp.eye_array(d)
    k = sp.csr_array(sp.block_array([[100.0 * eye, -100.0 * eye], [-100.0 * eye, 100.0 * eye]]))
    f = np.zeros(2 * d)
    f[d - 1], f[0] = -1.0, push
    c_n, c_t = np.zeros((1, 2 * d)), np.zeros((d - 1, 2 * d))
    c_n[0, 2 * d - 1] = 1.0
    c_t[:, d : 2 * d - 1] = -np.eye(d - 1) if d == 2 else np.eye(d - 1)
    motions = np.vstack([np.eye(d), np.eye(d)]) / np.sqrt(2.0)
    return ContactProblem(
        k, f, sp.csr_array(c_n), sp.csr_array(c_t), np.zeros(1), Laws.coulomb(mu, 1), sp.csc_array(motions),
        np.array([0, 2 * d]),
    )  # fmt: skip


@pytest.mark.parametrize("method", FAMILY)
@pytest.mark.parametrize("push", [0.0, 0.3, 0.499])
def test_block_sticks_below_friction(method: str, push: float) -> None:
    solution = find(method)(block_on_plane(push))
    assert solution.solved
    np.testing.assert_allclose(solution.displacement, [push / 100, -0.01, 0.0, 0.0], atol=1e-11)
    assert solution.normal_force[0] == pytest.approx(1.0, abs=1e-9)
    assert solution.friction_force[0, 0] == pytest.approx(push, abs=1e-9)


@pytest.mark.parametrize("method", ALL)
def test_block_pushed_beyond_friction_is_never_solved(method: str) -> None:
    solution = find(method)(block_on_plane(0.51), **SHORT.get(method, {}))
    assert solution.status is Status.GAVE_UP
    assert solution.certificate.worst > 1e-3
    assert solution.info["accuracy"] == solution.certificate.worst
    assert "accuracy" in solution.trace[-1]


@pytest.mark.parametrize("method", ["alart-curnier", "simo-laursen", "de-saxce", "uzawa", "admm", "gauss-seidel"])
def test_three_dimensions(method: str) -> None:
    problem = block_on_plane(0.3, d=3)
    problem.f[1] = -0.2
    solution = find(method)(problem)
    assert solution.solved
    np.testing.assert_allclose(solution.friction_force[0], [-0.3, 0.2], atol=1e-9)
    problem.f[1] = -0.45  # each component below mu, their norm above
    assert find(method)(problem, **SHORT.get(method, {})).status is Status.GAVE_UP


@pytest.mark.long
@pytest.mark.parametrize("method", ALL)
def test_wall_beyond_collapse_is_never_solved(method: str) -> None:
    assert find(method)(wall(2, 2, alpha=1.2), **SHORT.get(method, {})).status is Status.GAVE_UP


@pytest.mark.long
@pytest.mark.parametrize(
    ("law", "why"),
    first(3, [
        ({"cohesion": 0.05}, "cohesion"),
        ({"dilatancy": 0.2}, "dilatancy"),
        ({"normal_compliance": 1e-3, "tangential_compliance": 2e-3}, "springs"),
        ({"cohesion": 0.1, "tension": 0.1}, "tension"),
        ({"cap": 1.2}, "crushing"),
    ]),
)
def test_joint_laws_agree(law: dict[str, float], why: str) -> None:
    problem = with_law(wall(2, 2, alpha=0.35, mu=0.5), **law)
    plain = find("lagrange")(wall(2, 2, alpha=0.35, mu=0.5))
    answers = {name: find(name)(problem) for name in FAMILY}
    first = answers["lagrange"].displacement
    if why != "crushing":  # the loads of this small wall do not reach its cap
        assert np.abs(first - plain.displacement).max() > 1e-6 * np.abs(first).max()
    for name, solution in answers.items():
        assert solution.solved, (name, why)
        np.testing.assert_allclose(solution.displacement, first, atol=1e-8 * np.abs(first).max(), err_msg=name)


@pytest.mark.parametrize("method", FAMILY)
def test_cap_crushes(method: str) -> None:
    problem = with_law(block_on_plane(0.1), cap=0.9)
    beyond = find(method)(problem, **SHORT.get(method, {}))
    assert beyond.status is Status.GAVE_UP  # weight 1 on a joint that carries 0.9
    solution = find(method)(with_law(block_on_plane(0.1), cap=1.1))
    assert solution.solved


@pytest.mark.parametrize("method", first(7, QUICKEST))
def test_slip_origin_and_gap(method: str) -> None:
    problem = wall(2, 2, alpha=0.3, mu=0.5, sides=True, gap=1e-4)
    origin = 3e-4 * np.cos(np.arange(problem.pairs))[:, None]
    problem = replace(problem, slip_origin=origin)
    solution, reference = find(method)(problem), lagrange.solve(problem)
    assert solution.solved
    assert reference.solved
    size = np.abs(reference.displacement).max()
    np.testing.assert_allclose(solution.displacement, reference.displacement, atol=1e-8 * size)


@pytest.mark.parametrize("method", first(7, QUICKEST))
def test_rigid_blocks(method: str) -> None:
    hard = find(method)(rigid(wall(2, 2, alpha=0.2)))
    assert hard.solved
    assert not hard.displacement.any()
    soft = find(method)(rigid(with_law(wall(2, 2, alpha=0.2), normal_compliance=1e-3, tangential_compliance=1e-3)))
    assert soft.solved
    assert soft.displacement.any()


@cache
def of_a_wall(method: str) -> Solution:
    """Return what a method says of a small wall that stands."""
    return find(method)(wall(2, 2, alpha=0.2))


@pytest.mark.parametrize("method", first(8, ["penalty", *QUICKEST]))
def test_units_do_not_matter(method: str) -> None:
    problem = wall(2, 2, alpha=0.2)
    force, length = 1e6, 1e-3
    other = replace(
        problem, K=problem.K * (force / length), f=problem.f * force, C_n=problem.C_n, gap=problem.gap * length
    )
    here, there = of_a_wall(method), find(method)(other)
    assert here.status is there.status
    np.testing.assert_allclose(
        there.displacement / length, here.displacement, atol=1e-10 * np.abs(here.displacement).max()
    )


def test_penalty_error_falls_with_its_parameter() -> None:
    problem = wall(2, 2, alpha=0.3)
    exact = lagrange.solve(problem).displacement
    errors = []
    for stiffness in (1e2, 1e3, 1e4):
        solution = penalty.solve(problem, stiffness=stiffness)
        assert solution.status is Status.GAVE_UP  # an approximation is never called an answer
        errors.append(np.abs(solution.displacement - exact).max())
        pressed = np.maximum(-solution.gap, 0.0).max()
        assert solution.info["penetration"] == pytest.approx(pressed, rel=1e-6)
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.2)
    assert errors[1] / errors[2] == pytest.approx(10.0, rel=0.2)


def test_penalty_is_exact_on_springs() -> None:
    assert penalty.solve(with_law(wall(2, 2), normal_compliance=1e-4, tangential_compliance=1e-4)).solved


def test_simultaneous_updates_agree_with_nested() -> None:
    problem = wall(2, 3, alpha=0.3)
    nested, simultaneous = (simo_laursen.solve(problem, updates=u) for u in ("nested", "simultaneous"))
    assert nested.solved
    assert simultaneous.solved
    np.testing.assert_allclose(simultaneous.displacement, nested.displacement, atol=1e-9)


def test_classical_alternation_needs_held_bodies() -> None:
    with pytest.raises(MethodError, match="tresca"):
        panagiotopoulos.solve(wall(2, 2), form="alternating")
    problem = wall(2, 2, alpha=0.2, soil=300.0)
    classical = panagiotopoulos.solve(problem, form="alternating")
    assert classical.solved
    np.testing.assert_allclose(classical.displacement, lagrange.solve(problem).displacement, atol=1e-11)


def test_plain_delassus_needs_held_bodies() -> None:
    with pytest.raises(MethodError, match="admm"):
        gauss_seidel.solve(wall(2, 2), inertia=0.0)
    assert gauss_seidel.solve(wall(1, 2, soil=300.0), inertia=0.0).solved


@pytest.mark.parametrize(
    ("solver", "options"),
    [
        (penalty.solve, {"stiffness": -1.0}),
        (admm.solve, {"augmentation": 0.0}),
        (admm.solve, {"relaxation": 2.5}),
        (uzawa.solve, {"inertia": 0.0}),
        (gauss_seidel.solve, {"sweeps": 0}),
        (simo_laursen.solve, {"updates": "often"}),
        (alart_curnier.solve, {"augmentation": float("nan")}),
        (panagiotopoulos.solve, {"form": "other"}),
        (lagrange.solve, {"problem": block_on_plane(0.1, d=3)}),
    ],
)
def test_bad_options_are_named(solver: Any, options: dict[str, Any]) -> None:
    problem = options.pop("problem", None) or wall(1, 1)
    with pytest.raises(MethodError):
        solver(problem, **options)


@pytest.mark.parametrize("method", ALL)
def test_progress_and_cancelling(method: str) -> None:
    seen: list[Progress] = []

    def watch(state: Progress) -> bool:
        seen.append(state)
        return len(seen) == 2

    solution = find(method)(wall(3, 3, alpha=0.3), progress=watch)
    assert solution.status is Status.CANCELLED
    assert len(seen) == 2
    assert {s.method for s in seen} == {method} == {solution.method}


@pytest.mark.parametrize("method", ALL)
def test_records(method: str) -> None:
    solution = of_a_wall(method)
    history, work = solution.info["history"], solution.info["work"]
    assert len(history) == len(work) == solution.iterations
    assert (np.diff(work) >= 0).all()
    assert work[-1] >= solution.factorisations
    if solution.solved:
        assert solution.certificate.worst <= 10 * min(history)


@pytest.mark.long
def test_jammed_arch_between_walls() -> None:
    problem = wall(3, 6, mu=1.0, base=False, sides=True, top=1.0)
    answers = [find(name)(problem) for name in ("lagrange", "simo-laursen", "admm")]
    assert all(solution.solved for solution in answers)
    weight = 18.0 + 6.0  # blocks and top load: friction on the side walls carries all of it
    held = problem.C_t.T @ answers[0].friction_force.ravel()
    held += problem.C_n.T @ answers[0].normal_force
    assert held[1::2].sum() == pytest.approx(weight, rel=1e-9)
    assert answers[0].gap.max() > 0.01  # an arch: joints open
