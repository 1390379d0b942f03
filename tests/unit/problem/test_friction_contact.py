"""The two forms of the friction contact community become contact problems; W may be singular."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

import concio
from concio.problem.contact_problem import ContactProblem
from concio.problem.friction_contact import global_problem, local_problem
from concio.solvers.methods import find


def wall_step(
    blocks: int = 4, courses: int = 3, push: float = 0.7
) -> tuple[ContactProblem, sp.csr_array, sp.csr_array]:
    """Return a problem of rigid blocks, its mass, and H with the normal of each contact first: one step of motion."""
    model = concio.wall(
        length=0.5 * blocks, height=0.25 * courses, block_size=(0.5, 0.25), friction=0.5,
        block=concio.Rigid(unit_weight=20.0), horizontal=push,
    )  # fmt: skip
    problem = concio.assemble(model).problem()
    m = problem.pairs
    order = np.column_stack([np.arange(m), m + np.arange(m)]).ravel()
    mass = np.abs(problem.f).max() * np.where(np.arange(problem.unknowns) % 3 == 2, 0.3, 1.1)
    return problem, sp.csr_array(sp.diags_array(mass)), sp.csr_array(problem.C[order].T)


def velocities(problem: ContactProblem, u: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return u = H' v + b, contact by contact."""
    return np.column_stack([problem.C_n @ u, problem.C_t @ u]).ravel() + free


def test_global_and_local_form_have_one_answer() -> None:
    problem, M, H = wall_step()
    q = problem.f
    whole = global_problem(M, H, q, np.zeros(H.shape[1]), 0.5, dim=2)
    inverse = sp.diags_array(1.0 / M.diagonal())
    W = H.T @ inverse @ H
    free = H.T @ (inverse @ q)
    alone = local_problem(W, free, np.full(problem.pairs, 0.5), dim=2)
    assert np.linalg.matrix_rank(W.toarray()) < W.shape[0]  # corners are redundant
    one, other = (find("auto")(p) for p in (whole, alone))
    assert one.solved
    assert other.solved
    assert max(one.certificate.worst, other.certificate.worst) < 1e-9
    assert np.abs(one.slip).max() > 1e-3 * np.abs(one.displacement).max() > 0  # the wall slides
    # velocities of contacts are the same; forces are not unique, what they do to the bodies is
    speed = np.abs(one.gap).max() + np.abs(one.slip).max()
    assert other.gap == pytest.approx(one.gap, abs=1e-7 * speed)
    assert other.slip == pytest.approx(one.slip, abs=1e-7 * speed)

    def push(found) -> np.ndarray:
        return H @ np.column_stack([found.normal_force, found.friction_force]).ravel()

    assert push(other) == pytest.approx(push(one), abs=1e-7 * np.abs(q).sum())


def test_the_answer_obeys_the_local_equations() -> None:
    rng = np.random.default_rng(4)
    for dim in (2, 3):
        m, r = 6, 5  # rank below the number of rows
        B = rng.normal(size=(m * dim, r))
        W, q, mu = B @ B.T, B @ rng.normal(size=r), rng.uniform(0.2, 0.9, m)
        problem = local_problem(W, q, mu, dim=dim)
        found = find("interior-point")(problem)
        force = np.column_stack([found.normal_force, found.friction_force])
        u = (W @ force.ravel() + q).reshape(m, dim)
        if not found.solved:
            continue  # a random operator may have no answer; what is answered must be right
        size = np.abs(q).max()
        assert u[:, 0].min() > -1e-8 * size
        assert np.abs(u[:, 0] * force[:, 0]).max() < 1e-7 * size**2
        slip = np.linalg.norm(u[:, 1:], axis=1)
        assert (np.linalg.norm(force[:, 1:], axis=1) <= mu * force[:, 0] + 1e-8 * size).all()
        work = (u[:, 1:] * force[:, 1:]).sum(1) + mu * force[:, 0] * slip
        assert np.abs(work).max() < 1e-6 * size**2


@pytest.mark.parametrize(
    ("blocks", "courses", "push", "least"), [(12, 9, 0.7, 600), pytest.param(30, 25, 0.2, 4000, marks=pytest.mark.long)]
)
def test_hundreds_of_sliding_contacts_and_thousands_at_rest(blocks: int, courses: int, push: float, least: int) -> None:
    problem, M, H = wall_step(blocks, courses, push)
    assert problem.pairs > least
    whole = find("auto")(global_problem(M, H, problem.f, np.zeros(H.shape[1]), 0.5, dim=2))
    inverse = sp.diags_array(1.0 / M.diagonal())
    alone = find("auto")(local_problem(H.T @ inverse @ H, H.T @ (inverse @ problem.f), 0.5, dim=2))
    assert whole.solved
    assert alone.solved
    assert (np.abs(whole.slip).max() > 0.1) == (push > 0.5)
    assert alone.slip == pytest.approx(whole.slip, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"W": np.diag([1.0, -1.0, 1.0, 1.0])}, "must be positive"),
        ({"W": np.triu(np.ones((4, 4)))}, "not symmetric"),
        ({"W": np.zeros((4, 4))}, "must be positive"),
        ({"W": np.full((4, 4), np.nan)}, "not finite"),
        ({"q": np.ones(3)}, "are not a problem"),
        ({"mu": np.ones(3)}, "one for each of 2"),
        ({"mu": -0.1}, "none negative"),
        ({"dim": 4}, "must be 2 or 3"),
    ],
)
def test_what_is_no_problem_is_told(change: dict[str, object], said: str) -> None:
    given = {"W": np.eye(4), "q": np.ones(4), "mu": 0.5, "dim": 2, **change}
    with pytest.raises(concio.InputError, match=said):
        local_problem(given["W"], given["q"], given["mu"], dim=given["dim"])


def test_global_shapes_are_checked() -> None:
    with pytest.raises(concio.InputError, match="do not fit together"):
        global_problem(np.eye(3), np.ones((3, 4)), np.ones(3), np.ones(2), 0.5, dim=2)
    with pytest.raises(concio.InputError, match="M is not symmetric"):
        global_problem(np.triu(np.ones((3, 3))), np.ones((3, 4)), np.ones(3), np.ones(4), 0.5, dim=2)
