"""The report of an assessment: one HTML file that prints to a clean PDF, in English or Italian."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import concio
from concio.analysis.seismic.assessment_asked import Head
from concio.analysis.seismic.floor import Storeys
from concio.contact.applied import applied_forces
from concio.plot.assessment_figures import model_figure
from concio.report.assessment_annex import annex_html
from concio.report.assessment_mechanism import brief_html, mechanism_html
from concio.report.assessment_texts import Texts
from concio.report.decisions_part import coverage_html, decisions_html
from concio.report.docx_file import write_docx
from concio.report.html_parts import page_html
from concio.report.italian_page import plain_italian
from concio.report.sensitivity_part import sensitivity_html
from concio.report.strengthening_part import before_after, strengthening_html
from concio.report.strips_part import strips_html
from concio.report.typeset import typeset
from concio.verdict.assessment_verdict import assessment_verdict
from concio.verdict.assessment_words import WORDS
from concio.verdict.verdict import Verdict

if TYPE_CHECKING:
    from concio.analysis.seismic.anchors import Anchor
    from concio.analysis.seismic.assessment import Assessment
    from concio.analysis.seismic.strengthening import Strengthened
    from concio.analysis.seismic.variations import TieForce, Variation
    from concio.analysis.sensitivity import Sensitivity

UNITS = {"weight": "-", "pressure": "kN/m2", "traction": "kN/m2", "point": "kN", "body": "kN/m3"}


BESIDE_LOADS = 30
"""The picture of a wall of more blocks has the width of the page, so that their names can be read."""


def write_assessment_report(found: Assessment, path: Path | str, **options: Any) -> Path:
    """Write the report of an assessment as HTML, or as docx; options as :class:`AssessmentReport`."""
    path = Path(path)
    if path.suffix.lower() == ".docx":
        return write_docx(AssessmentReport(found, **options, pictures="png").html(), path)
    path.write_text(AssessmentReport(found, **options).html(), encoding="utf-8")
    return path


class AssessmentReport(Texts):
    """Makes the report of an assessment.

    Parameters
    ----------
    found : Assessment
    head : Head, optional
        Project, author, language.
    tie : TieForce, optional
    anchors : sequence of Anchor
    varied : sequence of Variation
    sensitivity : Sensitivity, optional
        Of the weakest mechanism.
    stronger : Strengthened, optional
        A strengthening and what it needs.
    language : str, optional
        Instead of that of the head.
    pictures : {"svg", "png"}
        As :class:`Texts`.
    """

    def __init__(
        self,
        found: Assessment,
        *,
        head: Head | None = None,
        tie: TieForce | None = None,
        anchors: Sequence[Anchor] = (),
        varied: Sequence[Variation] = (),
        sensitivity: Sensitivity | None = None,
        stronger: Strengthened | None = None,
        language: str | None = None,
        pictures: str = "svg",
    ) -> None:
        self.found, self.head = found, head or Head()
        super().__init__(language or self.head.language, pictures)
        self.tie, self.anchors, self.varied = tie, tuple(anchors), tuple(varied)
        self.sensitivity, self.stronger = sensitivity, stronger

    # -- the whole ----------------------------------------------------------------------------------------------------

    def html(self) -> str:
        """Return the page."""
        title = self.head.project or self.found.model.title or self.words["title"]
        parts = [self.header(title), self.top(), self.site(), self.model(), self.search()]
        parts += self.mechanisms()
        stronger = "" if self.stronger is None else strengthening_html(self, self.stronger)
        parts += [self.varied_part(), self.tie_part(), stronger, annex_html(self, self.found, self.head, self.told)]
        footer = self.say("footer", version=concio.__version__)
        parts.append(f"<footer>{footer}</footer>")
        return page_html(title, typeset("".join(parts)), language=self.language, kind="assessment")

    def mechanisms(self) -> list[str]:
        """Return the first, which decides, in detail, and what has a name or is below one; on request all in detail."""
        mine, made = self.found.arguments.get("mechanisms") or {}, []
        every = self.found.mechanisms
        for k, m in enumerate(every):
            if self.head.full or k == 0:
                made.append(mechanism_html(self, m, k + 1, self.found.curve))
            elif m.section is None and (m.name in mine or m.least < 1.0):  # of strips there is a table
                made.append(brief_html(self, m, k + 1))
        if len(every) > 1 and not self.head.full:
            made.append(f"<p class=note>{self.say('not_full')}</p>")
        return made

    def header(self, title: str) -> str:
        """Return the head: title, project, author, date, code."""
        rows = [(key, getattr(self.head, key)) for key in ("project", "place", "author", "revision", "date")]
        fill = self.words["to_fill"]
        rows = [(self.words[key], value or fill) for key, value in rows if value or key in ("revision", "date")]
        rows.append((self.words["code"], f"{self.found.site.rules.name}"))
        facts = "".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows)
        return (
            f'<header><p class="brand">concio</p><p class=kind>{self.say("title")}</p><h1>{escape(title)}</h1>'
            f"<table class=facts><tbody>{facts}</tbody></table></header>"
        )

    @cached_property
    def told(self) -> Verdict:
        """The verdict in the language of the report."""
        return assessment_verdict(
            self.found, self.language, write=self.n, name=self.named,
            reason=lambda key: self.words["reason_" + key.replace(" ", "_")], way=self.way,
            of_model=plain_italian if self.language == "it" else str,
        )  # fmt: skip

    def top(self) -> str:
        """Return the verdict: what pushes, what was found, what proves it, what limits it and what is open."""
        told, w = self.told, self.words
        assumed = tuple(map(plain_italian if self.language == "it" else str, told.question.assumptions))
        facts = [("asked", (told.question.asked,)), ("acts", self.acting()), ("assumed", assumed),
                 ("limits", told.limits), ("not_checked", told.unchecked), ("attention", told.attention)]  # fmt: skip
        rows = "".join(f"<tr><th>{escape(w[key])}</th><td>{'<br>'.join(escape(v) for v in lines)}</td></tr>"
                       for key, lines in facts if lines)  # fmt: skip
        return (
            f'<section id=verdict><div class="verdict {told.tone}"><h2>{escape(told.headline)}</h2>'
            f"<p>{escape(told.answer)}</p><p class=cert>{escape(told.proof)}</p></div>"
            f"{coverage_html(self, self.found)}<table class=facts><tbody>{rows}</tbody></table></section>"
        )

    def acting(self) -> tuple[str, ...]:
        """Return what is multiplied with its kN, and what acts as it is."""
        lines = []
        for a in self.found.acting:
            key = "acts_multiplied" if a.role == "multiplied" else "acts_constant"
            what = self.way(a.group.removeprefix("push ")) if a.role == "multiplied" else a.group
            size = self.n(math.hypot(*a.force) if a.force else 0.0)
            parts = re.sub("^weights of ", self.words["acts_weights"] + " ", a.what)
            parts = re.sub(r"([\d.,]+(?:e-?\d+)?) kN", lambda m: f"{self.n(float(m[1].replace(',', '')))} kN", parts)
            lines.append(self.words[key].format(group=what, size=size, force=self.pair(a.force), parts=parts))
        return tuple(lines)

    def site(self) -> str:
        """Return site, limit states, knowledge."""
        site, w = self.found.site, self.words
        rules = site.rules
        rows = []
        for level in self.found.levels:
            hazard = site.at(level)
            s = site.spectrum(hazard)
            corners = "; ".join(self.n(v) for v in (s.T_B, s.T_C, s.T_D))
            rows.append([level, self.n(hazard.T_R), self.n(hazard.a_g), self.n(hazard.F0), self.n(hazard.T_star),
                         self.n(s.S), corners])  # fmt: skip
        head = [w[k] for k in ("level", "T_R", "a_g", "F0", "Tc", "S", "corners")]
        text = self.say("site_text", soil=site.soil, topography=site.topography, life=self.n(site.nominal_life),
                        use=site.use_class, clause=rules.clause("spectrum"))  # fmt: skip
        asked = [v for v in self.found.levels if rules.tables["levels"][v].get("on_request", False)]
        text += "".join(f" {self.say('on_request', level=v)}" for v in asked)
        text += " " + (self.say("hazard_source", source=site.source) if site.source else self.say("hazard_no_source"))
        if site.assumed:
            text += " " + self.say("hazard_assumed", what=", ".join(self.assumed(k) for k in site.assumed))
        building = ""
        if site.building:
            modes = "; ".join(self.mode(m) for m in site.building)
            building = f"<p>{self.say('building_text', clause=rules.clause('floor'), modes=modes)}</p>"
        reason = f" ({self.head.knowledge})" if self.head.knowledge else ""
        known = self.say("knowledge_text", level=self.found.knowledge, reason=reason, FC=self.n(self.found.confidence),
                         clause=rules.clause("knowledge"))  # fmt: skip
        why = self.say(f"FC_{self.found.confidence_by}")
        return (
            f"<section id=site><h2>{self.say('site')}</h2><p>{text}</p>{self.table(head, rows)}{building}"
            f"<h3>{self.say('knowledge')}</h3><p>{known} {why}</p>"
            f"{decisions_html(self, self.found, self.head.reasons)}</section>"
        )

    def assumed(self, key: str) -> str:
        """Return what of the site was not given, with the value that is used."""
        value = getattr(self.found.site, key)
        return WORDS[self.language][f"assumed_{key}"].format(value=self.n(value) if isinstance(value, float) else value)

    def mode(self, mode: Any) -> str:
        """Return a mode of the building in words."""
        if isinstance(mode, Storeys):
            T = mode.mode(mode.base, self.found.site.rules.tables["floor"]).T
            key = "mode_single" if mode.storeys == 1 else "mode_regular"
            return self.words[key].format(
                n=mode.storeys, H=self.n(mode.height), T=self.n(T), xi=self.n(mode.xi)
            )
        shape = abs(mode.participation * mode.shape)
        return self.words["mode_given"].format(T=self.n(mode.T), shape=self.n(shape), xi=self.n(mode.xi))

    def model(self) -> str:
        """Return the model: a drawing, and its loads."""
        model, w = self.found.model, self.words
        used = {rule.law for rule in model.rules}
        frictions = "; ".join(sorted({self.n(model.laws[k].friction) for k in used}))
        given = (model.laws[k].compressive_strength for k in used)
        strength = "".join(w["strength_text"].format(f=self.n(v)) for v in sorted({v for v in given if v is not None}))
        joints = len(self.found.assembly.detection.interfaces)
        thick = () if model.dim == 3 else sorted({b.thickness for b in model.outlines if b.kind != "fixed"})
        deep = "; ".join(self.n(v) for v in thick)
        deep = w["thickness_text"].format(thickness=deep) if deep else ""
        free = len(model.free_bodies)
        still = len(model.bodies) - free
        fixed = self.say("one_fixed") if still == 1 else self.say("several_fixed", n=str(still))
        text = self.say(
            "model_text", title=model.title or w["model"], free=str(free), fixed=fixed,
            joints=str(joints), friction=frictions, strength=strength, thickness=deep,
        )  # fmt: skip
        rows = []
        for k, load in enumerate(model.loads):
            forces = applied_forces(model, [k])
            nothing = np.zeros(model.dim)
            total = np.sum([f.force for f in forces], axis=0) if forces else nothing
            size = np.array([float(np.linalg.norm(f.force)) for f in forces])
            point = size @ np.array([f.point for f in forces]) / size.sum() if size.sum() > 0 else nothing
            value = "; ".join(self.n(v) for v in load.value)
            rows.append([escape(load.group), escape(w[f"load_{load.kind}"]), value, UNITS[load.kind],
                         self.pair(total), self.pair(point)])  # fmt: skip
        head = [w[k] for k in ("group", "kind", "value", "unit", "resultant", "point")]
        ties = ""
        if model.ties:
            made = [
                [escape(t.name), self.n(t.stiffness), self.n(t.prestress),
                 w["unlimited"] if t.yield_force is None else self.n(t.yield_force),
                 w["unlimited"] if t.break_elongation is None else self.n(t.break_elongation)]
                for t in model.ties
            ]  # fmt: skip
            names = [w["tie_title"], *(w[k] for k in ("stiffness", "prestress", "yield_force", "break"))]
            ties = f"<h3>{self.say('ties_text')}</h3>{self.table(names, made)}"
        if model.dim == 3:
            reach = np.ptp(np.vstack([np.asarray(b.vertices) for b in model.free_bodies]), axis=0)
            text += " " + self.say("overall", size=" x ".join(self.n(float(v)) for v in reach))
        wide = model.dim == 2 and free > BESIDE_LOADS
        drawn = self.figure(model_figure(self.found), "figure_model", "solid" if wide or model.dim == 3 else "tall")
        side = "" if wide else "even" if model.dim == 3 else "side"
        return (
            f"<section id=model><h2>{self.say('model')}</h2><p>{text}</p><div class=\"{side}\">{drawn}<div>"
            f"<h3>{self.say('loads')}</h3>{self.table(head, rows, 2)}{ties}</div></div></section>"
        )

    def search(self) -> str:
        """Return the table of mechanisms."""
        w, found = self.words, self.found
        rows = []
        for k, m in enumerate(found.mechanisms, 1):
            if m.section is not None and k > 1 and not self.head.full:
                continue  # the table of strips holds it
            verdict = self.outcome_of(m, found)
            rows.append([f'<a href="#m{k}">{escape(self.name(m))}</a>', escape(self.way(m.direction)),
                         self.n(m.multiplier, 6), self.n(m.e_star), self.n(m.onset), self.n(m.d0),
                         self.n(m.zeta if m.decisive else math.nan), verdict])  # fmt: skip
        for none in found.locked:
            said = "no_locked" if math.isinf(none.multiplier) else "no_large"
            text = self.say(said, alpha=self.n(none.multiplier))
            rows.append([escape(self.name(none)), escape(self.way(none.direction)), *["&ndash;"] * 5, text])
        head = [w[k] for k in ("name", "direction", "alpha0", "e_star", "a0_star", "d0", "zeta", "outcome")]
        text, strips = self.say("search_text"), strips_html(self, found)
        table = self.table(head, rows, 2)
        return f"<section id=search><h2>{self.say('search')}</h2><p>{text}</p>{table}{strips}</section>"

    # -- what if ------------------------------------------------------------------------------------------------------

    def varied_part(self) -> str:
        """Return what the weakest mechanism depends on, and how it changes with the joints."""
        if self.found.worst is None or not (self.varied or self.sensitivity):
            return ""
        title = f"<h2>{self.say('sensitivity')}</h2>"
        strip = self.found.worst.section is not None
        slides = self.found.worst.found.flow != "no sliding"
        derivatives = f"<p>{self.say('sens_slides')}</p>" if slides else ""
        if self.sensitivity:
            derivatives = sensitivity_html(self, self.sensitivity, strip=strip, slides=slides)
        if not self.varied:
            return f"<section id=sensitivity>{title}{derivatives}</section>"
        worst = self.found.worst
        rows = [[self.say("as_given"), escape(self.name(worst)), self.n(worst.multiplier, 6), self.n(self.found.zeta)]]
        for v in self.varied:
            stands = v.multiplier == v.multiplier
            text = self.n(v.multiplier, 6) if stands else self.say("does_not_stand")
            name = escape(self.named(v.name)) if v.name else "&ndash;"
            rows.append([self.say(f"vary_{v.what}", factor=self.n(v.factor)), name, text, self.n(v.zeta)])
        head = [self.words[k] for k in ("sensitivity", "name", "alpha0", "zeta")]
        return (
            f"<section id=sensitivity>{title}{derivatives}<p>{self.say('sensitivity_text')}</p>"
            f"{self.table(head, rows, 2)}</section>"
        )

    def needed(self) -> dict[str, float]:
        """Return the forces of ties that were found to be needed [kN]."""
        found = {} if self.tie is None else {self.tie.tie: self.tie.force}
        if self.stronger is not None and self.stronger.measure.kind == "tie":
            found[self.stronger.measure.of[0]] = self.stronger.amount
        return {name: force for name, force in found.items() if 0 < force < math.inf}

    def tie_part(self) -> str:
        """Return the tie force that is needed, and the checks of the anchors."""
        parts = []
        tie = self.tie
        if tie is not None:
            key = "tie_zero" if tie.force == 0 else "tie_never" if math.isinf(tie.force) else "tie_found"
            text = self.say(key, force=self.n(tie.force), tie=tie.tie, reached=self.n(tie.reached),
                            largest=self.n(tie.largest))  # fmt: skip
            parts.append(f"<p>{text}</p>")
            if tie.force > 0:
                parts.append(before_after(self, self.found, tie.assessment))
        forces = {t.name: t.strength if math.isfinite(t.strength) else None for t in self.found.model.ties}
        for anchor in self.anchors:
            force, key = forces.get(anchor.tie), "anchor_text"
            needed = self.needed()
            if anchor.tie in needed:
                force, key = needed[anchor.tie], "anchor_needed"
            if force is None:
                continue
            rows = [
                [self.say(c.kind), self.n(c.demand), self.n(c.capacity), self.verdict(c.ratio, c.holds)]
                for c in anchor.checks(force)
            ]
            head = [
                self.words["check"],
                *(f"{self.words[k]} [kN]" for k in ("demand", "capacity")),
                self.words["ratio"],
            ]
            parts.append(f"<p>{self.say(key, tie=anchor.tie, force=self.n(force))}</p>{self.table(head, rows)}")
        return f"<section id=tie><h2>{self.say('tie_title')}</h2>{''.join(parts)}</section>" if parts else ""
