"""A facade bonded to one return wall falls outwards under an earthquake, and turns as it falls: an assessment in space.

Alone it would topple at thickness over height, 0.125. The return holds it back at one end, so the free end goes first
and takes a block of the return along: the joints slide, and the multiplier that counts is Coulomb's, far below the
bound with dilatancy. The pieces are followed at large displacements, step by step.
"""

from __future__ import annotations

from pathlib import Path

import concio
from concio.analysis.seismic.assessment_asked import read_asked


def main(figure: Path | None = None) -> dict[str, float]:
    """Assess, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    asked = read_asked(Path(__file__).with_name("facade_with_return.toml"))
    found = concio.assess(asked.model, **{**asked.arguments, "levels": ["SLV"], "mechanisms": None})
    worst = found.worst
    assert worst is not None
    outcome = worst.outcome("SLV")
    print(f"alpha_0 {worst.multiplier:.4f}, with dilatancy {worst.found.associated.multiplier:.4f}")
    print(f"{len(worst.mechanics.blocks)} pieces, d_0 {worst.d0:.3f} m, zeta_E {outcome.zeta:.3f}")
    if figure:
        from matplotlib.figure import Figure

        from concio.plot.assessment_figures import demand_figure, mechanism_figure
        from concio.report.language import words_of

        sheet = Figure(figsize=(9.0, 4.6), layout="constrained")
        left, right = sheet.subplots(1, 2)
        mechanism_figure(worst, left)
        demand_figure(worst, words_of("assessment_words", "en"), right)
        sheet.savefig(figure)
    return {
        "alpha": worst.multiplier,
        "bound": worst.found.associated.multiplier,
        "first": float(worst.followed.multiplier[0]),
        "most": float(worst.followed.multiplier.max()),
        "end": worst.followed.end,
        "zeta": outcome.zeta,
        "turns": float(not worst.in_one_plane),
    }


if __name__ == "__main__":
    main()
