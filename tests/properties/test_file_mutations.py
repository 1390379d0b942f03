"""Whatever is changed in a model file, reading it gives a model or one message: never another exception."""

from __future__ import annotations

import copy
import tomllib
from importlib.resources import files
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.model.file.writing import _pairs
from samples import sample

TEMPLATES = {
    p.name: tomllib.loads(p.read_text(encoding="utf-8")) for p in files("concio.model").joinpath("templates").iterdir()
}
VALUES = st.one_of(
    st.sampled_from([
        0, -1, 1, 2.5, 1e-300, True, False, "", "x", "block", "stone", "rigid", "5 mm", "5 kN", "-1 m", "nan", "inf",
        "1e999 m", "100 MPa", [], [[]], {}, {"E": 1}, {"kind": "rigid"}, {"friction": 0.5}, [0, 0], [[0, 0], [1, 0]],
        [[0, 0], [1, 0], [1, 1]], [[0, 0], [0, 0]], ["*", "*"], ["a"], [{}], [{"name": "n"}],
    ]),
    st.integers(-3, 40),
    st.floats(-1e3, 1e3),
    st.text(max_size=6),
)  # fmt: skip


def places(data: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the paths of all keys and entries."""
    found = [path] if path else []
    entries = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in entries:
        found += places(value, (*path, key))
    return found


@st.composite
def mutated(draw: st.DrawFn) -> dict[str, Any]:
    data = copy.deepcopy(TEMPLATES[draw(st.sampled_from(sorted(TEMPLATES)))])
    for _ in range(draw(st.integers(1, 3))):
        spots = places(data)
        if not spots:
            break
        *way, last = draw(st.sampled_from(spots))
        holder: Any = data
        for key in way:
            holder = holder[key]
        action = draw(st.sampled_from(["set", "delete", "rename", "copy"]))
        if action == "delete" or (action == "rename" and isinstance(holder, list)):
            del holder[last]
        elif action == "rename":
            holder[draw(st.text(st.characters(codec="ascii", categories=["L"]), max_size=5))] = holder.pop(last)
        elif action == "copy":
            other = data
            for key in draw(st.sampled_from(spots)):
                other = other[key]
            holder[last] = copy.deepcopy(other)
        else:
            holder[last] = copy.deepcopy(draw(VALUES))
    return data


def read(text: str) -> concio.Model | concio.InputError:
    try:
        return concio.loads(text, name="f.toml")
    except concio.InputError as error:
        return error


@pytest.mark.long
@settings(max_examples=sample(25, 100, 150), deadline=None)
@given(mutated())
def test_a_changed_file_is_a_model_or_a_message(data: dict[str, Any]) -> None:
    found = read("\n".join(_pairs(data)))
    if isinstance(found, concio.InputError):
        assert str(found).startswith("f.toml")
        assert found.what
    else:
        assert concio.loads(concio.dumps(found)).title == found.title


@settings(max_examples=sample(25, 150), deadline=None)
@given(st.text(max_size=200))
def test_any_text_is_a_model_or_a_message(text: str) -> None:
    found = read(text)
    assert isinstance(found, concio.Model) or str(found).startswith("f.toml")
