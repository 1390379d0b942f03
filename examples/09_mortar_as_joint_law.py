"""Brickwork in the simplified way: thin mortar as a joint law with stiffness, cohesion, tensile strength and a cap."""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    mortar = concio.JointLaw(
        friction=0.75,
        cohesion="0.2 MPa",
        tensile_strength="0.1 MPa",
        normal_stiffness=8e7,
        tangential_stiffness=3.5e7,
        compressive_strength="8 MPa",
    )
    brick = concio.Elastic(E="16 GPa", nu=0.15, unit_weight=18)
    options = {
        "length": 1.0,
        "height": 0.75,
        "block_size": (0.25, 0.125),
        "thickness": 0.1,
        "horizontal": 1.5,
        "block": brick,
    }
    glued = concio.solve(concio.wall(friction=mortar, **options))
    dry = concio.solve(concio.wall(friction=0.75, **options), on_failure="return")
    print(f"with mortar: {glued.status.name}; dry: {dry.status.name}")
    if figure:
        glued.plot.pressure().figure.savefig(figure)
    return {
        "worst": glued.certificate.worst,
        "tension": float(-glued.contacts.pressure.min()),
        "strength": 100.0,
        "dry falls": float(dry.status is concio.Status.NO_EQUILIBRIUM),
    }


if __name__ == "__main__":
    main()
