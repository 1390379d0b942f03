"""Load groups that a study names and no run has are refused before the first run."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

import concio

LOADED = """
[column]
width = 0.5
height = 2.0
blocks = 2
horizontal = 0.01
block = { kind = "rigid", unit_weight = 20 }
"""


@pytest.mark.parametrize(
    ("asked", "group"),
    [({"outputs": "stands", "factors": {"daed": 2.0}}, "daed"),
     ({"outputs": ["stands", "associated_multiplier"], "live": "liev"}, "liev")],
)  # fmt: skip
def test_groups_that_no_run_has_are_refused_before_the_first(tmp_path: Path, asked: dict[str, Any], group: str) -> None:
    """Each row said so, after all runs."""
    file = tmp_path / "column.toml"
    file.write_text(LOADED)
    width = concio.variable("w", keys="column.width", low=0.4, high=0.6)
    with pytest.raises(concio.InputError, match=rf"column\.toml: there is no load group '{group}'"):
        concio.study(file, [width], size=2, directory=tmp_path / "s", **asked)
    assert not (tmp_path / "s").exists()


def test_groups_that_some_runs_have_are_not_refused() -> None:
    tables = {**tomllib.loads(LOADED), "loads": [{"kind": "weight", "group": "dead", "value": [0, -1]}]}
    chosen = concio.variable("g", "choice", keys="loads[1].group", values=["dead", "snow"])
    found = concio.study(tables, [chosen], "stands", [[0.0], [1.0]], factors={"snow": 1.0, "prestress": 1.0})
    assert [row.verdict for row in found.rows] == ["bad_input", "solved"]
    broken = concio.variable("w", keys="column.width", low=-2.0, high=-1.0)
    pier = {"column": {"width": 0.5, "height": 2.0, "blocks": 1, "block": {"kind": "rigid", "unit_weight": 20}}}
    assert len(concio.study(pier, [broken], "stands", size=2, factors={"snow": 1.0}).failures) == 2
