"""One half of the ground sinks by 3 mm: the wall cracks in steps along its joints."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    wall = concio.wall(length=2.0, height=1.0, friction=0.6, ground=False, side_walls=True)
    grounds = [
        concio.Body(name, np.array([[x, -0.2], [x + 1, -0.2], [x + 1, 0], [x, 0]]), kind="fixed", role="ground")
        for name, x in (("left ground", 0.0), ("right ground", 1.0))
    ]
    walls = tuple(b for b in wall.bodies if b.role != "side wall")
    sinking = concio.Support("sinking", "right ground", displacement=(0.0, -0.003))
    model = replace(wall, bodies=(*grounds, *walls), supports=(sinking,))
    before = concio.solve(model, factors={"settlement": 0.0})
    after = concio.solve(model)
    for word, result in (("before", before), ("after", after)):
        print(f"{word}: {result.contacts.count('open')} of {len(result.contacts)} pairs open")
    if figure:
        after.plot.deformed().figure.savefig(figure)
    return {
        "worst": max(before.certificate.worst, after.certificate.worst),
        "opened": after.contacts.count("open") - before.contacts.count("open"),
        "weight": -after.total_load[1],
        "reactions": sum(r[1] for r in after.reactions.values()),
        "settled": after.max_settlement,
    }


if __name__ == "__main__":
    main()
