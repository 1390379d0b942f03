"""Cells of four bonds: how stiff and how strong masonry is as a material, from the smallest piece that repeats.

Dry joints with friction 0.65 between blocks of 0.25 x 0.125 m. Under a vertical pressure of 100 kN/m2 friction on the
beds carries tension along them, without any cohesion: as much as the lap of the bond allows, and none in stack bond.
The section shows all vertical and shear stresses carried beside a horizontal tension of 30 kN/m2: stack bond carries
none of them. The domains are exact: half-spaces, each with the mechanism that proves it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import concio
from concio.plot import style
from concio.plot.strength_figure import COLOURS, DASHES


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    found: dict[str, float] = {}
    domains = {}
    for bond in ("stack", "running", "flemish", "english"):
        joint = concio.JointLaw(0.65, normal_stiffness="5 MN/m3", tangential_stiffness="2 MN/m3")
        cell = concio.cell(bond=bond, friction=joint, block=concio.Elastic("3 GPa", 0.2))
        moduli = concio.homogenise(cell)
        domains[bond] = concio.strength(cell, [(1, 0, 0)], stress=(0, -100, 0), coulomb=False)
        found[bond] = domains[bond].rays[0].multiplier
        found[f"{bond} E_x"], found[f"{bond} E_y"] = moduli.E_x, moduli.E_y
        print(
            f"{bond:8s} E_x {moduli.E_x:6.0f}, E_y {moduli.E_y:4.0f}, G_xy {moduli.G_xy:4.0f} kN/m2; "
            f"tension along the beds {found[bond]:6.2f} kN/m2, {len(domains[bond].faces)} half-spaces"
        )
    if figure:
        import matplotlib.pyplot as plt

        _, ax = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
        for k, (bond, domain) in enumerate(domains.items()):
            cut = domain.faces.section(np.eye(3)[1], np.eye(3)[2], np.array([30.0, 0, 0]), 300.0)
            if len(cut):
                word = f"{bond}: carries {found[bond]:.0f} kN/m2 along the beds under 100 kN/m2"
                ax.plot(*np.vstack([cut, cut[:1]]).T, color=COLOURS[k], ls=DASHES[k], label=word)
        ax.set(xlabel="vertical stress yy [kN/m2]", ylabel="shear stress xy [kN/m2]", xlim=(-250, 30), ylim=(-150, 150))
        ax.set_title("Carried beside a horizontal tension of 30 kN/m2", loc="left", fontsize=10, color=style.INK)
        ax.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(0, -0.16))
        ax.figure.savefig(figure)
    return found


if __name__ == "__main__":
    main()
