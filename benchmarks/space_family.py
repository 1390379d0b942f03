"""The engine in space on walls, barrels and domes of growing size, against one sparse factorisation, in one run.

    python benchmarks/space_family.py [--large] [--elastic] [--close] [--fast] [--only NAME] [--blocks N ...]
                                      [--shares S ...] [--markdown]
    python benchmarks/space_family.py --limits [--clarabel] [--large] [--only NAME] [--blocks N ...] [--markdown]

Blocks of running bond, domes and barrels (tests/space_problems.py), friction 0.6, self-weight and a share of the
associated limit of a horizontal load. Rigid blocks have joints with stiffness; elastic ones 2 x 2 x 2 hexahedra.
Times are CPU seconds; the yardstick is one factorisation of K + C'DC of the same problem on the engine's own ordering,
so that ratios do not depend on the machine. The growth exponent is that of CPU time over the number of blocks from one
row of a family to the next; memory is the largest resident set so far, so that one row alone (``--only`` and
``--blocks``) shows its own.

``--close`` adds 0.97 and 0.99 of the associated limit. ``--limits`` measures the cone programme of that limit instead,
of families of their own about 100, 400 and 1,000 blocks (``--large``: 2,000): least and largest of three runs (one
from 1,000 blocks on); ``--clarabel`` (an optional package) solves it as well, its answer rechecked from the same
arrays.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from unittest.mock import patch

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "tests")]

from concio.problem.contact_problem import ContactProblem  # noqa: E402
from concio.solvers.algebra.scaled import scale  # noqa: E402
from concio.solvers.methods import find  # noqa: E402
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit, kinematic_bound, static_residual  # noqa: E402
from space_problems import Built, barrel, dome, wall  # noqa: E402

OUT = (0.0, 1.0, 0.0)


HEADS = ("problem", "blocks", "pairs", "unknowns", "share", "outcome", "by", "worst", "iter", "fact", "CPU s", "one")
HEADS += ("ratio", "MB", "growth")
WIDTHS = (-26, 7, 9, 9, 7, -17, -30, 9, 6, 6, 9, 9, 8, 8, 8)
"""Columns of the table, with their widths; negative ones are set left."""

LIMIT_HEADS = ("problem", "blocks", "pairs", "by", "multiplier", "forces", "motion", "gap", "fact", "CPU s", "at most")
LIMIT_HEADS += ("one", "ratio", "MB", "growth")
LIMIT_WIDTHS = (-26, 7, 9, -20, 13, 8, 8, 8, 6, 9, 9, 9, 8, 8, 8)

STIFF = {"kn": 1e3}

FAMILIES: dict[str, dict[int, Callable[[], Built]]] = {
    "wall, rigid": {
        105: partial(wall, 10, 10, **STIFF),
        517: partial(wall, 22, 23, **STIFF),
        1957: partial(wall, 43, 45, **STIFF),
        10047: partial(wall, 98, 102, **STIFF),
    },
    "wall out of plane, rigid": {517: partial(wall, 22, 23, direction=OUT, **STIFF)},
    "header wall, rigid": {168: partial(wall, 6, 8, leaves=3, **STIFF)},
    "barrel, rigid": {492: partial(barrel, 24, 20, **STIFF)},
    "dome, rigid": {
        96: partial(dome, 6, 16, **STIFF),
        160: partial(dome, 10, 16, **STIFF),
        512: partial(dome, 16, 32, **STIFF),
    },
    "wall, elastic": {
        105: partial(wall, 10, 10, elastic=True, mesh=(2, 2, 2)),
        517: partial(wall, 22, 23, elastic=True, mesh=(2, 2, 2)),
        1008: partial(wall, 31, 32, elastic=True, mesh=(2, 2, 2)),
    },
}
"""Builders by family and number of blocks."""

WALLS = {105: (10, 10), 410: (20, 20), 1008: (31, 32), 1957: (43, 45)}
BARRELS = {104: (11, 9), 402: (23, 17), 1017: (37, 27), 2014: (51, 39)}
DOMES = {105: (7, 15), 403: (13, 31), 1000: (20, 50), 2001: (29, 69)}
"""Sizes of the limit programmes by number of blocks."""

LIMIT_FAMILIES: dict[str, dict[int, Callable[[], Built]]] = {
    "wall": {n: partial(wall, *size) for n, size in WALLS.items()},
    "wall out of plane": {n: partial(wall, *size, direction=OUT) for n, size in WALLS.items()},
    "barrel across": {n: partial(barrel, *size) for n, size in BARRELS.items()},
    "barrel along": {n: partial(barrel, *size, direction=OUT) for n, size in BARRELS.items()},
    "dome": {n: partial(dome, *size) for n, size in DOMES.items()},
}
"""Of the limit programmes: rigid blocks on hard joints."""


def row(cells: tuple[str, ...], widths: tuple[int, ...], *, markdown: bool = False) -> str:
    """Return one line of a table; columns of negative width are set left."""
    if markdown:
        return "| " + " | ".join(cells) + " |"
    return "".join(f"  {c:{-w - 2}s}" if w < 0 else f"{c:>{w}s}" for c, w in zip(cells, widths, strict=True))


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
        certified = f"{found.certificate.worst:.1e}" if found.solved else ""
        cells = (
            *(name, f"{blocks}", f"{problem.pairs}", f"{problem.unknowns}", f"{share:.2f}", found.status.name, by),
            *(certified, f"{found.iterations}", f"{found.factorisations}", f"{seconds:.2f}"),
            *(f"{unit:.3f}", f"{seconds / unit:.1f}", f"{memory():.0f}", growth.strip()),
        )
        print(row(cells, WIDTHS, markdown=markdown), flush=True)
    return blocks, first


def counted(problem: ContactProblem, live: np.ndarray) -> tuple[LimitLoad, int]:
    """Return the associated limit and how often its programme factorised."""
    with patch.object(sla, "splu", side_effect=sla.splu) as calls:
        return associated_limit(problem, live), calls.call_count


def limits(
    name: str, built: Built, last: tuple[int, float] | None, *, clarabel: bool, markdown: bool
) -> tuple[int, float]:
    """Print the associated limit by the own programme and by Clarabel; return blocks and least CPU seconds."""
    problem = built.problem
    blocks = len(problem.bodies) - 1
    spent = []
    for _ in range(3 if blocks < 1000 else 1):
        begin = time.process_time()
        own = associated_limit(problem, built.live)
        spent.append(time.process_time() - begin)
    used = memory()
    least, unit = min(spent), yardstick(problem)
    growth = "" if last is None else f"{np.log(least / last[1]) / np.log(blocks / last[0]):.2f}"
    violation = np.nan if own.mechanism is None else own.mechanism.violation
    cells = (
        *(name, f"{blocks}", f"{problem.pairs}", "concio", f"{own.multiplier:.9f}", f"{own.residual:.0e}"),
        *(f"{violation:.0e}", f"{own.gap:.0e}", f"{counted(problem, built.live)[1]}", f"{least:.2f}"),
        *(f"{max(spent):.2f}", f"{unit:.3f}", f"{least / unit:.0f}", f"{used:.0f}", growth),
    )
    print(row(cells, LIMIT_WIDTHS, markdown=markdown), flush=True)
    if clarabel:
        found = clarabel_limit(problem, built.live)
        cells = (
            *(name, f"{blocks}", f"{problem.pairs}", f"Clarabel, '{found.status}'", f"{found.multiplier:.9f}"),
            *(f"{found.forces:.0e}", f"{found.violation:.0e}", f"{found.gap:.0e}", "", f"{found.seconds:.2f}"),
            *("", "", f"{found.seconds / unit:.0f}", "", ""),
        )
        print(row(cells, LIMIT_WIDTHS, markdown=markdown), flush=True)
    return blocks, least


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


def chosen(arguments: argparse.Namespace) -> dict[str, dict[int, Callable[[], Built]]]:
    """Return the builders asked for, by family and number of blocks."""
    families = LIMIT_FAMILIES if arguments.limits else FAMILIES
    if arguments.only is not None and arguments.only not in families:
        raise ValueError(f"--only: '{arguments.only}' is none of: " + "; ".join(families))
    found = {name: cases for name, cases in families.items() if arguments.only in (None, name)}
    if not arguments.elastic and arguments.only != "wall, elastic":
        found.pop("wall, elastic", None)
    if arguments.blocks:
        found = {name: {n: c for n, c in cases.items() if n in arguments.blocks} for name, cases in found.items()}
        if not any(found.values()):
            sizes = "; ".join(f"{name}: {', '.join(map(str, cases))}" for name, cases in families.items())
            raise ValueError(f"--blocks: no such size; there are {sizes}")
        return {name: cases for name, cases in found.items() if cases}
    if arguments.large:
        return found
    return {
        name: {n: c for n, c in cases.items() if n <= (517 if "elastic" in name else 1500)}
        for name, cases in found.items()
    }


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--large", action="store_true", help="also some 2,000 and 10,000 rigid blocks")
    parser.add_argument("--elastic", action="store_true", help="also elastic blocks")
    parser.add_argument("--close", action="store_true", help="also 0.97 and 0.99 of the associated limit")
    parser.add_argument("--limits", action="store_true", help="the associated limits instead")
    parser.add_argument("--clarabel", action="store_true", help="with --limits: Clarabel beside it")
    parser.add_argument("--fast", action="store_true", help="engine pardiso (extra: fast)")
    parser.add_argument("--only", metavar="NAME", help="one family alone, such as 'wall, elastic'")
    parser.add_argument("--blocks", type=int, nargs="+", metavar="N", help="only structures of so many blocks")
    parser.add_argument("--shares", type=float, nargs="+", metavar="S", help="shares of the associated limit")
    parser.add_argument("--markdown", action="store_true", help="the table for the documentation")
    arguments = parser.parse_args()
    try:
        families = chosen(arguments)
    except ValueError as error:
        parser.error(str(error))
    heads, widths = (LIMIT_HEADS, LIMIT_WIDTHS) if arguments.limits else (HEADS, WIDTHS)
    print(row(heads, widths, markdown=arguments.markdown))
    if arguments.markdown:
        print(row(("---",) * len(heads), widths, markdown=True))
    shares = arguments.shares or ((0.5, 0.9, 0.97, 0.99) if arguments.close else (0.5, 0.9))
    engine = "pardiso" if arguments.fast else "superlu"
    for name, cases in families.items():
        last: tuple[int, float] | None = None
        for case in cases.values():
            if arguments.limits:
                last = limits(name, case(), last, clarabel=arguments.clarabel, markdown=arguments.markdown)
            else:
                last = report(name, case(), tuple(shares), engine, last, markdown=arguments.markdown)


if __name__ == "__main__":
    main()
