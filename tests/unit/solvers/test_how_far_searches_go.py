"""What stops a search: residuals of refined answers, points along a motion that proves, work of starts."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from concio.problem.limits_of_work import COLLAPSE_WORK
from concio.solvers.path.equations import POOR, SMALL, PathEquations
from concio.solvers.relaxation import unbounded_motion as unbounded
from concio.solvers.statics import collapse_search


@dataclass
class Inexact:
    """A diagonal matrix whose approximate inverse is wrong by a share; equations of a path refine its answers."""

    wrong: float
    diagonal: np.ndarray = field(default_factory=lambda: np.linspace(1.0, 3.0, 5))
    careful: bool = False
    control: np.ndarray = field(default_factory=lambda: np.ones(1))
    asked: int = 0

    def approximate(self, b: np.ndarray) -> np.ndarray:
        self.asked += 1
        return np.asarray(b / self.diagonal * (1.0 + self.wrong))

    def multiply(self, x: np.ndarray) -> np.ndarray:
        return np.asarray(self.diagonal * x)


@pytest.mark.parametrize(("wrong", "rounds"), [(1e-3, 8), (1e-2, 12), (-0.1, 20)])
def test_refinement_goes_on_while_it_gains(wrong: float, rounds: int) -> None:
    """Each round gains a factor: it ends at rounding, not where the residual is merely tolerable."""
    matrix = Inexact(wrong)
    b = np.array([1.0, -2.0, 3.0, 0.5, 1.0])
    x, residual = PathEquations.refined(matrix, b, rounds)  # type: ignore[arg-type]
    assert residual <= 10 * SMALL
    np.testing.assert_allclose(x, b / matrix.diagonal, rtol=1e-14)


def test_refinement_ends_where_it_gains_little_and_is_tolerable() -> None:
    """A residual of half a billionth that hardly falls is kept as it is; a large one is refined as long as it falls."""
    for start, few in ((0.5 * POOR, True), (0.9, False)):
        matrix = Inexact(0.0)
        share = [start * 0.9**k for k in range(40)]
        left = iter(share)

        def multiply(x: np.ndarray, left: Any = left) -> np.ndarray:
            return np.asarray(np.ones(5) * (1.0 - next(left)))

        matrix.multiply = multiply  # type: ignore[method-assign]
        _, residual = PathEquations.refined(matrix, np.ones(5), 8)  # type: ignore[arg-type]
        assert residual == pytest.approx(share[1] if few else share[7], rel=1e-5)


@pytest.mark.parametrize("seed", range(8))
def test_a_motion_is_shown_from_where_every_pair_that_opens_is_open(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pairs that open are open there, pairs that slip have slipped with the motion, and no further than they need."""
    rng = np.random.default_rng(seed)
    m, n = 12, 6
    a = rng.standard_normal(n)
    a /= np.abs(a).max()
    rate, rate[:, 0] = rng.uniform(-1.0, 1.0, (m, 2)), rng.choice([-0.5, 0.0, 0.3, 1.0], m)
    y = rng.uniform(-1.0, 1.0, (m, 2))
    t = np.column_stack([rng.choice([0.0, 0.0, 1.0], m), np.zeros(m)])
    seen: list[np.ndarray] = []
    problem = SimpleNamespace(R=np.eye(n))
    s = SimpleNamespace(
        problem=problem, dim=2, rough=rng.random(m) < 0.7, dilatancy=np.zeros(m), along=lambda v: rate,
        position=lambda u, t: y, acceleration=lambda v: v, restore=lambda u, t: (u, t[:, 0], t[:, 1:]),
    )  # fmt: skip

    def verify(problem: Any, a: np.ndarray, u: np.ndarray, t_n: np.ndarray, t_t: np.ndarray) -> Any:
        seen.append(u)
        return SimpleNamespace(certified=True)

    monkeypatch.setattr(unbounded, "verify_motion", verify)
    monkeypatch.setattr(unbounded, "product", lambda R, v: R @ v)
    monkeypatch.setattr(unbounded, "transposed_product", lambda R, v: R.T @ v)
    unbounded._proof(s, a, np.zeros(n), t)  # type: ignore[arg-type]
    (u,) = seen
    far = float(u @ a) / float(a @ a)
    opens = (rate[:, 0] > 0) & (y[:, 0] < 0) & (t[:, 0] <= 0)
    slip, speed = np.sign(rate[:, 1]) * y[:, 1], np.abs(rate[:, 1])
    behind = (slip < 0) & s.rough
    needed = np.concatenate([-y[opens, 0] / rate[opens, 0], -slip[behind] / speed[behind], [0.0]])
    assert far == pytest.approx(1.01 * needed.max())


@pytest.mark.parametrize(
    ("work", "pairs", "most"),
    [(COLLAPSE_WORK, 10, 25), (COLLAPSE_WORK, 35_000, 10), (COLLAPSE_WORK, 10**7, 1), (50_000, 10_000, 5),
     (50_000, 10, 25), (2 * COLLAPSE_WORK, 35_000, 10), (50_000, 0, 25)],
)  # fmt: skip
def test_a_start_iterates_as_long_as_its_share_of_the_work(
    work: int, pairs: int, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A smaller amount of work is that of one start; the usual one leaves a start more than the amount of all."""
    asked: list[int] = []

    class Search:
        programmes = 0
        most = 0.0

        def __init__(self, *args: Any) -> None:
            pass

        def run(self, strength: Any, most: int, start: int) -> bool:
            asked.append(most)
            return False

        def outcome(self, starts: int, *, cancelled: bool = False) -> Any:
            return starts, self.most

    monkeypatch.setattr(collapse_search, "_Search", Search)
    problem = SimpleNamespace(dim=2, pairs=pairs, cone=SimpleNamespace(strength=lambda n: n))
    top = SimpleNamespace(multiplier=1.0, upper=1.5, normal_force=np.ones(3))
    terms = SimpleNamespace(starts=None, iterations=None, work=work, progress=None)
    found = collapse_search._of_one(problem, np.ones(2), top, terms, {}, 0)  # type: ignore[arg-type]
    assert asked == [most]
    assert found == (1, 1.5), "no state above the larger of both bounds"
