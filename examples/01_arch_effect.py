"""The arch effect: a panel hung between two walls carries its load sideways.

Ercolano's panel (blocks 0.2 x 0.1 m, friction 1, 10 kN/m2 on top) without a base. Each wall takes half of the load by
friction and a thrust that closes the arch; on a full base the same panel presses almost straight down.
"""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    options = {"courses": 3, "blocks": 6, "joint": 0.02, "friction": 1.0, "top_pressure": 10.0}
    hung = concio.solve(concio.running_bond_panel(base="none", **options))
    standing = concio.solve(concio.running_bond_panel(base="full", **options))
    thrust = {name: r.reactions["left wall"][0] for name, r in (("hung", hung), ("standing", standing))}
    print(f"thrust on a wall: {thrust['hung']:.3f} kN hung, {thrust['standing']:.3f} kN on a full base")
    if figure:
        hung.plot.principal().figure.savefig(figure)
    return {
        "hung": thrust["hung"],
        "standing": thrust["standing"],
        "friction": hung.reactions["left wall"][1],
        "load": -hung.total_load[1],
        "worst": max(hung.certificate.worst, standing.certificate.worst),
    }


if __name__ == "__main__":
    main()
