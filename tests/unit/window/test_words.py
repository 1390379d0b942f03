"""The words of the page: both languages of every one, and none that is missing or left over."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import concio
from concio.window.questions import QUESTIONS

WINDOW = Path(concio.__file__).parent / "window"
WORDS = tomllib.loads((WINDOW / "words.toml").read_text(encoding="utf-8"))
PAGE = "\n".join(p.read_text(encoding="utf-8") for p in (WINDOW / "page").iterdir() if p.suffix in (".js", ".html"))
BUILT = ("q_", "a_", "layer_", "photo_")
"""Words whose names are put together from a question or a use of layers."""


def test_every_word_has_both_languages_with_the_same_places() -> None:
    for name, (english, italian) in WORDS.items():
        assert italian, name
        assert english or name == "verdict_language"
        assert re.findall(r"\{\w+\}", english) == re.findall(r"\{\w+\}", italian), name


def test_every_word_that_the_page_names_is_there_and_none_is_left_over() -> None:
    named = set(re.findall(r'\bt\("(\w+)"|data-(?:t|label)="(\w+)"', PAGE))
    names = {a or b for a, b in named}
    assert names - set(WORDS) == set()
    for question in QUESTIONS.values():
        assert {f"q_{question.name}", f"a_{question.name}"} <= set(WORDS)
        for option in question.options:
            assert ("language_report" if option.name == "language" else option.name) in WORDS
    quoted = set(re.findall(r'"(\w+)"', PAGE)) | {o.name for q in QUESTIONS.values() for o in q.options}
    left = {n for n in WORDS if n not in names | quoted and not n.startswith(BUILT)}
    assert left == set()


def test_templates_and_every_key_in_them_have_their_italian() -> None:
    known = tomllib.loads((WINDOW / "italian.toml").read_text(encoding="utf-8"))
    templates = sorted((Path(concio.__file__).parent / "model" / "templates").glob("*.toml"))
    assert {p.stem for p in templates} == set(known["templates"])
    named = set().union(*(_keys(tomllib.loads(p.read_text(encoding="utf-8")), ()) for p in templates))
    assert named - set(known["keys"]) == set()


FREE = {"materials", "joints", "layers", "mechanisms", "walls", "factors"}
"""Tables whose keys are names that the user gives."""


def _keys(value: object, path: tuple[str, ...]) -> set[str]:
    if isinstance(value, list):
        return set().union(*(_keys(one, path) for one in value))
    if not isinstance(value, dict):
        return set()
    own = set() if path and path[-1] in FREE else set(value)
    return own.union(*(_keys(one, (*path, key)) for key, one in value.items()))
