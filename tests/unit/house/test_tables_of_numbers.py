"""Tolerances and limits of work have a table each: every number with a sentence, used, and no other of its name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import concio
from sources import source

ROOT = Path(concio.__file__).parent
TABLES = ("problem/tolerances.py", "problem/limits_of_work.py")
CONSTANT = re.compile(r"^([A-Z][A-Z_]+) = .*\n(.*)", re.MULTILINE)


def constants(path: Path) -> dict[str, str]:
    """Return the constants at the level of a module, each with the line below it."""
    return dict(CONSTANT.findall(path.read_text(encoding="utf-8")))


EVERY = {path: constants(path) for path in sorted(ROOT.rglob("*.py"))}


@pytest.mark.parametrize("table", TABLES)
def test_each_number_has_a_sentence_and_is_the_only_one_of_its_name(table: str) -> None:
    here = EVERY[ROOT / table]
    assert len(here) > 20
    for name, below in here.items():
        assert below.startswith('"""'), f"{name} has no sentence"
        others = [path.relative_to(ROOT).as_posix() for path, found in EVERY.items() if name in found]
        assert others == [table], f"{name} stands in {others}"


@pytest.mark.parametrize("table", TABLES)
def test_each_number_is_used(table: str) -> None:
    module = "concio." + table.removesuffix(".py").replace("/", ".")
    used = {name for path in EVERY for one in source(path).imports if one.module == module for name in one.names}
    assert set(EVERY[ROOT / table]) == used
