"""A report in Italian: every text of the finished page is looked up, names of the model stay as they are.

Pages are written in English, with what the engineer named (blocks, load groups) marked by ``translate=no``, as HTML
provides. Here each text between tags is replaced by its Italian, sentence by sentence, from the catalogues of this room
and of the verdicts. What is not known stays in English and is marked ``lang="en"``. Numbers keep their digits and get
decimal commas.
"""

from __future__ import annotations

import re
import tomllib
from functools import cache, lru_cache
from html import escape, unescape
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Literal

from concio.plot.figure_language import in_language
from concio.verdict.italian import Catalogue, catalogue
from concio.verdict.italian_numbers import QUOTED, commas

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Language = Literal["en", "it"]

TAG = re.compile(r"(<(?:script|style)\b.*?</(?:script|style)>|<[^>]*>)", re.DOTALL)
"""Tags; scripts and styles whole."""
KEPT = re.compile(r"<(\w+)\b[^>]*\btranslate=no\b")
ATTRIBUTE = re.compile(r'\b(alt|aria-label)="([^"]*)"')
UNITS = frozenset({
    "µm", "kN", "N", "MN", "kgf", "tf", "m", "cm", "mm", "ft", "in", "MPa", "GPa", "kPa", "Pa", "bar", "g", "s", "rad",
    "mrad", "x", "y", "z", "m2", "m3", "mm2", "mm3", "cm2", "deg", "E", "nu", "concio",
})  # fmt: skip
"""Words that both languages write in the same way."""
GIVEN = re.compile(r"[^=:;.]{1,80} = -?[\d.,e-]+(?: \S{1,6})?")
"""A load group or a variable with its value."""


def report_catalogue() -> Catalogue:
    """Return what is known in Italian of reports, their figures and verdicts."""
    return catalogue("concio.verdict", "concio.report")


def page_in(page: str, language: Language) -> str:
    """Return a finished page in a language."""
    return in_italian(page) if language == "it" else page


def text_in(text: str, language: Language) -> str:
    """Return a text in a language, as far as it is known."""
    return plain_italian(text) if language == "it" else text


def script_words(language: Language) -> dict[str, Any]:
    """Return what the scripts of a page need to speak a language: words by their English, nothing for English."""
    return {"said": view_words()} if language == "it" else {}


@cache
def view_words() -> dict[str, str]:
    """Return the Italian of the words of the scripts."""
    table: dict[str, str] = tomllib.loads((files("concio.report") / "italian.toml").read_text("utf-8"))["scripts"]
    return table


def figure_in(axes: Axes, language: Language) -> Axes:
    """Return axes whose figure has its titles, labels and legends in a language; names of blocks stay."""
    from matplotlib.text import Text

    if language == "en":
        return axes
    figure = axes.get_figure(root=True)
    assert figure is not None
    for ax in figure.axes:
        legend = ax.get_legend()
        titles = [t for t in ax.get_children() if isinstance(t, Text) and t not in ax.texts]
        texts = [*titles, ax.xaxis.label, ax.yaxis.label]
        texts += [t for t in ax.texts if " " in t.get_text()] + (legend.get_texts() if legend else [])
        for text in texts:
            if text.get_text():
                text.set_text(plain_italian(text.get_text()))
        in_language(ax, language)
    return axes


def in_italian(page: str) -> str:
    """Return a page in Italian.

    Parameters
    ----------
    page : str
        Finished HTML in English. What stands in an element with ``translate=no`` is kept.
    """
    made: list[str] = []
    kept = ""
    for part in TAG.split(page):
        if part.startswith("<"):
            if not kept and (match := KEPT.match(part)):
                kept = match[1]
            elif kept and part == f"</{kept}>":
                kept = ""
            made.append(_tag(part))
        else:
            made.append(part if kept or not part.strip() else _text(part))
    return "".join(made)


def _tag(tag: str) -> str:
    if tag.startswith("<html"):
        return tag.replace('lang="en"', 'lang="it"')
    if tag.startswith(("<script", "<style")):
        return tag

    def told(match: re.Match[str]) -> str:
        return f'{match[1]}="{escape(plain_italian(unescape(match[2])))}"'

    return ATTRIBUTE.sub(told, tag)


def _text(text: str) -> str:
    """Return a text between two tags in Italian, with the space around it."""
    bare = text.strip()
    before, after = text[: text.index(bare[0])], text[len(text.rstrip()) :]
    pieces = [
        escape(said, quote=False) if known else f'<span lang="en">{escape(said, quote=False)}</span>'
        for said, known in told_pieces(unescape(bare))
    ]
    return f"{before}{' '.join(pieces)}{after}"


def plain_italian(text: str) -> str:
    """Return a text in Italian as far as it is known, without marks: for attributes, and labels of figures."""
    return " ".join(said for said, _ in told_pieces(text))


@lru_cache(4096)
def told_pieces(text: str) -> tuple[tuple[str, bool], ...]:
    """Return a text in Italian in pieces, and of each whether it is known."""
    if _neutral(text):
        return ((commas(text), True),)
    known = report_catalogue()
    if (whole := known.whole(text)) is not None:
        return ((commas(whole), True),)
    for mark in ("; ", ", "):
        parts = text.split(mark)
        said = [commas(part) if _neutral(part) else known.whole(part) for part in parts]
        if len(parts) > 1 and None not in said:
            return ((commas(mark.join(part for part in said if part is not None)), True),)
    return tuple(
        (commas(piece.text) if piece.language == "it" else piece.text, piece.language == "it" or _neutral(piece.text))
        for piece in known.pieces(text)
    )


def _neutral(text: str) -> bool:
    """Return whether a text holds nothing to translate: numbers, units, names in quotes, values of groups."""
    bare = QUOTED.sub("", text)
    if all(word in UNITS for word in re.findall(r"[^\W\d_][\w]*", re.sub(r"(?<=\d)e[+-]?\d+", "", bare))):
        return True
    return all(GIVEN.fullmatch(part) for part in text.split(", "))
