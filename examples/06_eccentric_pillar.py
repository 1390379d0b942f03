"""A dry pillar under an eccentric load: uncracked within the middle third, cracked outside, falling off the edge."""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""

    def pillar(eccentricity: float) -> concio.Model:
        return concio.column(width=0.6, height=1.8, blocks=6, top_force=60.0, eccentricity=eccentricity, friction=0.6)

    whole, cracked = concio.solve(pillar(0.05)), concio.solve(pillar(0.2))
    share = [float(r.joints.open_share[0]) for r in (whole, cracked)]
    print(f"open share of the lowest joint: {share[0]:.2f} within the middle third, {share[1]:.2f} outside")
    if figure:
        cracked.plot.pressure().figure.savefig(figure)
    return {"worst": max(whole.certificate.worst, cracked.certificate.worst), "whole": share[0], "cracked": share[1]}


if __name__ == "__main__":
    main()
