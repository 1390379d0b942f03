"""A wall in Flemish bond with a door under a lintel, and a tenth of its weight pushing sideways."""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    model = concio.wall(
        length=2.5,
        height=1.5,
        bond="flemish",
        openings=[{"x": 1.0, "y": 0.0, "width": 0.75, "height": 1.0, "lintel": 0.125}],
        lintel=concio.Elastic(E="12 GPa", nu=0.2, unit_weight=25),
        friction=0.7,
        horizontal=0.1,
        thickness=0.25,
    )
    result = concio.solve(model)
    contacts = result.contacts
    print(f"{len(model.free_bodies)} blocks, {len(contacts)} pairs: {contacts.count('open')} of them open")
    if figure:
        result.plot.forces().figure.savefig(figure)
    return {
        "worst": result.certificate.worst,
        "push": result.total_load[0],
        "reaction": result.reactions["ground"][0],
        "open": contacts.count("open"),
    }


if __name__ == "__main__":
    main()
