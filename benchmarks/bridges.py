"""Positions of a vehicle on arch bridges: seconds for the worst position to 10 mm, and for 100 positions of a viaduct.

python benchmarks/bridges.py

Prints, for Prestwood bridge and for three spans of two rings on piers: positions, the worst of them, its load factor,
the seconds of the search, and how many of its bounds are proved from both sides. Then the seconds of an assessment.
"""

from __future__ import annotations

import time

import concio
from concio.analysis.bridges.sweep import Sweep, search

AXLE = concio.Vehicle("axle", (concio.Axle(0.0, 100.0),))


def prestwood(voussoirs: int = 80) -> concio.Model:
    """Return Prestwood bridge under one axle; nothing slides."""
    model = concio.bridge(span=6.55, rise=1.428, ring=0.22, voussoirs=voussoirs, width=3.8, block="rigid",
                          friction=1e3, unit_weight=20.0)  # fmt: skip
    return concio.with_vehicle(concio.with_fill(model, concio.Fill(cover=0.165, passive=1.0)), AXLE)


def viaduct(voussoirs: int = 40) -> concio.Model:
    """Return three spans of two rings on piers."""
    model = concio.bridge(
        span=[6.0, 7.5, 6.0], rise=[1.5, 1.875, 1.5], ring=[0.22, 0.22], ring_friction=0.5, voussoirs=voussoirs,
        width=4.0, pier_width=1.6, pier_height=4.0, pier_courses=4, backing=0.5, block="rigid", friction=0.6,
        unit_weight=22.0,
    )  # fmt: skip
    filled = concio.with_fill(model, concio.Fill(cover=0.4, unit_weight=19.0, friction_angle=30.0, mobilised=0.33))
    return concio.with_vehicle(filled, AXLE)


def main() -> None:
    """Measure and print."""
    for name, model, positions in (("Prestwood", prestwood(), None), ("viaduct", viaduct(), 100)):
        start = time.perf_counter()
        sweep = Sweep(model)
        low, high = sweep.reach()
        found = search(sweep, step=None if positions is None else (high - low) / (positions - 1))
        seconds = time.perf_counter() - start
        worst = min(found, key=lambda s: s.multiplier)
        proved = sum(s.limit.checked for s in found)
        print(f"{name:10s} {len(found)} positions, worst x = {worst.position:.3f} m at {worst.multiplier:.4f}: "
              f"{seconds:.1f} s, {proved} proved")  # fmt: skip
    start = time.perf_counter()
    concio.assess_bridge(prestwood(40))
    print(f"whole assessment of Prestwood, 40 voussoirs: {time.perf_counter() - start:.1f} s")


if __name__ == "__main__":
    main()
