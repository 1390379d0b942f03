"""A cross vault one of whose piers settles by 5 mm: cracks along the crowns, sliding at the groin stones.

Two barrels of 3 m, courses bonded round the groins, rigid blocks, friction 0.7. The vault follows the settlement by
opening joints; its weight is still carried, and forces and cracks come with a certificate.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    model = concio.cross_vault(span=3, ring=0.2, courses=15, block_length=0.5, block="rigid", friction=0.7)
    sinks = concio.Support("settlement", "springer 3", displacement=(0.0, 0.0, -5e-3))
    before, after = concio.solve(model), concio.solve(replace(model, supports=(sinks,)))
    lift = {name: [force[2] for force in result.reactions.values()] for name, result in
            (("before", before), ("after", after))}  # fmt: skip
    weight = -before.total_load[2]
    for name, forces in lift.items():
        print(f"{name}: " + ", ".join(f"{force:.2f}" for force in forces) + f" kN of {weight:.2f} kN")
    print(f"largest opening {1e3 * float(after.contacts.gap.max()):.2f} mm")
    if figure:
        after.plot.deformed(scale=40).figure.savefig(figure)
    return {
        "worst": max(before.certificate.worst, after.certificate.worst), "weight": weight,
        "before": sum(lift["before"]), "after": sum(lift["after"]), "opening": float(after.contacts.gap.max()),
        "sinking": lift["after"][2], "rest": lift["before"][2],
    }  # fmt: skip


if __name__ == "__main__":
    main()
