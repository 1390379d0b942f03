"""Do equal blocks condensed once pay? The engine on walls, whole and condensed: ``python benchmarks/condensation.py``.

The inner unknowns of every body, those no contact meets, are eliminated: one dense Cholesky factor and one reduced
stiffness for each shape of block. The engine solves the condensed problem, the inner displacements follow from the
boundary, and the answer is judged on the whole problem. Times are CPU times, both in one run.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
from wall_family import wall_model

from concio.contact.assembly import assemble
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import Solution, judge
from concio.solvers.methods import find

WALLS = ((10, 10, 2, 2), (10, 10, 4, 4), (10, 10, 8, 4), (10, 10, 8, 8), (10, 10, 16, 8), (20, 20, 8, 4))
"""Units, courses, elements of a block along and across."""


def condense(problem: ContactProblem) -> tuple[ContactProblem, Callable[[Solution], Solution], int]:
    """Return the condensed problem, what brings its answer back, and the number of shapes."""
    touched = np.diff(sp.vstack([problem.C_n, problem.C_t]).tocsc().indptr) > 0
    K, f = sp.csr_array(problem.K), problem.f.copy()
    shapes: dict[tuple[bytes, bytes], tuple[Array, Array, Array, Array]] = {}
    ranges = list(zip(problem.bodies[:-1].tolist(), problem.bodies[1:].tolist(), strict=True))
    parts: list[tuple[Array, Array, Array, Array]] = []
    for first, last in ranges:
        block, meets = K[first:last, first:last].toarray(), touched[first:last]
        key = meets.tobytes(), np.round(block / (np.abs(block).max(initial=0.0) or 1.0), 11).tobytes()
        if key not in shapes:
            inner = np.flatnonzero(~meets) if block.any() else np.zeros(0, dtype=int)
            outer = np.setdiff1d(np.arange(last - first), inner)
            inverse = sl.inv(block[np.ix_(inner, inner)]) if inner.size else np.zeros((0, 0))
            follow = -inverse @ block[np.ix_(inner, outer)]
            reduced = block[np.ix_(outer, outer)] + block[np.ix_(outer, inner)] @ follow
            shapes[key] = outer, inner, follow, 0.5 * (reduced + reduced.T)
        parts.append(shapes[key])
        outer, inner, follow, _ = shapes[key]
        f[first + outer] += follow.T @ problem.f[first + inner]
    keep = np.concatenate([first + part[0] for (first, _), part in zip(ranges, parts, strict=True)])
    bodies = np.concatenate([[0], np.cumsum([part[0].size for part in parts])])
    R = sp.csr_array(problem.R)[keep].toarray()
    body = np.searchsorted(bodies, np.abs(R).argmax(axis=0), side="right") - 1
    for k in np.unique(body):
        rows, columns = slice(bodies[k], bodies[k + 1]), np.flatnonzero(body == k)
        R[rows, columns] = np.linalg.qr(R[rows, columns])[0]
    condensed = replace(
        problem,
        K=sp.csr_array(sp.block_diag([part[3] for part in parts])),
        f=f[keep],
        C_n=sp.csr_array(problem.C_n)[:, keep],
        C_t=sp.csr_array(problem.C_t)[:, keep],
        R=sp.csc_array(R),
        bodies=bodies,
        inertia=problem.inertia[keep][:, keep],
        load=problem.load or float(np.abs(problem.f).sum()),
    )

    def whole(answer: Solution) -> Solution:
        u = np.zeros(problem.unknowns)
        u[keep] = answer.displacement
        for (first, last), (outer, inner, follow, _) in zip(ranges, parts, strict=True):
            if inner.size:
                block = K[first:last, first:last].toarray()[np.ix_(inner, inner)]
                loaded = sl.solve(block, problem.f[first + inner], assume_a="pos")
                u[first + inner] = loaded + follow @ u[first + outer]
        return judge(problem, u, answer.normal_force, answer.friction_force, method="condensed")

    return condensed, whole, len(shapes)


def main() -> None:
    """Print the table."""
    solve = find("interior-point")
    heads = ("unknowns", "condensed", "K entries", "condensed", "whole s", "cond. s")
    print(f"{'wall':16s}" + "".join(f"{head:>11s}" for head in heads))
    for size in WALLS:
        units, courses, *elements = size
        problem = assemble(wall_model(units, courses, 0.2, elements)).problem()
        begin = time.process_time()
        answer = solve(problem)
        middle = time.process_time()
        small, whole, _ = condense(problem)
        other = whole(solve(small))
        end = time.process_time()
        assert answer.solved
        assert other.solved
        print(
            f"{'{} x {}, {} x {}'.format(*size):16s}{problem.unknowns:11d}{small.unknowns:11d}{problem.K.nnz:11d}"
            f"{small.K.nnz:11d}{middle - begin:11.2f}{end - middle:11.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
