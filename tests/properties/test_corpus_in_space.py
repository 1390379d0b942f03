"""A sample of the random corpus in space (benchmarks/corpus_space.py): every verdict is a proof, recomputed here."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from concio.solvers.methods import find
from samples import first

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmarks"))

from corpus_space import DECIDED, FAMILIES, draw, proven

SAMPLE = [(0, k) for k in (0, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 14, 15, 17, 34, 35)]

HARD = [(7, 44), pytest.param(7, 67, marks=pytest.mark.long)]
"""A motion of which all but a millionth is over long before the rest, and an equilibrium far from where it starts."""


@pytest.mark.parametrize(("seed", "k"), [*first(9, SAMPLE), *HARD])
def test_verdict_is_a_proof(seed: int, k: int) -> None:
    problem, _ = draw(np.random.default_rng([seed, k]), FAMILIES[k % len(FAMILIES)])
    found = find("auto")(problem)
    assert found.status.name in DECIDED
    assert proven(problem, found)


def test_a_false_verdict_is_seen() -> None:
    problem, _ = draw(np.random.default_rng([0, 2]), FAMILIES[2])
    found = find("auto")(problem)
    assert proven(problem, found)
    assert not proven(problem.with_loads(1.01 * problem.f), found)
