"""Faults that are put into the core on purpose still find their place there."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import concio

NAMED = tomllib.loads((Path(__file__).parents[2] / "mutants_named.toml").read_text(encoding="utf-8"))["named"]


@pytest.mark.parametrize("fault", NAMED, ids=[fault["what"] for fault in NAMED])
def test_a_named_fault_has_its_place(fault):
    source = Path(concio.__file__).parent / fault["path"]
    assert source.read_text(encoding="utf-8").count(fault["old"]) == 1
    assert all((Path(__file__).parents[3] / name).is_file() for name in fault["tests"])


def test_every_file_belongs_to_a_room_or_has_no_numerics():
    """What no room holds is never tried: the whole of analysis/seismic once was not."""
    table = tomllib.loads((Path(__file__).parents[2] / "mutants_rooms.toml").read_text(encoding="utf-8"))
    rooms, without = set(table["rooms"]), set(table["without_numerics"])
    package = Path(concio.__file__).parent
    assert not rooms & without
    assert all((package / place).exists() for place in rooms | without)
    assert all((Path(__file__).parents[3] / name).exists() for tests in table["rooms"].values() for name in tests)
    for file in package.rglob("*.py"):
        path = file.relative_to(package)
        places = {p.as_posix() for p in (path, *path.parents)}
        assert file.name == "__init__.py" or len(places & without) + bool(places & rooms) == 1, path


def test_no_two_test_files_have_one_name() -> None:
    """Pytest imports test files by name alone: of two with one name the second is an error, in a whole run only."""
    names = [p.name for p in (Path(__file__).parents[2]).rglob("test_*.py")]
    assert not {name for name in names if names.count(name) > 1}
