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
