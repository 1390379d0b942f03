"""A facade strip of two storeys under an earthquake: floor, thrusting roof, and the tie it needs.

The weakest mechanism is found, not chosen: the whole strip turns outwards about its foot, and the old tie yields.
Followed at large displacements it is not verified at SLV; the tie force that brings zeta_E to one is found by solving.
"""

from __future__ import annotations

from pathlib import Path

import concio
from concio.analysis.seismic.assessment_asked import read_asked
from concio.analysis.seismic.variations import tie_force


def main(figure: Path | None = None) -> dict[str, float]:
    """Assess, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    asked = read_asked(Path(__file__).with_name("facade_strip.toml"))
    arguments = {**asked.arguments, "levels": ["SLV"]}
    found = concio.assess(asked.model, **arguments)
    worst = found.worst
    assert worst is not None
    outcome = worst.outcome("SLV")
    needed = tie_force(asked.model, "roof tie", **arguments)
    print(f"alpha_0 {worst.multiplier:.4f}, a_0* {worst.onset:.3f} m/s2, d_0 {worst.d0:.3f} m")
    for check in worst.checks:
        word = "verified" if check.holds else "not verified"
        print(f"SLV, {check.kind}: demand {check.demand:.4g}, capacity {check.capacity:.4g} {check.unit}: "
              f"{word}, {check.ratio:.3f}")  # fmt: skip
    print(f"a_g of capacity {outcome.a_g:.4f} g, zeta_E {outcome.zeta:.3f}")
    print(f"a tie of {needed.force:.2f} kN brings zeta_E to {needed.reached:.3f}")
    if figure:
        from matplotlib.figure import Figure

        from concio.plot.assessment_figures import demand_figure, mechanism_figure
        from concio.report.language import words_of

        sheet = Figure(figsize=(9.0, 4.6), layout="constrained")
        left, right = sheet.subplots(1, 2, width_ratios=(1, 2))
        mechanism_figure(worst, left)
        demand_figure(worst, words_of("assessment_words", "en"), right)
        sheet.savefig(figure)
    return {
        "zeta": outcome.zeta,
        "alpha": worst.multiplier,
        "force": needed.force,
        "yields": asked.model.ties[0].most,
        "reached": needed.reached,
        "gap": worst.found.associated.worst,
    }


if __name__ == "__main__":
    main()
