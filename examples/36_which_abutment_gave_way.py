"""Which abutment gave way: a flat arch over a door, its cracks, and what may have moved.

The survey stands in the model file. One crack is first written down in the wrong unit, and the diagnosis names it. Put
right, one cause is left, with an interval, how far it can go on, and where to measure next. With
the right abutment among those that may have moved, the cracks cannot distinguish which of them it was.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import concio
from concio.analysis.cracks.diagnosis_asked import read_survey


def main(figure: Path | None = None) -> dict[str, float]:
    """Diagnose, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    asked = read_survey(Path(__file__).with_name("cracked_arch.toml"))
    cracks = list(asked.measurements)
    wrong = [replace(m, value=10 * m.value) if m.name == "K1" else m for m in cracks]
    first = concio.diagnose(asked.model, wrong, asked.candidates, most=1, large=False)
    print(first.verdict.headline)
    found = concio.diagnose(asked.model, cracks, asked.candidates, most=2)
    print(found.verdict.sentence)
    right = concio.Candidate("right abutment gives way", body="right abutment", direction=(1, 0), low=0.0)
    fewer = [m for m in cracks if m.name in ("K1", "K2", "K3")]
    both = concio.diagnose(asked.model, fewer, [*asked.candidates, right], most=1, large=False)
    print(both.verdict.headline)
    if figure:
        from matplotlib.figure import Figure

        sheet = Figure(figsize=(9.0, 7.6), layout="constrained")
        above, below = sheet.subplots(2, 1)
        found.plot.cracks(above)
        found.plot.readings(below)
        sheet.savefig(figure)
    cause = found.causes[0]
    return {
        "named": float([(d.measurement, d.mistake) for d in first.doubts] == [("K1", "unit")]),
        "causes": len(found.causes),
        "moved": float(cause.motion[0]),
        "low": float(cause.low[0]),
        "high": float(cause.high[0]),
        "crown": cracks[0].value,
        "either": len(both.causes),
        "error": cause.certificate,
    }


if __name__ == "__main__":
    main()
