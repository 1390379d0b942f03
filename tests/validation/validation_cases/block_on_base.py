"""One block pushed sideways by a share of its weight: slides at mu, topples at b / h, whichever comes first."""

from __future__ import annotations

from functools import cache

import concio
from concio.solvers.statics.associated_limit import associated_limit
from validation_cases.row import Row

SOURCE = "Statics of a rigid block, by hand."

SIZES = ((0.3, 1.0, 1.0), (0.9, 0.4, 1.0), (0.5, 3.0, 0.5))


def block(mu: float, width: float, height: float, elastic: bool = False) -> concio.Model:
    return concio.column(
        width=width, height=height, blocks=1, block="elastic" if elastic else "rigid", friction=mu, horizontal=1.0
    )


@cache
def multiplier(mu: float, width: float, height: float, elastic: bool = False) -> float:
    assembly = concio.assemble(block(mu, width, height, elastic))
    dead = assembly.problem({"live": 0.0})
    return associated_limit(dead, assembly.problem().f - dead.f).multiplier


def verdict(mu: float, width: float, height: float, share: float) -> str:
    """Outcome of one step under a share of the weight."""
    return concio.solve(block(mu, width, height, True), factors={"live": share}, on_failure="return").status.name


def rows() -> list[Row]:
    found = []
    for mu, width, height in SIZES:
        wanted = min(mu, width / height)
        word = "slides" if mu < width / height else "topples"
        for elastic in (False, True):
            found.append(
                Row(
                    f"{width:g} x {height:g} m, mu = {mu:g}, {'elastic' if elastic else 'rigid'}: {word} at",
                    wanted,
                    multiplier(mu, width, height, elastic),
                    1e-9,
                    "linear programme: rounding",
                )
            )
        for factor, outcome in ((1 - 1e-4, "SOLVED"), (1 + 1e-4, "NO_EQUILIBRIUM")):
            found.append(
                Row(
                    f"{width:g} x {height:g} m, mu = {mu:g}, {outcome.lower()} at {factor:.4f} of it",
                    1.0,
                    float(verdict(mu, width, height, wanted * factor) == outcome),
                    0.0,
                    "yes or no",
                )
            )
    return found
