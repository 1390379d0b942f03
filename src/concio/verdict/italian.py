"""Verdicts in Italian: sentences that are known whole are said in Italian, all others stay as they are.

The verdicts of assessments, bridges and diagnoses are written in both languages where they are made. The others are
written in English; here each sentence is looked up in a table of sentences with gaps (``italian.toml``). A sentence is
translated only where all of it fits an entry and the translation holds the same numbers: an outcome is never guessed.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Literal

GAP = re.compile(r"\{(\w+)(?:!(\w))?\}")
INSIDE = r"(?:(?!\. ).)+?"
"""What a gap may hold: anything but the end of a sentence."""
NUMBER = re.compile(r"\d+(?:[.,]\d+)*")


@dataclass(frozen=True)
class Entry:
    """A sentence with gaps in both languages."""

    english: re.Pattern[str]
    italian: str
    kinds: dict[str, str]


@dataclass(frozen=True)
class Piece:
    """A part of a text in one language."""

    text: str
    language: Literal["en", "it"]


def italian(text: str) -> tuple[Piece, ...]:
    """Return a text of a verdict in Italian as far as its sentences are known, in pieces with their language.

    Parameters
    ----------
    text : str
        One or more sentences.

    Examples
    --------
    >>> from concio.verdict.italian import italian
    >>> [piece.text for piece in italian("The loads are carried. Nobody knows this sentence.")]
    ['I carichi sono portati.', 'Nobody knows this sentence.']
    """
    found: list[Piece] = []
    rest = text.strip()
    while rest:
        said, rest = _first(rest)
        if found and said.language == "en" == found[-1].language:
            said = Piece(f"{found.pop().text} {said.text}", "en")
        found.append(said)
    return tuple(found)


def in_italian(text: str) -> list[list[str]]:
    """Return a text of a verdict in Italian as pairs of text and language, as :func:`italian` gives them."""
    return [[piece.text, piece.language] for piece in italian(text)]


def _first(text: str) -> tuple[Piece, str]:
    """Return the first sentence, in Italian where it is known, and what follows it."""
    for entry in _entries():
        match = entry.english.match(text)
        said = _said(entry, match) if match else None
        if match is not None and said is not None:
            return Piece(said, "it"), text[match.end() :].lstrip()
    first, dot, rest = text.partition(". ")
    return Piece(f"{first}{dot.strip()}", "en"), rest


def _said(entry: Entry, match: re.Match[str]) -> str | None:
    """Return a sentence in Italian with its gaps filled; None where a gap is not known, or a number would change."""
    parts: dict[str, str] = {}
    for name, kind in entry.kinds.items():
        inside = match[name]
        if kind == "s":
            whole = _whole(f"{inside[0].upper()}{inside[1:]}.")
            if whole is None:
                return None
            inside = f"{whole[0].lower()}{whole[1:].rstrip('.')}"
        elif kind == "l":
            inside = _words(inside)
        parts[name] = inside
    said = GAP.sub(lambda gap: parts[gap[1]], entry.italian)
    same = sorted(NUMBER.findall(match[0])) == sorted(NUMBER.findall(said))
    return said if same else None


def _whole(sentence: str) -> str | None:
    """Return a sentence in Italian where all of it is known."""
    pieces = italian(sentence)
    return pieces[0].text if len(pieces) == 1 and pieces[0].language == "it" else None


def _words(text: str) -> str:
    """Return a list of groups and loads: names stay, and, or, and the words of loads become Italian."""
    said = re.sub(r"(?<=[)'\w]) and (?=['\w])", " e ", text)
    for english, word in _table()["words"].items():
        said = re.sub(rf"(?<![\w'-]){re.escape(english)}(?![\w'-])", word, said)
    said = re.sub(r"\b(\d+) (point|pressure|traction) loads?\b", _counted, said)
    said = re.sub(r"\bin forces that balance\b", "in forze che si equilibrano", said)
    return re.sub(r"\balong ([xyz])\b", r"lungo \1", said)


def _counted(match: re.Match[str]) -> str:
    one, many = {
        "point": ("forza concentrata", "forze concentrate"), "pressure": ("pressione", "pressioni"),
        "traction": ("tensione", "tensioni"),
    }[match[2]]  # fmt: skip
    return f"{match[1]} {one if match[1] == '1' else many}"


@cache
def _table() -> dict[str, dict[str, str]]:
    return tomllib.loads(files("concio.verdict").joinpath("italian.toml").read_text(encoding="utf-8"))


@cache
def _entries() -> tuple[Entry, ...]:
    """Return every entry, those with the most words of their own first."""
    told = sorted(_table()["sentences"].items(), key=lambda pair: -len(GAP.sub("", pair[0])))
    return tuple(_entry(english, said) for english, said in told)


def _entry(english: str, said: str) -> Entry:
    pattern, at, kinds = "", 0, {}
    for gap in GAP.finditer(english):
        pattern += re.escape(english[at : gap.start()]) + f"(?P<{gap[1]}>{INSIDE})"
        kinds[gap[1]] = gap[2] or ""
        at = gap.end()
    pattern += re.escape(english[at:])
    return Entry(re.compile(pattern + (r"(?= |$)" if english.endswith(".") else "$")), said, kinds)
