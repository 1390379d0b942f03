"""Changes of a model's text keep everything else, and can be taken back to the first letter."""

from __future__ import annotations

import random
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.errors import InputError
from concio.window.commands import patch_of
from concio.window.toml_edits import add_table, difference, remove, set_value
from concio.window.toml_places import places
from samples import sample

ROOT = Path(__file__).resolve().parents[3]
FILES = sorted([*(Path(concio.__file__).parent / "model" / "templates").glob("*.toml"),
                *(ROOT / "examples").glob("*.toml")])  # fmt: skip


def at(data: Any, path: tuple[str | int, ...]) -> Any:
    for key in path:
        data = data[key]
    return data


@pytest.mark.parametrize("file", FILES, ids=lambda p: p.stem)
def test_every_value_of_a_file_is_found_where_it_stands(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    data, found = tomllib.loads(text), places(text)
    assert found.values
    for path, value in found.values.items():
        assert tomllib.loads(f"k = {text[value.start : value.end]}")["k"] == at(data, path)


@pytest.mark.parametrize("file", FILES, ids=lambda p: p.stem)
def test_a_change_touches_nothing_else(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    added = add_table(text, "loads", {"kind": "point", "value": [0.0, -2.5], "at": [1.0, 2.0]})
    new = added.applied(text)
    assert tomllib.loads(new)["loads"][-1] == {"kind": "point", "value": [0.0, -2.5], "at": [1.0, 2.0]}
    kept = [line for line in new.split("\n") if line.strip()]
    assert [line for line in text.split("\n") if line.strip()] == [
        line for k, line in enumerate(kept) if k not in range(*new_lines(text, new))
    ]
    number = len(tomllib.loads(new)["loads"]) - 1
    gone = remove(new, ("loads", number)).applied(new)
    assert tomllib.loads(gone) == tomllib.loads(text)
    assert added.inverse.applied(new) == text


def new_lines(old: str, new: str) -> tuple[int, int]:
    """Return from where to where lines with letters were added."""
    a = [line for line in old.split("\n") if line.strip()]
    b = [line for line in new.split("\n") if line.strip()]
    start = next((k for k, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), len(a))
    return start, start + len(b) - len(a)


TRICKY = '''# comment [not a table]
"quoted key" = 1   # kept
text = """
[loads]
key = 3
"""
other = \'\'\'
[[x]] \'\'\'
points = [ # a list
  [0, 1], # "]"
  [2, 3],
]
[a.b]
c.d = { e = 1, "f g" = [1, 2], h = { i = "}" } }
[[loads]]
kind = "point" # k
[loads.more]
x = 1
[[loads]]
kind = 'weight'
'''


def test_strings_lists_and_inline_tables_hide_nothing() -> None:
    data, found = tomllib.loads(TRICKY), places(TRICKY)
    for path, value in found.values.items():
        assert tomllib.loads(f"k = {TRICKY[value.start : value.end]}")["k"] == at(data, path)
    assert ("a", "b", "c", "d", "h", "i") in found.values
    assert ("loads", 0, "more", "x") in found.values
    new = set_value(TRICKY, ("a", "b", "c", "d", "new"), "5 GPa").applied(TRICKY)
    assert tomllib.loads(new)["a"]["b"]["c"]["d"]["new"] == "5 GPa"
    for path in (("loads", 0), ("loads", 1), ("points",), ("quoted key",)):
        gone = remove(TRICKY, path).applied(TRICKY)
        assert "# comment" in gone
        with pytest.raises((KeyError, IndexError)):
            at(tomllib.loads(gone), (*path[:-1], path[-1] + 1 if path == ("loads", 1) else path[-1], "none"))


def test_what_cannot_be_changed_alone_is_refused() -> None:
    with pytest.raises(InputError, match="not valid TOML"):
        set_value("a = ", ("a",), 1)
    with pytest.raises(InputError, match="cannot be changed alone"):
        set_value("a = 1\n", ("a", "b"), 1)
    with pytest.raises(InputError, match="nothing called"):
        remove("a = 1\n", ("b",))
    with pytest.raises(InputError, match="must be finite"):
        set_value("a = 1\n", ("a",), float("nan"))
    for command in ({}, {"do": "set"}, {"do": "add", "to": "analysis", "table": {}}, {"do": "remove", "path": [-1]},
                    {"do": "text"}, {"do": "set", "path": ["a"], "value": None}):  # fmt: skip
        with pytest.raises(InputError):
            patch_of("a = 1\n", command)


@settings(max_examples=sample(100, 1000), deadline=None)
@given(st.text("ab\n", max_size=30), st.text("ab\n", max_size=30))
def test_the_difference_of_two_texts_leads_there_and_back(old: str, new: str) -> None:
    patch = difference(old, new)
    assert patch.applied(old) == new
    assert patch.inverse.applied(new) == old


@settings(max_examples=sample(50, 400), deadline=None)
@given(st.text(max_size=20), st.one_of(st.text(max_size=20), st.integers(-(10**15), 10**15), st.booleans(),
                                       st.floats(allow_nan=False, allow_infinity=False)))  # fmt: skip
def test_any_key_and_value_can_be_written(key: str, value: Any) -> None:
    text = "title = 'x'\n\n[analysis]\nthickness = 1.0\n"
    try:
        new = set_value(text, ("materials", "s", key), value).applied(text)
    except InputError:
        assert any(0xD800 <= ord(c) < 0xE000 for c in key + str(value))
        return
    assert tomllib.loads(new)["materials"]["s"][key] == value
    assert new.startswith(text)


def random_command(rng: random.Random, text: str) -> dict[str, Any]:
    """Return a command that a person may give: sensible or not."""
    data, found = tomllib.loads(text), list(places(text).values)
    kind = rng.choice(["set", "set", "add", "remove", "text"])
    if kind == "set" and found:
        return {"do": "set", "path": list(rng.choice(found)), "value": rng.choice([1.5, "2 m", True, [1, 2.5]])}
    if kind == "remove":
        lists = [(n, k) for n in ("loads", "blocks", "ties") for k in range(len(data.get(n, ())))]
        return {"do": "remove", "path": list(rng.choice([*lists, ("title",)]))}
    if kind == "text":
        place = rng.randrange(len(text) + 1)
        return {"do": "text", "text": f"{text[:place]}\n# note {rng.random()}\n{text[place:]}"}
    return {"do": "add", "to": rng.choice(["loads", "ties"]), "table": {"name": f"n{rng.random()}", "at": [0.5, 1]}}


@pytest.mark.parametrize("seed", range(sample(2, 8)))
def test_random_commands_are_taken_back_to_the_same_text(seed: int) -> None:
    rng = random.Random(seed)
    kinds = [f for f in FILES if f.stem in ("blocks", "arch", "wall", "assessment")]
    first = text = rng.choice(kinds).read_text("utf-8")
    done = []
    for _ in range(125):
        try:
            patch, _ = patch_of(text, random_command(rng, text))
            new = patch.applied(text)
            tomllib.loads(new)
        except (InputError, tomllib.TOMLDecodeError):
            continue
        text = new
        done.append(patch)
    assert len(done) > 40
    last = text
    for patch in reversed(done):
        text = patch.inverse.applied(text)
    assert text == first
    for patch in done:
        text = patch.applied(text)
    assert text == last
