"""Verdicts in Italian: sentences that are known whole are said in Italian, all others stay as they are.

The verdicts of assessments, bridges and diagnoses are written in both languages where they are made. The others are
written in English; here each sentence is looked up in a table of sentences with gaps (``italian.toml``). A sentence is
translated only where all of it fits an entry and the translation holds the same numbers: an outcome is never guessed.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Literal

from concio.verdict.italian_numbers import commas

GAP = re.compile(r"\{(\w+)(?:!(\w))?\}")
"""{name} stands for anything, {name!l} for a list, {name!s} for a sentence, {name!p} for sentences with semicolons,
{name!n} for a number with its unit, {name!w} for one word, {name!a} for an axis."""
INSIDE = r"(?:(?!\. ).)+?"
"""What a gap may hold: anything but the end of a sentence."""
NARROW = {"n": r"[+-]?(?:\d[\d.,]*(?:e[+-]?\d+)?|–)(?: [^\s,;:()]+(?: m)?)?", "a": r"[xyz]", "w": r"[^\s.,;:]+"}
"""What gaps of numbers with their unit and of axes may hold."""
QUOTED = re.compile(r"(?<!\w)'[^']*'(?!\w)")
KINDS = {"gap": "distacco", "angle": "angolo", "sliver": "tratto troppo corto", "partial": "solo in parte",
         "corner": "spigolo", "edge": "bordo"}  # fmt: skip
"""Kinds of places where a joint was not made."""
MEET = {"face": "faccia", "edge": "bordo", "corner": "spigolo"}
"""What meets in a contact without area."""
KINDS |= {f"{a}-{b}": f"{MEET[a]}-{MEET[b]}" for a in MEET for b in MEET}
PLACE = re.compile(rf"' at \(([^()]*)\) m \(({'|'.join(KINDS)})\)")
LEFT = re.compile(r"\b(the|from|over|of|with|which|that|and|is|are)\b")
"""English that no list in Italian has: the list is not known."""
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


class Catalogue:
    """Sentences that are known in Italian.

    Parameters
    ----------
    tables : tuple of str
        Packages whose files ``italian.toml`` it reads.
    """

    def __init__(self, tables: tuple[str, ...]) -> None:
        read = [tomllib.loads(files(name).joinpath("italian.toml").read_text(encoding="utf-8")) for name in tables]
        self.words = {english: said for table in read for english, said in table.get("words", {}).items()}
        told: dict[str, str] = {english: said for table in read for english, said in table["sentences"].items()}
        longest = sorted(told.items(), key=lambda pair: -len(GAP.sub("", pair[0])))
        self._plain = {english: said for english, said in longest if not GAP.search(english)}
        both = ((_entry(*pair), _entry(*_as_sentence(*pair))) if not pair[0].endswith(".") else (_entry(*pair),)
                for pair in longest)  # fmt: skip
        self._entries = tuple(entry for pair in both for entry in pair)

    def pieces(self, text: str) -> tuple[Piece, ...]:
        """Return a text in Italian as far as its sentences are known, in pieces with their language."""
        found: list[Piece] = []
        rest = text.strip()
        while rest:
            said, rest = self._first(rest)
            if found and said.language == "en" == found[-1].language:
                said = Piece(f"{found.pop().text} {said.text}", "en")
            found.append(said)
        return tuple(found)

    def whole(self, text: str) -> str | None:
        """Return a text in Italian where all of it is known."""
        if (said := self._plain.get(text)) is not None:
            return said
        pieces = self.pieces(text)
        return " ".join(piece.text for piece in pieces) if all(p.language == "it" for p in pieces) else None

    def _first(self, text: str) -> tuple[Piece, str]:
        """Return the first sentence, in Italian where it is known, and what follows it."""
        for entry in self._entries:
            match = entry.english.match(text)
            said = self._said(entry, match) if match else None
            if match is not None and said is not None:
                return Piece(said, "it"), text[match.end() :].lstrip()
        first, dot, rest = text.partition(". ")
        return Piece(f"{first}{dot.strip()}", "en"), rest

    def _said(self, entry: Entry, match: re.Match[str]) -> str | None:
        """Return a sentence in Italian with its gaps filled; None where a gap is unknown, or a number would change."""
        parts: dict[str, str] = {}
        for name, kind in entry.kinds.items():
            inside: str | None = match[name]
            assert inside is not None
            if kind == "s":
                inside = self._inner(inside)
            elif kind == "p":
                inside = self._parts(inside)
            elif kind == "l":
                inside = _words(inside, self.words)
                inside = None if LEFT.search(QUOTED.sub("", inside)) else inside
            if inside is None:
                return None
            parts[name] = inside
        said = GAP.sub(lambda gap: parts[gap[1]], entry.italian)
        same = sorted(NUMBER.findall(match[0])) == sorted(NUMBER.findall(said))
        return said if same else None

    def _inner(self, inside: str) -> str | None:
        """Return a sentence within a sentence, which begins small and ends without a full stop."""
        for dot in (".", ""):
            for begun in (f"{inside[0].upper()}{inside[1:]}", inside):
                pieces = self.pieces(f"{begun}{dot}")
                if len(pieces) == 1 and pieces[0].language == "it":
                    whole = pieces[0].text
                    return f"{whole[0].lower()}{whole[1:].rstrip('.')}"
        return None

    def _parts(self, inside: str) -> str | None:
        """Return parts between semicolons, each of them known."""
        told = [self._inner(part) for part in inside.split("; ")]
        return None if None in told else "; ".join(part for part in told if part is not None)


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
    ['La struttura sostiene i carichi.', 'Nobody knows this sentence.']
    """
    return catalogue("concio.verdict").pieces(text)


def in_italian(text: str) -> list[list[str]]:
    """Return a text of a verdict in Italian as pairs of text and language, numbers with decimal commas."""
    return [[commas(p.text) if p.language == "it" else p.text, p.language] for p in italian(text)]


@cache
def catalogue(*tables: str) -> Catalogue:
    """Return the catalogue of the files ``italian.toml`` of some packages, read once."""
    return Catalogue(tables)


def _words(text: str, table: Mapping[str, str]) -> str:
    """Return a list of groups and loads: names stay, and, or, and the words of loads become Italian."""
    said = re.sub(r"(?<=[)'\w]) and (?=['\w])", " e ", text)
    for english, word in table.items():
        said = re.sub(rf"(?<![\w'-]){re.escape(english)}(?![\w'-])", word, said)
    said = re.sub(r"\b(\d+) (point|pressure|traction) loads?\b", _counted, said)
    said = re.sub(
        r"\bfrom (\S+) to (\S+ \S+) over the runs, in the first of them\b",
        r"da \1 a \2 nei calcoli, nel primo di essi", said,
    )  # fmt: skip
    said = PLACE.sub(lambda place: f"' in ({place[1]}) m ({KINDS[place[2]]})", said)
    said = re.sub(r"\b([\d,]+) (gap|angle|sliver|partial|corner|edge)\b", lambda m: f"{KINDS[m[2]]}: {m[1]}", said)
    said = re.sub(r"\) (?:and|e) ([\d,]+) more\b", r") e altri \1", said)
    said = re.sub(r"\b(\d+) supports? moved\b", r"vincoli spostati: \1", said)
    said = re.sub(r"\bin forces that balance\b", "in forze che si equilibrano", said)
    said = re.sub(r"\babout ([xyz])\b", r"attorno a \1", said)
    return re.sub(r"\balong ([xyz])\b", r"lungo \1", said)


def _counted(match: re.Match[str]) -> str:
    one, many = {
        "point": ("forza concentrata", "forze concentrate"), "pressure": ("pressione", "pressioni"),
        "traction": ("tensione", "tensioni"),
    }[match[2]]  # fmt: skip
    return f"{match[1]} {one if match[1] == '1' else many}"


def _as_sentence(english: str, said: str) -> tuple[str, str]:
    """Return a line that ends without a full stop as a sentence."""
    return f"{english[0].upper()}{english[1:]}.", f"{said[0].upper()}{said[1:]}."


def _entry(english: str, said: str) -> Entry:
    pattern, at, kinds = "", 0, {}
    for gap in GAP.finditer(english):
        pattern += re.escape(english[at : gap.start()]) + f"(?P<{gap[1]}>{NARROW.get(gap[2], INSIDE)})"
        kinds[gap[1]] = gap[2] or ""
        at = gap.end()
    pattern += re.escape(english[at:])
    return Entry(re.compile(pattern + (r"(?= |$)" if english.endswith(".") else "$")), said, kinds)
