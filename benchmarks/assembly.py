"""Time from polygons to a solved wall: 10,000 blocks without any grid given, step by step, with ratios.

Run ``python benchmarks/assembly.py [length courses]``; the default is 100 x 100 units of running bond, 10,050 blocks.
"""

from __future__ import annotations

import sys
import time

import scipy.sparse.linalg as spla

import concio
from concio.contact.assembly import assemble
from concio.contact.detection import detect
from concio.contact.pairs import make_pairs
from concio.contact.sides import interface_breaks
from concio.fem.discretisation import discretise


def main(length: int = 100, courses: int = 100) -> None:
    """Build, assemble and solve one wall; print seconds and their ratio to one sparse factorisation of K + C'C."""
    rows = [("step", "seconds")]

    def timed(name, function, *arguments):
        begin = time.perf_counter()
        value = function(*arguments)
        rows.append((name, time.perf_counter() - begin))
        return value

    block = concio.Elastic(E=1e6, nu=0.15, unit_weight=20.0)
    model = timed(
        "outlines",
        lambda: concio.wall(
            length=0.5 * length, height=0.25 * courses, block_size=(0.5, 0.25), mesh_size=0.25, block=block,
            friction=0.6, horizontal=0.3,
        ),
    )  # fmt: skip
    found = timed("interfaces", detect, model)
    disc = timed("meshes", lambda: discretise(model, interface_breaks(model, found.interfaces)))
    timed("pairs", make_pairs, disc, found.interfaces)
    assembly = timed("all of assembly (again)", assemble, model)
    problem = timed("load step", assembly.problem)
    glued = (problem.K + problem.C.T @ problem.C).tocsc()
    timed("one factorisation", lambda: spla.splu(glued, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}))
    unit = rows[-1][1]
    result = timed("solve", lambda: concio.solve(assembly))
    print(f"{len(model.free_bodies):,} blocks, {problem.pairs:,} pairs, {problem.unknowns:,} unknowns, "
          f"{len(disc.shapes)} shapes, certificate {result.certificate.worst:.1e}")  # fmt: skip
    for name, seconds in rows[1:]:
        print(f"{name:26s} {seconds:8.2f} s  {seconds / unit:8.2f} factorisations")
    whole = sum(s for n, s in rows[1:] if n in ("outlines", "all of assembly (again)", "load step", "solve"))
    print(f"{'polygons to result':26s} {whole:8.2f} s  {whole / unit:8.2f} factorisations")


if __name__ == "__main__":
    main(*(int(a) for a in sys.argv[1:]))
