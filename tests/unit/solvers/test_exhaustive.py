"""Exhaustive search: the same verdicts as trying every combination of joint states, and proofs that can be refused."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import linprog

from concio.errors import MethodError
from concio.problem.contact_problem import ContactProblem, Laws
from concio.problem.solution import Status
from concio.solvers.methods.exhaustive.clauses import ClauseSearch
from concio.solvers.methods.exhaustive.relaxation import Relaxation
from concio.solvers.methods.exhaustive.state_questions import Empty, StateQuestions
from concio.solvers.methods.exhaustive.state_search import solve
from concio.solvers.statics.existence import statically_admissible
from contact_problems import wall
from lcp_problems import small_wall
from samples import first, sample

pytest.importorskip("highspy")


def tiny(seed: int, pairs: int = 3, smooth: bool = False) -> ContactProblem:
    """Return one random body with as many rigid motions as pairs, one less elastic, under loads close to the limit.

    The loads are balanced by forces on the edges of two friction cones plus a hundredth from inside all cones.
    """
    rng = np.random.default_rng(seed)
    r, N = pairs, 2 * pairs - 1
    basis = np.linalg.qr(rng.normal(size=(N, N)))[0]
    R = basis[:, :r]
    K = basis[:, r:] @ np.diag(rng.uniform(0.5, 2.0, N - r)) @ basis[:, r:].T
    C_n, C_t = rng.normal(size=(2, pairs, N))
    mu = rng.uniform(0.3, 1.5, pairs)
    if smooth:
        mu[0] = 0.0
    t_n = 0.01 * rng.exponential(size=pairs)
    t_t = mu * t_n * rng.uniform(-1.0, 1.0, pairs)
    for k in rng.choice(pairs, 2, replace=False):
        more = rng.exponential()
        t_n[k] += more
        t_t[k] += rng.choice([-1, 1]) * mu[k] * more
    f = K @ rng.normal(size=N) - C_n.T @ t_n - C_t.T @ t_t
    shape = sp.csr_array(K), f, sp.csr_array(C_n), sp.csr_array(C_t), np.zeros(pairs)
    return ContactProblem(*shape, Laws.coulomb(mu), sp.csc_array(R), np.array([0, N]))


def some_state_exists(problem: ContactProblem) -> bool:
    """Try all 4^m states, each a linear programme in (u, t_n, t_t) written from the laws themselves."""
    m, N, mu = problem.pairs, problem.unknowns, problem.laws.friction
    C_n, C_t = problem.C_n.toarray(), problem.C_t.toarray()
    balance = np.hstack([problem.K.toarray(), -C_n.T, -C_t.T])
    for states in product(range(4), repeat=m):
        equal, less = [(row, b) for row, b in zip(balance, problem.f, strict=True)], []
        for k, state in enumerate(states):
            gap, slip, t_n, t_t = np.zeros((4, N + 2 * m))
            gap[:N], slip[:N], t_n[N + k], t_t[N + m + k] = C_n[k], C_t[k], 1.0, 1.0
            if state == 0:
                equal += [(t_n, 0.0), (t_t, 0.0)]
                less += [(-gap, problem.gap[k])]
                continue
            equal += [(gap, -problem.gap[k])]
            less += [(-t_n, 0.0)]
            if state == 1:
                equal += [(slip, 0.0)]
                less += [(t_t - mu[k] * t_n, 0.0), (-t_t - mu[k] * t_n, 0.0)]
            else:
                sign = 1.0 if state == 2 else -1.0
                equal += [(t_t + sign * mu[k] * t_n, 0.0)]
                less += [(-sign * slip, 0.0)]
        A, b = np.array([e[0] for e in equal]), np.array([e[1] for e in equal])
        G, h = np.array([e[0] for e in less]), np.array([e[1] for e in less])
        if linprog(np.zeros(N + 2 * m), G, h, A, b, bounds=(None, None)).status == 0:
            return True
    return False


@pytest.mark.parametrize(("pairs", "smooth"), first(2, [(2, False), (3, True), (3, False)]))
def test_same_verdict_as_trying_every_state(pairs: int, smooth: bool) -> None:
    verdicts = []
    for seed in range(sample(10, 30)):
        problem = tiny(seed, pairs, smooth)
        assert statically_admissible(problem).exists
        answer = solve(problem)
        exists = some_state_exists(problem)
        assert answer.status is (Status.SOLVED if exists else Status.NO_COULOMB_STATE), seed
        assert answer.info["reach"] >= 1e7
        verdicts.append(exists)
    assert 0.1 <= np.mean(verdicts) <= 0.9  # both verdicts are met, though statics admits every load


@pytest.mark.parametrize("mu", [0.3, 2.0])
@pytest.mark.parametrize("load", [-3.0, -0.5, 0.2, 1.5, 3.5])
def test_one_node_always_has_a_state(mu: float, load: float) -> None:
    """Klarbring's node (1990), two degrees of freedom coupled by -1 over an obstacle: nothing floats."""
    problem = ContactProblem(
        K=sp.csr_array(np.array([[1.0, -1.0], [-1.0, 2.0]])),
        f=np.array([load, -1.0]),
        C_n=sp.csr_array(np.array([[0.0, 1.0]])),
        C_t=sp.csr_array(np.array([[1.0, 0.0]])),
        gap=np.zeros(1),
        laws=Laws.coulomb(mu, 1),
        R=sp.csc_array((2, 0)),
        bodies=np.array([0, 2]),
    )
    assert solve(problem).solved


@pytest.mark.parametrize("alpha", [0.0, 0.1, 0.2])
def test_never_excludes_a_wall_that_stands(alpha: float) -> None:
    answer = solve(wall(2, 2, alpha=alpha), node_limit=400)
    assert answer.status in (Status.SOLVED, Status.UNDECIDED)


def test_collapse_is_excluded_too() -> None:
    answer = solve(wall(2, 2, alpha=3.0))
    assert answer.status is Status.NO_COULOMB_STATE
    assert answer.status.exit_code == 3


def test_limits_cancelling_and_laws() -> None:
    problem = wall(3, 3, alpha=0.3)
    assert solve(problem, node_limit=1).status in (Status.UNDECIDED, Status.SOLVED)
    assert solve(problem, progress=lambda p: True).status in (Status.CANCELLED, Status.SOLVED)
    with pytest.raises(MethodError, match="cohesion"):
        solve(small_wall(1, "cohesion"))


def test_a_proof_holds_only_with_its_reasons() -> None:
    """Drop any reason of a minimal proof and the relaxation is not empty; a made-up combination proves nothing."""
    problem = next(p for p in map(tiny, range(30)) if not some_state_exists(p))
    lp = Relaxation(problem)
    assert not isinstance(lp.point(np.zeros(lp.n, dtype=bool)), Empty)
    questions = StateQuestions(lp.m, lp.reduction.rough)
    everything = questions.fixed([2 * q + 1 for q in range(questions.count)])  # all pairs stick
    found = lp.point(everything)
    assert isinstance(found, Empty)
    minimal = found
    for column in found.reasons:
        trial = np.zeros(lp.n, dtype=bool)
        trial[minimal.reasons[minimal.reasons != column]] = True
        fewer = lp.point(trial)
        if isinstance(fewer, Empty):
            minimal = fewer
    for column in minimal.reasons:
        trial = np.zeros(lp.n, dtype=bool)
        trial[minimal.reasons[minimal.reasons != column]] = True
        assert not isinstance(lp.point(trial), Empty)
    rng = np.random.default_rng(0)
    rows = lp.m + lp.k + problem.rigid_motions
    assert all(lp.proof(rng.normal(size=rows), everything) is None for _ in range(20))


def test_clauses_agree_with_truth_tables() -> None:
    rng = np.random.default_rng(3)
    met = set()
    for _ in range(200):
        questions = 8
        clauses = [
            [int(2 * v + rng.integers(2)) for v in rng.choice(questions, size=3, replace=False)]
            for _ in range(int(rng.integers(20, 60)))
        ]
        truth = any(
            all(any(row[q >> 1] != (q & 1) for q in clause) for clause in clauses)
            for row in product((0, 1), repeat=questions)
        )
        search = ClauseSearch(questions)
        for clause in clauses:
            search.add(clause)
        found = None
        while found is None:
            conflict = search.propagate()
            if conflict is not None:
                found = None if search.learn(conflict) else False
            elif -1 in search.answer:
                search.decide(2 * search.answer.index(-1) + int(rng.integers(2)))
            else:
                found = True
                assert all(any(search.holds(q) for q in clause) for clause in clauses)
        assert found == truth
        met.add(truth)
    assert met == {True, False}
