"""The report of a bridge: one HTML file that prints to a clean PDF, in English or Italian."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

import concio
from concio.display import number
from concio.plot.bridge_figures import change_name, plot_changes, plot_curve, plot_standing
from concio.plot.model_figure import plot_model
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.report.bridge_data import data_rows
from concio.report.html_parts import figure_html, page_html
from concio.report.language import words_of
from concio.verdict.bridge_verdict import bridge_verdict, heaviest_words
from concio.verdict.bridge_words import Words
from concio.verdict.italian import italian

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.bridges.bridge_result import BridgeResult
    from concio.analysis.bridges.service import ServiceState
    from concio.analysis.bridges.sweep import Standing

MOST_FRAMES, MOST_PRINTED = 16, 8
"""Positions in the film, and how many of them are printed."""
MOST_TOLD = 2
"""Data in the sentence on what matters most."""
SCRIPT = (
    "document.querySelectorAll('.film').forEach(f=>{const s=f.querySelector('input'),i=f.querySelectorAll('img');"
    "const d=()=>i.forEach((e,k)=>e.hidden=k!=s.value);s.addEventListener('input',d);d()})"
)
STYLE = (
    ".film img,.film input{width:100%}#summary .facts th{width:26em}"
    "@media screen and (max-width:700px){#summary .facts th{width:50%}}"
    "#signed td{height:3.2rem}"
    "@media print{.film input,.film-slider{display:none}.film img{display:none!important}.film-text{break-after:avoid}"
    ".film{break-before:avoid}.film img.printed{display:inline-block!important;width:49%;break-inside:avoid}}"
)


def write_bridge_report(found: BridgeResult, path: Path | str, *, language: Literal["en", "it"] = "en") -> Path:
    """Write the report of a bridge and return its path.

    Parameters
    ----------
    found : BridgeResult
    path : Path or str
    language : {"en", "it"}
    """
    path = Path(path)
    path.write_text(BridgeReport(found, language).html(), encoding="utf-8")
    return path


class BridgeReport:
    """Makes the report of a bridge.

    Parameters
    ----------
    found : BridgeResult
    language : {"en", "it"}
    """

    def __init__(self, found: BridgeResult, language: Literal["en", "it"]) -> None:
        self.found, self.language = found, language
        self.words, self.units = words_of("bridge_words", language), found.model.report
        self.drawn = {key[2:]: text for key, text in self.words.items() if key.startswith("f_")}
        self.said = Words(language, self.units)

    def n(self, value: float, digits: int = 4) -> str:
        """Return a number as the language writes it."""
        if not math.isfinite(value):
            return "\N{EN DASH}"
        text = number(value, digits)
        return text if self.language != "it" else text.replace(",", "\u2009").replace(".", ",")

    def unit(self, kind: str, value: float) -> str:
        """Return a quantity with its unit."""
        if not math.isfinite(value):
            return "\N{EN DASH}"
        factor, symbol = self.units.factor(kind, value)
        return f"{self.n(factor * value)} {symbol}".strip()

    def say(self, key: str, **values: str) -> str:
        """Return a text of the language."""
        return self.words[key].format(**values)

    def told(self, text: str) -> str:
        """Return a sentence that is made in English in the language of the report, as far as it is known."""
        if self.language == "en":
            return text
        return " ".join(self.said.local(p.text) if p.language == "it" else p.text for p in italian(text))

    def html(self) -> str:
        """Return the page."""
        title = self.found.model.title or self.words["title"]
        parts = [
            self.header(title), self.top(), self.summary(), self.model(), self.curve(), self.mechanism(), self.built(),
            self.sensitivity(), self.others(), self.service(), self.mexe(), self.film(), self.signed(),
        ]  # fmt: skip
        parts.append(f"<footer>{escape(self.say('footer', version=concio.__version__))}</footer>")
        return page_html(title, "".join(parts), language=self.language, kind="assessment", style=STYLE, script=SCRIPT)

    def header(self, title: str) -> str:
        """Return the head."""
        kind = escape(self.words["title"])
        return f'<header><p class="brand">concio</p><p class=kind>{kind}</p><h1>{escape(title)}</h1></header>'

    def top(self) -> str:
        """Return the verdict in the language of the report."""
        told, w = bridge_verdict(self.found, self.language), self.words
        facts: list[tuple[str, Sequence[str]]] = [
            ("asked", (told.question.asked,)),
            ("acts", [self.said.acting(v) for v in told.question.loads(self.units)]),
            ("limits", [self.told(line) for line in told.limits]), ("not_checked", told.unchecked),
            ("attention", [self.told(line) for line in told.attention]),
        ]  # fmt: skip
        rows = "".join(f"<tr><th>{escape(w[key])}</th><td>{'<br>'.join(escape(v) for v in lines)}</td></tr>"
                       for key, lines in facts if lines)  # fmt: skip
        return (
            f'<section id=verdict><div class="verdict {told.tone}"><h2>{escape(told.headline)}</h2>'
            f"<p>{escape(told.answer)}</p><p>{escape(told.meaning)}</p><p class=cert>{escape(told.proof)}</p></div>"
            f"<table class=facts><tbody>{rows}</tbody></table></section>"
        )

    def summary(self) -> str:
        """Return the numbers a client reads."""
        f, worst = self.found, self.found.worst
        width, by = f.width
        rows = [
            ("worst", f"{self.unit('length', worst.position)}, {self.words[worst.direction]}"),
            ("design", self.n(f.design)), ("bound", self.n(worst.multiplier)), *self._axle(),
            ("no_soil", self.words["none"] if f.without_soil is None else self.n(f.without_soil.multiplier)),
            ("soil_share", f"{self.n(100 * f.owed_to_soil, 3)} %"),
            ("spread_share", f"{self.n(100 * f.owed_to_spread, 3)} %"),
            ("width", f"{self.unit('length', width)} ({self.said.width(by)})"),
        ]  # fmt: skip
        return self.section("summary", self.facts(rows))

    def _axle(self) -> list[tuple[str, str]]:
        """Return the heaviest axle at the load factor, and that for the load factor asked for."""
        f = self.found
        if math.isnan(f.design):
            return []
        bare = replace(f.vehicle, dynamic=1.0, factor=1.0)
        keys = ("axle", "permissible") if f.vehicle.points else ("load", "permissible_load")
        found = (heaviest_words(f.vehicle, f.design, self.said), heaviest_words(bare, f.design / f.required, self.said))
        return [(key, number) for key, (_, number) in zip(keys, found, strict=True)]

    def model(self) -> str:
        """Return the bridge with its data and where they come from."""
        figure = self.figure(self._translated(plot_model(self.found.model, names=False)), "model", "model_figure")
        return self.section("model", figure + self.table(("datum", "value"), data_rows(self), texts=2))

    def _translated(self, axes: Axes) -> Axes:
        """Return a figure of the model with its legend in the language, and without what blocks are meshed by."""
        legend = axes.get_legend()
        for text in [] if legend is None else legend.get_texts():
            text.set_text(self.words.get("l_" + text.get_text().replace(" ", "_"), text.get_text()))
        for text in axes.texts:
            if "element" in text.get_text():
                text.set_text("")
        return axes

    def curve(self) -> str:
        """Return the load factor over the position, and the worst positions."""
        rows = [
            (self.unit("length", b.standing.position), self.words[b.standing.direction], self.n(b.limit.design),
             self.n(b.standing.multiplier), self.unit("force", b.standing.on_masonry)) for b in self.found.brackets
        ]  # fmt: skip
        table = self.table(("position", "direction", "carried", "not_exceeded", "on_masonry"), rows, texts=2)
        return self.section("curve", self.figure(plot_curve(self.found, words=self.drawn), "curve", "curve_figure")
                            + table)  # fmt: skip

    def mechanism(self) -> str:
        """Return the mechanism of the worst position."""
        if self.found.worst.limit.mechanism is None:
            return ""
        axes = plot_standing(self.found, words=self.drawn)
        return self.section("mechanism", self.figure(axes, "mechanism", "mechanism_figure"))

    def built(self) -> str:
        """Return what the bound is built up of."""
        top = self.found.worst.multiplier
        rows = [(self.words[name.replace(" ", "_")], self.n(v), f"{self.n(100 * v / top, 3)} %")
                for name, v in self.found.parts.items()]  # fmt: skip
        text = f"<p>{escape(self.words['built_text'])}</p>"
        return self.section("built", text + self.table(("datum", "factor", "share"), rows))

    def sensitivity(self) -> str:
        """Return the sensitivities, as bars and as a table."""
        if not self.found.changes:
            return ""
        rows = [
            (change_name(c, self.drawn), self.n(c.low), self.n(c.at_low), self.n(c.high),
             self.n(c.at_high)) for c in self.found.changes
        ]  # fmt: skip
        bars = self.figure(plot_changes(self.found, words=self.drawn), "changes", "sensitivity_figure")
        keys = ("name", "low", "at_low", "high", "at_high")
        most = [self.say("sensitivity_part", **dict(zip(keys, row, strict=True))) for row in rows[:MOST_TOLD]]
        bars += f"<p>{escape(self.say('sensitivity_sentence', parts='; '.join(most)))}</p>"
        return self.section("sensitivity", bars + self.table(("datum", "less", "factor", "more", "factor"), rows))

    def others(self) -> str:
        """Return further vehicles, each with its worst position."""
        rows = [(name, self.words["none"], "") if s is None else
                (name, self.n(s.multiplier), self.unit("length", s.position))
                for name, s in self.found.others.items()]  # fmt: skip
        found = self.section("others", self.table(("vehicle", "not_exceeded", "position"), rows)) if rows else ""
        if self.found.apart:
            pairs = [(self.unit("length", d), self.n(m)) for d, m in self.found.apart.items()]
            found += self.section("apart", self.table(("distance", "not_exceeded"), pairs))
        return found

    def service(self) -> str:
        """Return the working states."""
        states = [(self.words["as_built"], self.found.service)]
        if self.found.settled is not None:
            by = ", ".join(f"{n} {self.unit('motion', d)}" for n, d in self.found.settlements.items())
            states.append((self.say("settled", by=by), self.found.settled))
        columns = [self._state(state) for _, state in states]
        head = [self.words["state"], *(title for title, _ in states)]
        rows = [(self.words[key], *(c[key] for c in columns)) for key in columns[0]]
        text = f"<p>{escape(self.words['service_text'])}</p>"
        return self.section("service", text + self.titled(head, rows, texts=1))

    def _state(self, state: ServiceState) -> dict[str, str]:
        if state.status is not Status.SOLVED:
            none = dict.fromkeys(("open_joints", "slipping", "crushed", "largest_pressure", "deflection", "soil"),
                                 "\N{EN DASH}")  # fmt: skip
            return {"balance": self.words["no" if state.status in PROVEN_FAILURES else "open"], **none}
        rigid = math.isnan(state.deflection)
        return {
            "balance": self.words["yes"],
            "open_joints": str(state.open_joints), "slipping": str(state.slipping), "crushed": str(state.crushed),
            "largest_pressure": self.words["edge"] if math.isinf(state.largest_pressure)
            else self.unit("stress", state.largest_pressure),
            "deflection": self.words["rigid"] if rigid else self.unit("motion", state.deflection),
            "soil": self.unit("force", state.soil),
        }  # fmt: skip

    def mexe(self) -> str:
        """Return the formula's answer with its limits."""
        m = self.found.mexe
        if m is None:
            return self.section("mexe", f"<p>{escape(self.words['mexe_other'])}</p>")
        told = self.words["mexe_none"] if math.isnan(m.axle) else self.say(
            "mexe_text", axle=self.unit("force", m.axle), provisional=self.unit("force", m.provisional),
            profile=self.n(m.profile), factors=self.n(m.factors))  # fmt: skip
        lines = "".join(f"<li>{escape(self.told(line))}</li>" for line in m.limits)
        return self.section("mexe", f"<p>{escape(told)}</p><ul>{lines}</ul>")

    def film(self) -> str:
        """Return frames of the vehicle on its way, with a slider."""
        way = self.found.worst.direction
        least = self.found.worst.multiplier
        own = [s for s in self.found.standings if s.direction == way and s.limit.mechanism is not None
               and s.multiplier < 30 * least]  # fmt: skip
        if len(own) < 2:
            return ""
        at = np.array([s.position for s in own])
        wanted = np.linspace(at[0], at[-1], MOST_FRAMES)
        first = int(np.argmin(np.abs(at - self.found.worst.position)))
        picked = sorted({first, *(int(np.argmin(np.abs(at - x))) for x in wanted)})
        step = -(-len(picked) // MOST_PRINTED)
        begin = picked.index(first)
        frames = "".join(
            f'<img{" class=printed" * ((k - begin) % step == 0)}{" hidden" * (k != begin)} '
            f'alt="x = {self.n(own[i].position, 3)} m" src="{self._frame(own[i])}">' for k, i in enumerate(picked)
        )  # fmt: skip
        slider = f'<input type="range" min="0" max="{len(picked) - 1}" value="{begin}" aria-label="x">'
        text, moves = escape(self.words["film_text"]), escape(self.words["film_slider"])
        told = f'<p class="film-text">{text} <span class="film-slider">{moves}</span></p>'
        return self.section("film", f'{told}<div class="film">{slider}{frames}</div>')

    def signed(self) -> str:
        """Return empty fields for those who answer for the report."""
        head = "".join(f"<th>{escape(self.words[key])}</th>" for key in ("prepared", "reviewed", "date"))
        row = "<tr>" + "<td></td>" * 3 + "</tr>"
        return f"<table id=signed><thead><tr>{head}</tr></thead><tbody>{row}</tbody></table>"

    def _frame(self, standing: Standing) -> str:
        axes = plot_standing(self.found, standing, words=self.drawn)
        figure = axes.get_figure(root=True)
        assert figure is not None
        drawing = io.BytesIO()
        figure.savefig(drawing, format="png", dpi=75)
        return "data:image/png;base64," + base64.b64encode(drawing.getvalue()).decode("ascii")

    def section(self, key: str, inside: str) -> str:
        """Return a section with its heading."""
        return f"<section id={key}><h2>{escape(self.words[key])}</h2>{inside}</section>"

    def figure(self, axes: Axes, name: str, caption: str) -> str:
        """Return a figure with its caption."""
        text = escape(self.words[caption])
        drawn = figure_html(axes, name, self.words[caption])
        return drawn.replace("</figure>", f"<figcaption>{text}</figcaption></figure>")

    def facts(self, rows: Iterable[tuple[str, str]]) -> str:
        """Return a table of words and values."""
        body = "".join(f"<tr><th>{escape(self.words[k])}</th><td>{escape(v)}</td></tr>" for k, v in rows)
        return f"<table class=facts><tbody>{body}</tbody></table>"

    def table(self, head: Sequence[str], rows: Iterable[Sequence[str]], *, texts: int = 1) -> str:
        """Return a table whose headings are words of the language."""
        return self.titled([self.words[h] for h in head], rows, texts=texts)

    def titled(self, head: Sequence[str], rows: Iterable[Sequence[str]], *, texts: int = 1) -> str:
        """Return a table; the first ``texts`` columns are words, the others numbers."""
        top = "".join(f"<th{' class=n' * (i >= texts)}>{escape(h)}</th>" for i, h in enumerate(head))
        body = "".join(
            "<tr>" + "".join(f"<td{' class=n' * (i >= texts)}>{escape(v)}</td>" for i, v in enumerate(row)) + "</tr>"
            for row in rows
        )
        return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
