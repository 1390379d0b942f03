"""Rows of the hand check in a report name what stands in words, and one block in the singular."""

from __future__ import annotations

from pathlib import Path

import pytest

import concio
from samples import first
from seismic_walls import site


@pytest.mark.long
@pytest.mark.parametrize(
    ("language", "stands"),
    first(1, [("it", "attrito, ciò che resta fermo / b01"), ("en", "friction, what stands / b01")]),
)
def test_a_block_that_slides_on_what_stands(tmp_path: Path, language: str, stands: str) -> None:
    block = concio.column(width=1.0, height=1.0, blocks=1, block="rigid", friction=0.3)
    found = concio.assess(block, site=site(), levels=["SLV"], direction="right", elsewhere=("out of plane",))
    text = found.report(tmp_path / "report.html", language=language).read_text("utf-8")
    assert stands in text
    assert "peso di 1 blocchi" not in text
    assert "weight of 1 blocks" not in text
