"""Contact problems with every joint law, for the tests of the pivoting methods."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import ContactProblem, Laws
from contact_problems import wall


def with_laws(problem: ContactProblem, seed: int, *names: str) -> ContactProblem:
    """Give every pair random values of the laws named: cohesion, tension, dilatancy, springs, cap, gap, origin."""
    rng = np.random.default_rng(seed)
    m = problem.pairs
    size = float(np.abs(problem.f).sum()) / m
    law = problem.laws
    spread = rng.uniform(0.5, 1.5, m)
    zero = np.zeros(m)
    cohesion = 0.3 * size * spread if "cohesion" in names or "tension" in names else zero
    laws = Laws(
        friction=law.friction,
        cohesion=cohesion,
        tension=0.5 * cohesion / np.maximum(law.friction, 0.1) if "tension" in names else zero,
        dilatancy=0.2 * spread if "dilatancy" in names else zero,
        normal_compliance=1e-3 * spread if "springs" in names else zero,
        tangential_compliance=2e-3 * spread if "springs" in names else zero,
        cap=8.0 * size * spread if "cap" in names else np.full(m, np.inf),
    )
    gap = 1e-3 * rng.uniform(0.0, 1.0, m) if "gap" in names else problem.gap
    origin = 1e-3 * rng.uniform(-1.0, 1.0, (m, 1)) if "origin" in names else problem.slip_origin
    return replace(problem, laws=laws, gap=gap, slip_origin=origin)


def small_wall(seed: int = 0, *names: str, **options: float) -> ContactProblem:
    """Return a small running-bond wall with laws of its own."""
    return with_laws(wall(**{"courses": 3, "blocks": 3, "alpha": 0.15, **options}), seed, *names)
