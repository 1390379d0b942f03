"""What shows of a motion or a push that found no equilibrium at its start that there is none."""

from __future__ import annotations

from collections.abc import Mapping

from concio.analysis.step import solve
from concio.contact.assembly import Assembly
from concio.errors import ConcioError
from concio.model.model import Model
from concio.problem.solution import PROVEN_FAILURES


def proof_at_rest(about: Model | Assembly, factors: Mapping[str, float]) -> str:
    """Return what proves that the constant loads are not carried where the bodies stand; empty where nothing does."""
    try:
        result = solve(about, factors=factors, on_failure="return")
    except ConcioError:
        return ""
    return result.verdict.proof if result.solution.status in PROVEN_FAILURES else ""
