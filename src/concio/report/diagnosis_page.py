"""The report of a diagnosis: one HTML file that prints to a clean PDF, in English or Italian."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import concio
from concio.display import number
from concio.plot.diagnosis_figure import plot_causes, plot_cracks, plot_readings
from concio.report.html_parts import figure_html, page_html
from concio.report.italian_page import plain_italian
from concio.report.language import words_of
from concio.verdict.diagnosis_verdict import diagnosis_verdict

if TYPE_CHECKING:
    from concio.analysis.cracks.cause import Cause
    from concio.analysis.cracks.diagnosis import Diagnosis

MOST_TRIALS = 60
"""Choices of motions listed."""
TELLING = 0.01
"""Places at which predictions differ by less than this share of an error are not listed."""
MOST_DRAWN = 4
"""Causes drawn on the structure."""


def write_diagnosis_report(
    found: Diagnosis, path: Path | str, *, language: str = "en", head: Mapping[str, str] | None = None
) -> Path:
    """Write the report of a diagnosis.

    Parameters
    ----------
    found : Diagnosis
    path : Path or str
    language : {"en", "it"}
    head : mapping, optional
        ``project``, ``place``, ``author`` and ``date``.

    Returns
    -------
    Path
        ``path``.
    """
    path = Path(path)
    path.write_text(DiagnosisReport(found, language, head or {}).html(), encoding="utf-8")
    return path


class DiagnosisReport:
    """Makes the report of a diagnosis.

    Parameters
    ----------
    found : Diagnosis
    language : {"en", "it"}
    head : mapping
    """

    def __init__(self, found: Diagnosis, language: str, head: Mapping[str, str]) -> None:
        self.found, self.language, self.head = found, language, head
        self.words = words_of("diagnosis_words", language)
        self.units = found.model.report
        titles = [self.say("cause", n=str(k)) for k in range(1, len(found.causes) + 1)]
        titles += [self.say("doubt", name=d.measurement) for d in found.doubts]
        titles += [self.words["addition"] for a in found.additions if a.cause is not None]
        self.shown = list(zip(found.shown, titles or [self.words["nearest"]], strict=False))

    def n(self, value: float, digits: int = 4) -> str:
        """Return a number as the language writes it."""
        text = number(value, digits)
        return text if self.language != "it" else text.replace(",", "\u2009").replace(".", ",")

    def say(self, key: str, **values: str) -> str:
        """Return a text of the language, not escaped."""
        return self.words[key].format(**values)

    def quantity(self, kind: str, value: float, size: float = 0.0) -> str:
        """Return a quantity with its unit."""
        if not math.isfinite(value):
            return self.words["unlimited"]
        factor, symbol = self.units.factor(kind, size or value)
        return f"{self.n(factor * value, 3)} {symbol}".strip()

    def told(self, line: str) -> str:
        """Return a line that every verdict has, such as what acts, in the language of the report."""
        return line if self.language != "it" else plain_italian(line)

    def html(self) -> str:
        """Return the page."""
        title = self.head.get("project") or self.found.model.title or self.words["title"]
        parts = [self.header(title), self.top(), self.causes(), self.measurements(), self.places(), self.trials()]
        parts.append(f"<footer>{escape(self.say('footer', version=concio.__version__))}</footer>")
        return page_html(title, "".join(parts), language=self.language, kind="assessment")

    def header(self, title: str) -> str:
        """Return the head: title, project, place, author, date."""
        rows = [(self.words[key], self.head.get(key, "")) for key in ("project", "place", "author", "date")]
        facts = "".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows if v)
        return (
            f'<header><p class="brand">concio</p><p class=kind>{escape(self.words["title"])}</p>'
            f"<h1>{escape(title)}</h1><table class=facts><tbody>{facts}</tbody></table></header>"
        )

    def top(self) -> str:
        """Return the verdict in the language of the report."""
        told, w = diagnosis_verdict(self.found, self.language, write=self.n), self.words
        facts: list[tuple[str, Sequence[str]]] = [
            ("asked", (told.question.asked,)), ("acts", told.question.loads(self.units)),
            ("assumed", told.question.assumptions), ("limits", told.limits),
            ("not_checked", told.unchecked), ("attention", told.attention), ("next_steps", told.next_steps),
        ]  # fmt: skip
        facts = [(key, [self.told(line) for line in lines]) for key, lines in facts]
        rows = "".join(f"<tr><th>{escape(w[key])}</th><td>{'<br>'.join(escape(v) for v in lines)}</td></tr>"
                       for key, lines in facts if lines)  # fmt: skip
        return (
            f'<section id=verdict><div class="verdict {told.tone}"><h2>{escape(told.headline)}</h2>'
            f"<p>{escape(told.answer)}</p><p>{escape(told.meaning)}</p><p class=cert>{escape(told.proof)}</p></div>"
            f"<table class=facts><tbody>{rows}</tbody></table></section>"
        )

    def causes(self) -> str:
        """Return every cause with its motions, on the drawing."""
        parts = []
        for k, (cause, title) in enumerate(self.shown):
            parts.append(f"<h3>{escape(title)}</h3>{self.motions(cause)}")
            if self.found.model.dim == 2 and k < MOST_DRAWN:
                axes = plot_cracks(self.found, cause=k, language=self.language, write=self.n)
                parts.append(figure_html(axes, f"cracks-{k + 1}", self.say("figure_cracks", title=title)))
        if self.shown:
            readings, causes = (plot(self.found, language=self.language) for plot in (plot_readings, plot_causes))
            parts.append(figure_html(readings, "readings", self.words["figure_readings"]))
            parts.append(figure_html(causes, "causes", self.words["figure_causes"]))
        return f"<section id=causes><h2>{escape(self.words['causes'])}</h2>{''.join(parts)}</section>"

    def motions(self, cause: Cause) -> str:
        """Return the motions of a cause with their intervals, in a table."""
        rows = []
        for name, c, *ends in zip(cause.names, cause.chosen, cause.motion, cause.low, cause.high, strict=True):
            kind = self.found.candidates[c].quantity
            size = max(abs(v) for v in ends if math.isfinite(v))
            rows.append([name, *(self.quantity(kind, float(v), size) for v in ends)])
        return self.table(("motion", "value", "from", "to"), rows) if rows else ""

    def measurements(self) -> str:
        """Return what was measured beside what each cause predicts, with residuals."""
        rows = []
        for i, m in enumerate(self.found.measurements):
            size = max([abs(m.value), m.error, *(abs(float(c.predicted[i])) for c, _ in self.shown)])
            row = [m.name, self.words[m.kind], self.quantity(m.quantity, m.value, size),
                   self.quantity(m.quantity, m.error, size)]  # fmt: skip
            for cause, _ in self.shown:
                told = self.quantity(m.quantity, m.rounded(float(cause.predicted[i])), size)
                row += [told, self.n(float(cause.residual[i]), 2)]
            rows.append(row)
        head = ["name", "kind", "measured", "error"]
        titles = [self.words[h] for h in head]
        for _, title in self.shown:
            titles += [f"{self.words['predicted']}: {title}", self.words["residual"]]
        return f"<section><h2>{escape(self.words['measurements'])}</h2>{self.titled(titles, rows)}</section>"

    def places(self) -> str:
        """Return where to measure next."""
        between = ", " if self.language != "it" else "; "
        rows = [
            [self.words[p.kind], " | ".join(p.joint), between.join(self.n(v) for v in p.at),
             "; ".join(self.quantity("motion", v, p.spread) for v in p.predicted), self.quantity("motion", p.spread)]
            for p in self.found.places
            if p.gain > TELLING
        ]  # fmt: skip
        if not rows:
            return ""
        table = self.table(("kind", "joint", "at", "by_cause", "spread"), rows)
        return f"<section><h2>{escape(self.words['next'])}</h2>{table}</section>"

    def trials(self) -> str:
        """Return the choices of motions that were examined, the best first."""
        accepted = {c.chosen for c in self.found.causes}
        names = [c.name for c in self.found.candidates]
        far = [t for t in self.found.trials if t.fit is not None]
        rows = []
        for t in sorted(far, key=lambda t: t.fit.misfit if t.fit else math.inf)[:MOST_TRIALS]:
            assert t.fit is not None
            word = "yes" if t.chosen in accepted else "left" if t.fit.left else "no"
            choice = ", ".join(names[c] for c in t.chosen) or self.words["nothing"]
            rows.append([choice, self.n(t.fit.misfit), str(t.fit.freedom), self.words[word]])
        rows += [[", ".join(names[c] for c in t.chosen), "", "", self.words["lost"]] for t in self.found.lost]
        table = self.table(("choice", "misfit", "freedom", "outcome"), rows)
        return f"<section><h2>{escape(self.words['tried'])}</h2>{table}</section>"

    def table(self, keys: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
        """Return a table headed by words of the language."""
        return self.titled([self.words[k] for k in keys], rows)

    @staticmethod
    def titled(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
        """Return a table under titles."""
        head = "".join(f"<th>{escape(t)}</th>" for t in titles)
        body = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
        return f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
