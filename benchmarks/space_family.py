"""The engine in space on walls, barrels and domes of growing size, against one sparse factorisation, in one run.

    python benchmarks/space_family.py [--large] [--elastic] [--close] [--limit] [--clarabel] [--fast] [--only NAME]
                                      [--markdown]

Blocks of running bond, domes and barrels (tests/space_problems.py), friction 0.6, own weight and a share of the
associated limit of a horizontal load. Rigid blocks have joints with stiffness; elastic ones 2 x 2 x 2 hexahedra.
Times are CPU seconds; the yardstick is one factorisation of K + C'DC of the same problem on the engine's own ordering,
so that ratios do not depend on the machine. The growth exponent is that of CPU time over the number of blocks from one
row of a family to the next; memory is the largest resident set so far, so that one family alone (``--only``) shows
its own.

``--close`` adds 0.97 and 0.99 of the associated limit, ``--limit`` the cone programme of that limit itself, which
``--clarabel`` (an optional package) solves as well, its answer rechecked from the same arrays.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sp

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "tests")]

from concio.problem.contact_problem import ContactProblem  # noqa: E402
from concio.solvers.algebra.scaled import scale  # noqa: E402
from concio.solvers.methods import find  # noqa: E402
from concio.solvers.statics.limit import associated_limit, kinematic_bound, static_residual  # noqa: E402
from space_problems import Built, barrel, dome, wall  # noqa: E402

OUT = (0.0, 1.0, 0.0)


HEADS = ("problem", "blocks", "pairs", "unknowns", "share", "outcome", "by", "worst", "iter", "fact", "CPU s", "one")
HEADS += ("ratio", "MB", "growth")
WIDTHS = (-26, 7, 9, 9, 7, -17, -30, 9, 6, 6, 9, 9, 8, 8, 8)
"""Columns of the table, with their widths; negative ones are set left."""


def row(cells: tuple[str, ...], *, markdown: bool = False) -> str:
    """Return one line of the table."""
    if markdown:
        return "| " + " | ".join(cells) + " |"
    return "".join(f"  {c:{-w - 2}s}" if w < 0 else f"{c:>{w}s}" for c, w in zip(cells, WIDTHS, strict=True))


def yardstick(problem: ContactProblem) -> float:
    """Return the CPU seconds of one factorisation of K + C'DC, the second of two."""
    s = scale(problem)
    blocks = np.broadcast_to(np.eye(3), (problem.pairs, 3, 3)).copy()
    s.factor.factorise(blocks, 1e-6)
    begin = time.process_time()
    s.factor.factorise(blocks, 1e-6)
    return time.process_time() - begin


def memory() -> float:
    """Return the largest resident set so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def report(
    name: str, built: Built, shares: tuple[float, ...], engine: str, last: tuple[int, float] | None, *, markdown: bool
) -> tuple[int, float]:
    """Solve under shares of the associated limit; return blocks and CPU seconds of the first."""
    problem = built.problem
    blocks = len(problem.bodies) - 1
    limit = associated_limit(problem, built.live).multiplier
    unit = yardstick(problem)
    first = 0.0
    for share in shares:
        step = built.at(share * limit)
        begin = time.process_time()
        found = find("auto")(step, engine=engine)
        seconds = time.process_time() - begin
        first = first or seconds
        growth = ""
        if last is not None and share == shares[0]:
            growth = f"{np.log(seconds / last[1]) / np.log(blocks / last[0]):8.2f}"
        by = str(found.info.get("strategy", "at rest"))
        cells = (
            *(name, f"{blocks}", f"{problem.pairs}", f"{problem.unknowns}", f"{share:.2f}", found.status.name, by),
            *(f"{found.certificate.worst:.1e}", f"{found.iterations}", f"{found.factorisations}", f"{seconds:.2f}"),
            *(f"{unit:.3f}", f"{seconds / unit:.1f}", f"{memory():.0f}", growth.strip()),
        )
        print(row(cells, markdown=markdown), flush=True)
    return blocks, first


def limits(name: str, built: Built, *, clarabel: bool) -> None:
    """Print multiplier, both residuals and time of the associated limit, by the own programme and by Clarabel."""
    problem = built.problem
    begin = time.process_time()
    own = associated_limit(problem, built.live)
    seconds = time.process_time() - begin
    violation = np.nan if own.mechanism is None else own.mechanism.violation
    print(
        f"{name:26s}{len(problem.bodies) - 1:7d}{problem.pairs:9d}  concio    {own.multiplier:.9f}  forces"
        f" {own.residual:.0e}, mechanism {violation:.0e}, gap {own.gap:.0e}, {seconds:.2f} s",
        flush=True,
    )
    if clarabel:
        by_clarabel(name, problem, built.live)


@dataclass(frozen=True)
class ClarabelLimit:
    """Clarabel's associated multiplier, with what forces leave, how far the motion is from admissible, and the gap."""

    multiplier: float
    forces: float
    violation: float
    gap: float
    seconds: float
    status: str


def clarabel_limit(problem: ContactProblem, live: np.ndarray) -> ClarabelLimit:
    """Return Clarabel's answer, rechecked from the original arrays."""
    import clarabel

    m, r = problem.pairs, problem.rigid_motions
    push = sp.csc_array(problem.R.T @ sp.hstack([problem.C_n.T, problem.C_t.T]))
    rows = sp.csc_array(sp.hstack([push, sp.csc_array((problem.R.T @ live)[:, None])]))
    mu = problem.laws.friction
    k = np.arange(m)
    cone = sp.coo_array(
        (
            np.concatenate([-mu, -np.ones(2 * m)]),
            (np.concatenate([3 * k, 3 * k + 1, 3 * k + 2]), np.concatenate([k, m + 2 * k, m + 2 * k + 1])),
        ),
        shape=(3 * m, 3 * m + 1),
    )
    A = sp.csc_matrix(sp.vstack([rows, cone]))
    b = np.concatenate([-(problem.R.T @ problem.f), np.zeros(3 * m)])
    cost = np.zeros(3 * m + 1)
    cost[-1] = -1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.ZeroConeT(r), *[clarabel.SecondOrderConeT(3)] * m]
    begin = time.process_time()
    found = clarabel.DefaultSolver(sp.csc_matrix((3 * m + 1,) * 2), cost, A, b, cones, settings).solve()
    seconds = time.process_time() - begin
    x, z = np.array(found.x), np.array(found.z)
    t_n, t_t = x[:m], x[m:-1].reshape(m, 2)
    left = static_residual(problem, problem.f + x[-1] * live, t_n, t_t)
    upper, mechanism = kinematic_bound(problem, live, float(x[-1]), problem.R @ z[:r])
    violation = mechanism.violation
    return ClarabelLimit(float(x[-1]), left, violation, abs(upper - x[-1]), seconds, str(found.status))


def by_clarabel(name: str, problem: ContactProblem, live: np.ndarray) -> None:
    """Print the same of Clarabel's answer."""
    found = clarabel_limit(problem, live)
    print(
        f"{name:26s}{len(problem.bodies) - 1:7d}{problem.pairs:9d}  clarabel  {found.multiplier:.9f}  forces"
        f" {found.forces:.0e}, mechanism {found.violation:.0e}, gap {found.gap:.0e}, {found.seconds:.2f} s,"
        f" '{found.status}'",
        flush=True,
    )


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="also some 2,000 and 10,000 rigid blocks")
    parser.add_argument("--elastic", action="store_true", help="also elastic blocks")
    parser.add_argument("--close", action="store_true", help="also 0.97 and 0.99 of the associated limit")
    parser.add_argument("--limit", action="store_true", help="the associated limits instead")
    parser.add_argument("--clarabel", action="store_true", help="with --limit: Clarabel beside it")
    parser.add_argument("--fast", action="store_true", help="engine pardiso (extra: fast)")
    parser.add_argument("--only", metavar="NAME", help="one family alone, such as 'wall, elastic'")
    parser.add_argument("--markdown", action="store_true", help="the table for the documentation")
    arguments = parser.parse_args()
    stiff = {"kn": 1e3}
    families: dict[str, list[Built]] = {
        "wall, rigid": [wall(10, 10, **stiff), wall(22, 23, **stiff)],
        "wall out of plane, rigid": [wall(22, 23, direction=OUT, **stiff)],
        "header wall, rigid": [wall(6, 8, leaves=3, **stiff)],
        "barrel, rigid": [barrel(24, 20, **stiff)],
        "dome, rigid": [dome(6, 16, **stiff), dome(10, 16, **stiff), dome(16, 32, **stiff)],
    }
    if arguments.large:
        families["wall, rigid"] += [wall(43, 45, **stiff), wall(98, 102, **stiff)]
    if arguments.elastic:
        sizes = [(10, 10), (22, 23), (31, 32)][: 3 if arguments.large else 2]
        families["wall, elastic"] = [wall(*size, elastic=True, mesh=(2, 2, 2)) for size in sizes]
    if arguments.only is not None:
        if arguments.only not in families:
            parser.error(f"--only: '{arguments.only}' is none of: " + "; ".join(families))
        families = {arguments.only: families[arguments.only]}
    if arguments.limit:
        for name, cases in families.items():
            for case in cases:
                limits(name, case, clarabel=arguments.clarabel)
        return
    print(row(HEADS, markdown=arguments.markdown))
    if arguments.markdown:
        print(row(("---",) * len(HEADS), markdown=True))
    shares = (0.5, 0.9, 0.97, 0.99) if arguments.close else (0.5, 0.9)
    for name, cases in families.items():
        last: tuple[int, float] | None = None
        for case in cases:
            engine = "pardiso" if arguments.fast else "superlu"
            last = report(name, case, shares, engine, last, markdown=arguments.markdown)


if __name__ == "__main__":
    main()
