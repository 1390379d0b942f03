"""The corner of a chapel: two bonded walls, a door, a window, a barrel vault that pushes one of them out, and two ties.

The side wall carries one springing of the vault, a ring of 0.3 m over 3.5 m; the other springing is taken to be fixed.
Under its own weight the corner stands with and without the ties. Pushed outward it falls soon: the vault spreads, and
the side wall turns about its foot and tears a stepped wedge out of the facade. Two ties under the springing hold the
wall back; what fails then is the vault.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    common = {"block": "rigid", "unit_weight": 20.0, "friction": 0.6, "horizontal": 1.0, "towards": (0, -1)}
    window = {"x": 1.75, "y": 1.0, "width": 0.75, "height": 1.0, "lintel": 0.25}
    door = {"x": 1.5, "y": 0.0, "width": 1.0, "height": 2.0, "lintel": 0.25}
    walls = concio.walls(
        lines=[{"start": (0, 0), "end": (4, 0), "openings": [window]},
               {"start": (0, 0), "end": (0, 4), "openings": [door]}],
        height=3.0, block_size=(0.75, 0.5, 0.25), **common,
    )  # fmt: skip
    vault = concio.barrel(span=3.5, ring=0.3, length=3.75, voussoirs=15, blocks=5, **common)
    vault = concio.place(vault, at=(0.25, 2.0, 3.0), turn=-90, name="vault", without="right abutment", loads="world")
    chapel = concio.merge(walls, vault, title="Corner of a chapel")
    ties = [
        concio.Tie(f"tie {k}", body, (x, 0.0, 2.875), "vault-left abutment", (x, 4.0, 2.875), stiffness=20e3)
        for k, (body, x) in enumerate((("w1-c12-b02", 1.0), ("w1-c12-b05", 3.0)), 1)
    ]
    tied = replace(chapel, ties=ties)
    found, falls = {}, []
    for name, model, push in (("without ties", chapel, 0.1), ("with two ties", tied, 0.3)):
        stands = concio.solve(model, factors={"live": 0.0})
        bound = concio.limit(model, path=False, steps=False, search=False).associated
        falls.append(concio.solve(model, factors={"live": push}, on_failure="return"))
        found |= {name: bound.multiplier, f"{name}, error": stands.certificate.worst}
        print(f"{name}: {stands.sentence} No equilibrium beyond {bound.multiplier:.4f} of the weight sideways.")
    if figure:
        from matplotlib.figure import Figure

        sheet = Figure(figsize=(11.0, 5.6), layout="constrained")
        for result, axes in zip(falls, sheet.subplots(1, 2), strict=True):
            result.plot.mechanism(axes)
        sheet.savefig(figure)
    return {**found, "fall": float(all(result.status is concio.Status.NO_EQUILIBRIUM for result in falls))}


if __name__ == "__main__":
    main()
