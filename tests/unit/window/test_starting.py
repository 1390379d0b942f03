"""Model texts that the window begins: what no file can say is marked with the value it was begun with."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from concio.window.starting import model_text

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


def _numbers(table: dict[str, object]) -> set[str]:
    """Return the keys of a table, and of those in it, whose values are numbers or start with one."""
    found: set[str] = set()
    for key, value in table.items():
        if isinstance(value, dict):
            found |= _numbers(value)
        elif re.match(r"\d", str(value)):
            found.add(key)
    return found
