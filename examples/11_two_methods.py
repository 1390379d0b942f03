"""One wall, several methods, one certificate: displacements agree, and so do the resultants of the joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    assembly = concio.assemble(concio.wall(length=1.0, height=0.5, friction=0.6, horizontal=0.2, mesh_size=0.125))
    engine = concio.solve(assembly, method="interior-point")
    pivoting = concio.solve(assembly, method="lemke")
    scale = np.abs(engine.displacement).max()
    gap = np.abs(engine.displacement - pivoting.displacement).max() / scale
    print(f"displacements differ by {gap:.1e} of the largest")
    if figure:
        engine.plot.slip().figure.savefig(figure)
    return {"worst": max(engine.certificate.worst, pivoting.certificate.worst), "gap": float(gap)}


if __name__ == "__main__":
    main()
