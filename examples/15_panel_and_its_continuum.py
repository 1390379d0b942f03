"""The paper's panel beside its homogenised continuum: what moduli cannot have is the arch.

Ercolano's panel hangs between two walls by friction. With all joints closed and stuck its blocks and the continuum with
the moduli of its cell agree within a few per cent: both carry the load by bending, with as much tension as compression,
and hardly push. The real joints cannot pull: the panel becomes an arch, settles ten times as far and pushes outwards
with more than twice the load on half of it. With smaller blocks it settles further, for the arch lives on blocks that
reach over their neighbours; as a material with the strength of the same cell the panel carries nothing at all, which a
mechanism of the continuum proves.
"""

from __future__ import annotations

from pathlib import Path

import concio


def panel(times: int = 1) -> concio.Model:
    """Return the panel with blocks so many times smaller."""
    mortar = concio.Elastic(E=1e5, nu=0.15)
    return concio.running_bond_panel(
        courses=3 * times, blocks=6 * times, block_size=(0.2 / times, 0.1 / times), joint=0.02 / times, thickness=0.1,
        block=mortar, mortar=mortar, friction=1.0, base="none", top_pressure=10.0,
    )  # fmt: skip


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    found = concio.compare_with_continuum(panel(), live="top")
    blocks, bonded, smooth = found.elastic.settlements
    thrust = found.elastic.blocks.reactions["left wall"][0]
    push = float(found.elastic.continuum.reactions["left wall"][0])
    print(f"settlement: blocks {1e3 * blocks:.3f} mm, bonded {1e3 * bonded:.3f} mm, continuum {1e3 * smooth:.3f} mm")
    print(f"thrust on a wall: blocks {thrust:.3f} kN, continuum {push:.3f} kN")
    smaller = concio.solve(panel(2)).max_settlement
    print(f"blocks half as large: settlement {1e3 * smaller:.3f} mm")
    low, high = found.strength.bracket
    print(f"load carried: blocks any, continuum with the strength of the cell {abs(low):.3g} to {abs(high):.3g}")
    if figure:
        found.plot.displacement()[0].figure.savefig(figure)
    return {
        "blocks": blocks, "bonded": bonded, "continuum": smooth, "thrust": thrust, "push": push, "smaller": smaller,
        "low": low, "high": high, "limit": found.strength.blocks.associated.multiplier,
    }  # fmt: skip


if __name__ == "__main__":
    main()
