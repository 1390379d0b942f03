"""What matters for an arch: Sobol indices of its friction margin.

Thickness, friction and a horizontal share of the weight of a semicircular arch vary within bounds. The indices share
the variance of the load it can take among them; total indices count what variables do together.
"""

from __future__ import annotations

from pathlib import Path

import concio

ARCH = """
[arch]
span = 4.0
ring = "0.45 m"
voussoirs = 15
block = { kind = "rigid", unit_weight = "22 kN/m3" }
friction = 0.6
[[loads]]
kind = "weight"
value = [1.0, 0]
group = "live"
"""


def main(figure: Path | None = None, size: int = 32) -> dict[str, float]:
    """Run the study, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    import tomllib

    variables = [
        concio.variable("ring", "uniform", keys="arch.ring", unit="m", low=0.40, high=0.60),
        concio.variable("friction", "uniform", keys="arch.friction", low=0.4, high=0.8),
        concio.variable("weight", "uniform", keys="arch.block.unit_weight", unit="kN/m3", low=18.0, high=24.0),
    ]
    found = concio.study(tomllib.loads(ARCH), variables, "associated_multiplier", "saltelli", size=size, seed=1)
    shares = found.sensitivity("associated_multiplier")
    print(f"{len(found)} runs")
    for name, first, total in zip(shares.names, shares.first, shares.total, strict=True):
        print(f"  {name:9s} alone {first:6.3f}   with others {total:6.3f}")
    if figure:
        found.plot.tornado("associated_multiplier").figure.savefig(figure)
    return dict(zip(shares.names, shares.total, strict=True))


if __name__ == "__main__":
    main()
