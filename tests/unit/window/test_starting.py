"""Model texts that the window begins: what no file can say is marked with the value it was begun with."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from concio import InputError, loads
from concio.window import starting
from concio.window.questions import QUESTIONS
from concio.window.starting import TO_FILL, model_text

COLUMN = "[column]\nwidth = 0.5\nheight = 2.0\nblocks = 4\nblock = 'rigid'\nunit_weight = 20.0\n"
MARK = re.compile(r"^(\w+) = (.+?)\s+#.*begun with (.+): state yours$", re.MULTILINE)


@pytest.mark.parametrize(
    ("name", "expected"),
    [("wall.dxf", {"thickness", "unit_weight", "friction"}), ("tower.obj", {"unit_weight", "friction"}),
     ("wall.png", {"thickness", "unit_weight", "friction"})],
)  # fmt: skip
def test_values_that_the_window_has_chosen_are_marked_with_themselves(name: str, expected: set[str]) -> None:
    text = model_text(Path(name))
    assert text is not None
    marked = {key: (str(tomllib.loads(f"x = {written}")["x"]), begun) for key, written, begun in MARK.findall(text)}
    assert set(marked) == expected
    assert all(value == begun for value, begun in marked.values())
    data = tomllib.loads(text)
    assert _numbers({name: data.get(name, {}) for name in ("analysis", "materials", "joints")}) == expected


def test_tables_to_fill_belong_to_questions_and_state_nothing() -> None:
    known = tomllib.loads((Path(starting.__file__).parent / "italian.toml").read_text(encoding="utf-8"))["keys"]
    for table, text in TO_FILL.items():
        assert any(table in question.needs for question in QUESTIONS.values())
        data = tomllib.loads(text)
        assert table in data
        keys, values = zip(*_entries(data), strict=True)
        assert set(keys) - set(known) - {"SLV"} == set()
        assert set(values) == {""}


def test_the_first_value_that_is_not_stated_is_named_with_its_table() -> None:
    with pytest.raises(InputError, match="F0") as told:
        loads(COLUMN + TO_FILL["site"])
    assert "dict" not in str(told.value)
    assert "SLV" in str(told.value)


def _entries(table: dict[str, Any]) -> list[tuple[str, Any]]:
    """Return keys and values of a table and of those in it."""
    found = []
    for key, value in table.items():
        found += _entries(value) if isinstance(value, dict) else [(key, value)]
    return found


def _numbers(table: dict[str, object]) -> set[str]:
    """Return the keys of a table, and of those in it, whose values are numbers or start with one."""
    found: set[str] = set()
    for key, value in table.items():
        if isinstance(value, dict):
            found |= _numbers(value)
        elif re.match(r"\d", str(value)):
            found.add(key)
    return found
