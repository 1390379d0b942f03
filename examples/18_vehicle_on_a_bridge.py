"""A vehicle crosses an arch bridge: load factor over the position, and what it is owed to.

Prestwood bridge under one axle, which failed at 228 kN. The worst position is nearer to the springing than the quarter
point. The ring alone bears a fifth of that load; the rest needs the weight of the fill, its spread, and the pressure of
the soil, which nobody measures.
"""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Assess, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    barrel = concio.bridge(span=6.55, rise=1.428, ring=0.22, voussoirs=40, width=3.8, block="rigid", unit_weight=20.0)
    filled = concio.with_fill(barrel, concio.Fill(cover=0.165, unit_weight=20.0, passive=1.0))
    model = concio.with_vehicle(filled, concio.Vehicle("axle", (concio.Axle(0.0, 100.0),)))
    found = concio.assess_bridge(model, step=0.4, worst=1, checked=5)
    print(found.verdict.answer)
    for name, multiplier in found.parts.items():
        print(f"{name}: {100 * multiplier:.1f} kN")
    for c in found.changes[:3]:
        print(f"{c.name} {c.low:g} to {c.high:g}: {100 * c.at_low:.0f} to {100 * c.at_high:.0f} kN")
    if figure:
        found.plot.mechanism().figure.savefig(figure)
    return {
        "bound": 100 * found.worst.multiplier,
        "design": 100 * found.design,
        "position": found.worst.position / 6.55,
        "soil": found.owed_to_soil,
        "alone": 100 * found.parts["ring alone"],
    }


if __name__ == "__main__":
    main()
