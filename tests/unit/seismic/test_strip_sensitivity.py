"""What a strip out of the plane depends on is named as the wall is: its thickness, its heights, the loads on it."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest

import concio
from concio.analysis.sensitivity import Sensitivity
from concio.report.assessment_texts import Texts
from concio.report.sensitivity_part import sensitivity_html


@cache
def assessed() -> tuple[concio.Assessment, Sensitivity | None]:
    site = concio.Site(hazard={"SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}}, soil="B")
    found = concio.assess(facade(), site=site, levels=["SLV"])
    return found, found.sensitivity()


def facade() -> concio.Model:
    """Return a wall of 6 m by 5 m and half a metre, loaded in its middle."""
    spans = [(0.0, 2.0), (2.0, 4.0), (4.0, 6.0)]
    stones = tuple(
        concio.Body(f"s{k}{j}", np.array([[a, k], [b, k], [b, k + 1], [a, k + 1]]) * 1.0, kind="rigid", thickness=0.5)
        for k in range(5) for j, (a, b) in enumerate(spans)
    )  # fmt: skip
    ground = concio.Body("ground", np.array([[-1, -0.5], [7, -0.5], [7, 0], [-1, 0.0]]), kind="fixed")
    loads = (concio.Load("weight", (0, -1)), concio.Load("pressure", (20.0,), edge=((0.0, 5.0), (6.0, 5.0))))
    return concio.Model((ground, *stones), {"block": concio.Rigid(unit_weight=19)}, {"joint": concio.JointLaw(0.6)},
                        loads=loads)  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(
    ("language", "thick", "high"),
    [("en", "thickness of the wall", "all heights"), ("it", "spessore del muro", "tutte le altezze")],
)
def test_a_free_strip_depends_on_thickness_over_height(language: str, thick: str, high: str) -> None:
    found, rows = assessed()
    assert found.worst is not None
    assert found.worst.section is not None
    assert rows is not None
    weight, top = 19 * 0.5 * 5.0, 20.0 * 0.5  # [kN/m]; both push, at half of the height and on top
    assert rows["length of x"].per_percent[1] > 0 > rows["length of y"].per_percent[1]
    assert found.worst.multiplier == pytest.approx(0.5 / 2 * (weight + top) / (weight * 2.5 + top * 5.0), rel=1e-9)
    page = re.sub(r"<img[^>]*>", "", sensitivity_html(Texts(language), rows, strip=True))
    sentence = page[page.rindex("<p>") :]
    assert thick in sentence
    assert high in sentence
