"""Faults that are put into the core on purpose still find their place there."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import concio

NAMED = tomllib.loads((Path(__file__).parents[1] / "mutants_named.toml").read_text(encoding="utf-8"))["named"]


@pytest.mark.parametrize("fault", NAMED, ids=[fault["what"] for fault in NAMED])
def test_a_named_fault_has_its_place(fault):
    source = Path(concio.__file__).parent / fault["path"]
    assert source.read_text(encoding="utf-8").count(fault["old"]) == 1
    assert all((Path(__file__).parents[2] / name).is_file() for name in fault["tests"])
