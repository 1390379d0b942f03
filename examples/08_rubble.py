"""A wall of irregular stones between two walls, repeatable by its seed."""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    model = concio.rubble(length=1.5, height=1.0, stone=0.25, seed=7, side_walls=True, top_pressure=50.0, friction=0.6)
    result = concio.solve(model)
    balance = sum(r[1] for r in result.reactions.values()) + result.total_load[1]
    print(f"{len(model.free_bodies)} stones, settlement {1e3 * result.max_settlement:.4f} mm")
    if figure:
        result.plot.forces().figure.savefig(figure)
    return {
        "worst": result.certificate.worst,
        "balance": balance / result.total_load[1],
        "stones": len(model.free_bodies),
    }


if __name__ == "__main__":
    main()
