"""Texts, tables and figures of the assessment report in one language."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from concio.analysis.seismic.out_of_plane import EITHER
from concio.analysis.seismic.searching import ALL_FREE, EVERY
from concio.display import number
from concio.plot.figure_language import in_language
from concio.report.html_parts import figure_html
from concio.report.language import words_of
from concio.verdict.assessment_verdict import check_words, ratio_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.seismic.assessment import Assessment
    from concio.analysis.seismic.checks import Check
    from concio.analysis.seismic.local_mechanism import LocalMechanism

PART = {
    "above": r"above z = (\S+) m(?: of (.*))?",
    "beyond": r"beyond (\S+) m along the push(?: of (.*))?",
    "past": r"past (\S+) m across the push(?: of (.*))?",
    "short_of": r"short of (\S+) m across the push(?: of (.*))?",
    "alone": r"('.*') and what it touches",
    "slides": r"(.*) and what slides with it",
}
"""Names of parts of a structure, as :class:`concio.analysis.seismic.default_parts.Part` gives them."""


STRIP = r"(facade|pier with openings|pier|over opening)(?: of ('.*'))?(?:, x = (\S+) to (\S+) m)?"
"""Names of strips of a facade, as :class:`concio.analysis.seismic.sections.Strip` gives them."""

ASIDE = "out of plane: "
"""How names of mechanisms of strips begin, as :mod:`concio.analysis.seismic.out_of_plane` gives them."""


class Texts:
    """Words, numbers and pieces of HTML of one language; figures are numbered as they come.

    Parameters
    ----------
    language : str
    pictures : {"svg", "png"}
        Whether drawings are kept as lines where they are small, or are all pictures of dots.
    """

    def __init__(self, language: str, pictures: str = "svg") -> None:
        self.language, self.pictures = language, pictures
        self.words = {**words_of("assessment_words", language), **words_of("annex_words", language)}
        self.figures = 0

    def n(self, value: float, digits: int = 4) -> str:
        """Return a number as the language writes it."""
        if not math.isfinite(value):
            return self.words["beyond" if value > 0 else "unknown"]
        text = number(value, digits)
        if self.language != "it":
            return text
        return text.replace(",", "\u2009").replace(".", ",")

    def say(self, key: str, **values: str) -> str:
        """Return a sentence of the language, escaped."""
        return escape(self.words[key].format(**values))

    def name(self, mechanism: Any) -> str:
        """Return the name of a mechanism as it was asked for."""
        return self.named(str(mechanism.name))

    def named(self, name: str) -> str:
        """Return a name in the language: of the weakest of all and of parts; others are as they were given."""
        known = {EVERY: "every", ALL_FREE: "all_free"}
        if name in known:
            return self.words[known[name]]
        if name.startswith(ASIDE):
            strip, _, part = name.removeprefix(ASIDE).partition("; ")
            whole = self.words["aside"].format(strip=self.strip(strip))
            return f"{whole}; {self.named(part)}" if part else whole
        for kind, pattern in PART.items():
            found = re.fullmatch(pattern, name)
            if found and kind in ("alone", "slides"):
                return self.words[f"part_{kind}"].format(of=found[1])
            if found:
                return self.words[f"part_{kind}"].format(at=self.n(float(found[1])), of=found[2] or "").strip()
        return name

    def strip(self, name: str) -> str:
        """Return the name of a strip of a facade in the language."""
        found = re.fullmatch(STRIP, name)
        if found is None:
            return name
        kind, of, *sides = found.groups()
        word = self.words["strip_" + kind.replace(" ", "_")]
        word = f"{word} {of}" if of else word
        if sides[0] is None:
            return word
        a, b = (self.n(float(v)) for v in sides)
        return self.words["strip_sides"].format(what=word, a=a, b=b)

    def way(self, direction: str) -> str:
        """Return which way the earthquake pushes."""
        direction = direction.replace(" ", "_") if direction == EITHER else direction
        return self.words[direction] if direction in self.words else self.words["towards"].format(way=direction)

    def table(self, headings: Iterable[str], rows: Iterable[Sequence[str]], texts: int = 1) -> str:
        """Return a table; the first ``texts`` columns are words, the others numbers."""
        head = "".join(f"<th{' class=n' * (i >= texts)}>{escape(h)}</th>" for i, h in enumerate(headings))
        body = "".join(
            "<tr>" + "".join(f"<td{' class=n' * (i >= texts)}>{cell}</td>" for i, cell in enumerate(row)) + "</tr>"
            for row in rows
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def figure(self, axes: Axes, caption: str, kind: str = "") -> str:
        """Return a figure with its caption under it."""
        self.figures += 1
        made, name = in_language(axes, self.language), f"assessment-{self.figures}"
        drawn = figure_html(made, name, self.words[caption], dots=self.pictures == "png")
        text = f"<figcaption>{self.say(caption)}</figcaption></figure>"
        return drawn.replace("<figure ", f'<figure class="{kind}" ', 1).replace("</figure>", text)

    def verdict(self, ratio: float, holds: bool) -> str:
        """Return "verified" with its ratio."""
        if not math.isfinite(ratio):
            return escape(self.n(ratio))
        return self.toned(ratio_words(ratio, holds, self.language, self.n), holds)

    def outcome_of(self, m: LocalMechanism, found: Assessment) -> str:
        """Return in a table what came of a mechanism: nothing is verified of which something was not checked."""
        if m.least < 1:
            return self.verdict(m.least, False)
        if not m.complete:
            return self.say("unchecked")
        if m.at_its_height or "height" in found.arguments.get("elsewhere", ()):
            return self.verdict(m.least, True)
        return self.say("not_at_height", zeta=self.n(m.least))

    def checked(self, check: Check, *, decides: bool) -> str:
        """Return the outcome of a check."""
        return self.toned(check_words(check, self.language, decides=decides, write=self.n), check.holds)

    def toned(self, text: str, good: bool) -> str:
        """Return words in the colour of what holds, or of what does not."""
        return f'<b class="{"good" if good else "bad"}">{escape(text)}</b>'

    def pair(self, vector: Any, digits: int = 4) -> str:
        """Return the numbers of a vector."""
        numbers = [float(v) for v in vector]
        size = math.hypot(*numbers)
        return "(" + "; ".join(self.n(0.0 if abs(v) < 1e-9 * size else v, digits) for v in numbers) + ")"
