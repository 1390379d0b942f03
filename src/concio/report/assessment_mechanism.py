"""One mechanism in the assessment report: picture, forces, quantities, curves, checks."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from concio.plot.assessment_figures import curve_figure, demand_figure, mechanism_figure
from concio.report.assessment_texts import Texts

if TYPE_CHECKING:
    from concio.analysis.seismic.assessment import LocalMechanism
    from concio.analysis.seismic.checks import Check


def mechanism_html(t: Texts, m: LocalMechanism, place: int, used: str) -> str:
    """Return what was found of one mechanism."""
    title = f"{place}. " + t.words["mechanism"].format(name=t.name(m), direction=t.way(m.direction))
    flow = {"no sliding": "flow_none", "Coulomb": "flow_coulomb", "associated": "flow_associated"}[m.found.flow]
    said = t.say(flow, bound=t.n(m.found.associated.multiplier, 6))
    control = t.say("control_text", point=t.pair(m.control[1]), body=m.control[0], z=t.n(m.level))
    backs = [t.n(j.set_back) for j in m.mechanics.joints if j.inward is not None]
    back = t.say("set_back_text", values="; ".join(backs)) if backs else ""
    if not m.in_one_plane:
        back += " " + t.say("not_one_plane", clause=m.site.rules.clause("one_plane"))
    drawn = "figure_mechanism_3d" if m.assembly.model.dim == 3 else "figure_mechanism"
    return (
        f'<section class=mechanism id="m{place}"><h2>{escape(title)}</h2>'
        f"<div class=side>{t.figure(mechanism_figure(m), drawn, 'tall')}"
        f"<div><p>{said} {control} {back}</p>{_quantities(t, m)}</div></div>"
        f"{_chain(t, m)}{_curve(t, m, used)}{_checks(t, m)}</section>"
    )


def brief_html(t: Texts, m: LocalMechanism, place: int) -> str:
    """Return the checks of one mechanism alone."""
    title = f"{place}. " + t.words["mechanism"].format(name=t.name(m), direction=t.way(m.direction))
    return f'<section class=brief id="m{place}"><h3>{escape(title)}</h3>{_lines(t, m)}</section>'


def _lines(t: Texts, m: LocalMechanism) -> str:
    """Return the table of its checks."""
    head = [t.words[k] for k in ("level", "check", "where", "clause", "demand", "capacity", "ratio")]
    return t.table(head, [_line(t, c, m) for c in m.checks], 4)


def _chain(t: Texts, m: LocalMechanism) -> str:
    """Return the tables of forces."""
    w = t.words

    def kind(word: str) -> str:
        name, _, count = word.partition(" ")
        return w["weight_row"] if word == "weight" else f"{w['load_' + name]} {count}"

    most = max((abs(p.delta) for p in m.chain.participants), default=0.0)
    rows = [
        [escape(m.mechanics.blocks[p.block].label), escape(kind(p.kind)), t.n(p.size), t.pair(p.point),
         t.n(p.delta if abs(p.delta) > 1e-12 * most else 0.0)]
        for p in m.chain.participants
    ]  # fmt: skip
    others = [
        [escape(m.mechanics.blocks[f.block].label), escape(kind(word)), t.pair(f.force), t.pair(f.point)]
        for word, f in m.dead
    ]
    head = [w[k] for k in ("block", "kind", "force", "at", "delta")]
    text = t.say("chain_text", clause=m.site.rules.clause("multiplier"))
    return (
        f"<div class=pair><div><p>{text}</p>{t.table(head, rows, 2)}</div><div><p>{t.say('dead_text')}</p>"
        f"{t.table([w[k] for k in ('block', 'kind', 'force_xy', 'at')], others, 2)}</div></div>"
    )


def _quantities(t: Texts, m: LocalMechanism) -> str:
    """Return the formulas with their clauses and values."""
    c = m.site.rules.clause
    delta = "(P+Q)&thinsp;&delta;"
    rows = [
        ("&alpha;<sub>0</sub>", "formula_alpha", c("multiplier"), t.n(m.multiplier, 6), "-"),
        (f"e* = (&Sigma; {delta})&sup2; / [&Sigma;(P+Q) &Sigma; {delta}&sup2;]", "formula_e", c("share"),
         t.n(m.e_star, 6), "-"),
        ("a<sub>0</sub>* = &alpha;<sub>0</sub> g / (e* FC)", "formula_a0", c("acceleration"), t.n(m.onset, 6),
         "m/s2"),
        (f"d = d<sub>C</sub> &Sigma; {delta}&sup2; / (&delta;<sub>C</sub> &Sigma; {delta})", "formula_d",
         c("spectral"), f"{t.n(m.chain.spectral, 6)} d<sub>C</sub>", "m"),
    ]  # fmt: skip
    if m.followed.ends:
        rows.append(("d<sub>C0</sub>", "formula_dC0", c("end"), t.n(m.followed.end, 6), "m"))
    if m.branch is not None:
        b = m.branch
        rows += [
            (f"&lambda; = L / t = {t.n(b.length)} / {t.n(b.thickness)}", "formula_lambda", c("period"),
             t.n(b.slenderness), "-"),
            (f"T<sub>0</sub> = &kappa; &lambda; L &radic;(W / (E g)), &kappa; = {t.n(b.kappa)}", "formula_T0",
             c("period"), t.n(b.T0, 6), "s"),
            ("a = 4 &pi;&sup2; d / T<sub>0</sub>&sup2; = a(d): d<sub>y</sub>", "formula_dy", c("elastic"),
             t.n(b.d, 6), "m"),
            ("a<sub>y</sub>", "formula_ay", c("elastic"), t.n(b.a, 6), "m/s2"),
        ]
    made = [[f, t.say(key), escape(clause), value, unit] for f, key, clause, value, unit in rows]
    head = [t.words[k] for k in ("formulas", "kind", "clause", "value", "unit")]
    return f"<h3>{t.say('formulas')}</h3>{t.table(head, made, 3)}"


def _curve(t: Texts, m: LocalMechanism, used: str) -> str:
    """Return the capacity curves and the limits of displacement."""
    w = t.words
    head = f"<h3>{t.say('curve_title')}</h3>"
    if not m.followed.ends:
        reason = w["reason_" + m.followed.reason.replace(" ", "_")]
        return f"{head}<p>{t.say('curve_none', reason=reason)}</p>"
    how = "curve_steps" if m.followed.kind == "steps" else "curve_text"
    text = t.say(how, used=w[f"curve_{used}"])
    if m.followed.reason != "falls":
        reason = w["reason_" + m.followed.reason.replace(" ", "_")]
        text += " " + t.say("curve_cut", d=t.n(m.followed.end), reason=reason)
    if m.followed.reduced < 1.0:
        text += " " + t.say("curve_reduced", ratio=t.n(m.followed.reduced))
    if m.branch is not None:
        e = m.branch
        kind = w.get("kind_" + e.kind, e.kind)
        text += " " + t.say("branch_text", kind=kind, W=t.n(e.unit_weight), E=t.n(e.E), xi=t.n(e.xi))
    pictures = t.figure(curve_figure(m, w), "figure_curve", "half")
    pictures += t.figure(demand_figure(m, w), "figure_adrs", "half")
    difference = ""
    if m.straight is not None and m.limits:
        level, limit = next(iter(m.limits.items()))
        a, b = (m.factor * curve.at(limit.control) for curve in (m.followed, m.straight))
        difference = f"<p>{t.say('curve_difference', level=level, a=t.n(a, 6), b=t.n(b, 6))}</p>"
    rules = m.site.rules
    rows = []
    for level, v in m.limits.items():
        rule = rules.tables["levels"][level]
        formula = f"{t.n(rule['period'])} &pi; &radic;(d/a)"
        rows.append([level, escape(w[v.why]) + (f" {t.n(rule['share'])}" * (v.why == "share")),
                     escape(rules.clause("limits")), t.n(v.d, 6), t.n(v.a, 6), f"{formula} = {t.n(v.T, 6)}",
                     t.n(v.xi)])  # fmt: skip
    table = t.table([w[k] for k in ("level", "set_by", "clause", "d", "a", "T", "xi")], rows, 3) if rows else ""
    return f"{head}<p>{text}</p><div class=pair>{pictures}</div>{difference}<h3>{t.say('limits_text')}</h3>{table}"


def _checks(t: Texts, m: LocalMechanism) -> str:
    """Return the lines capacity over demand, and the acceleration of capacity."""
    w = t.words
    found = [[o.level, t.n(o.a_g), t.n(o.zeta), t.n(o.T_R), t.verdict(o.zeta, o.holds)] for o in m.outcomes]
    found += [[level, *[t.words["unknown"]] * 3, t.say("unchecked")] for level in m.unchecked]
    names = [w[k] for k in ("level", "a_cap", "zeta", "T_cap", "outcome")]
    return (
        f"<h3>{t.say('checks')}</h3>{_lines(t, m)}<h3>{t.say('outcomes')}</h3>"
        f"<p>{t.say('outcomes_text')}</p>{t.table(names, found)}"
    )


def _line(t: Texts, c: Check, m: LocalMechanism) -> list[str]:
    """Return one line of the checks."""
    q = m.q or m.site.rules.tables["levels"][c.level].get("q", 1.0)
    kind = t.say(c.kind, q=t.n(float(q))) if c.kind == "linear" else t.say(c.kind)
    return [c.level, kind, t.say(c.place), escape(c.clause), f"{t.n(c.demand, 5)} {c.unit}",
            f"{t.n(c.capacity, 5)} {c.unit}", t.checked(c, decides=m.decided_by(c))]  # fmt: skip
