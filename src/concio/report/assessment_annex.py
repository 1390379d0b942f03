"""The annex of an assessment report: what NTC 2018, 10.2 asks of a calculation that a computer has made."""

from __future__ import annotations

import json
import platform
from collections.abc import Sequence
from functools import cache
from html import escape
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

import concio
from concio.analysis.seismic.hand_check import AGREES, HandCheck, HandRow
from concio.kinematics.frames import turned_left
from concio.kinematics.rigid import motions
from concio.report.assessment_texts import Texts
from concio.verdict.assessment_verdict import grounds

if TYPE_CHECKING:
    from concio.analysis.seismic.assessment import Assessment
    from concio.analysis.seismic.assessment_asked import Head
    from concio.analysis.seismic.local_mechanism import LocalMechanism
    from concio.verdict.verdict import Verdict

BLOCK_BY_BLOCK = 16
"""Weights of more blocks than this are summed by macro-block, unless the whole is asked for."""

SYMBOLS = (
    ("alpha_0", "s_alpha"), ("e*", "s_e"), ("a_0* = alpha_0 g / (e* FC)", "s_a0"), ("FC", "s_FC"), ("d_0", "s_d0"),
    ("d_C", "s_dC"), ("d_SLV, d_SLC", "s_dSL"), ("T_SLV, T_SLC", "s_T"), ("a_g", "s_ag"), ("F_0, T_C*", "s_spec"),
    ("S", "s_S"), ("q", "s_q"), ("zeta_E", "s_zeta"), ("P, Q", "s_P"), ("δ", "s_delta"),
)  # fmt: skip

ROUNDING = 1e-13
"""Displacements and works below this share of the largest are printed as zero; the sums have them."""

COMPUTER = "NTC 2018, 10.2"
"""Clause that asks for it."""

USED = ("numpy", "scipy", "highspy", "shapely")
"""Packages whose version belongs to that of the program."""


def annex_html(t: Texts, found: Assessment, head: Head, told: Verdict) -> str:
    """Return the annex: kind of analysis, program, method, validation, check by hand, judgement, attention, symbols."""
    title = t.say("annex", clause=COMPUTER)
    parts = [_kind(t, found), _program(t, found), _method(t, found), _validation(t, found), _hand(t, found, head)]
    parts += [_judgement(t, found, head), _attention(t, told), _symbols(t), _signature(t, head)]
    return f"<section id=annex><h2>{title}</h2>{''.join(parts)}</section>"


def _kind(t: Texts, found: Assessment) -> str:
    rules = found.site.rules
    text = t.say("a_kind_text", code=rules.name, clause=rules.clause("displacement"))
    return f"<h3>{t.say('a_kind')}</h3><p>{text}</p>"


def _program(t: Texts, found: Assessment) -> str:
    packages = ", ".join(f"{name} {_version(name)}" for name in USED)
    runs = f"Python {platform.python_version()}, {packages}; {found.model.engine}"
    rows = [("a_title", "concio"), ("a_version", concio.__version__), ("a_makers", t.words["a_makers_are"]),
            ("a_licence", t.words["a_licence_is"]), ("a_runs", runs)]  # fmt: skip
    facts = "".join(f"<tr><th>{t.say(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows)
    return f"<h3>{t.say('a_program')}</h3><table class=facts><tbody>{facts}</tbody></table>"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "-"


def _slides(found: Assessment) -> bool:
    return any(m.found.flow != "no sliding" for m in found.mechanisms)


def _crushes(found: Assessment) -> bool:
    return any(law.compressive_strength is not None for law in found.model.laws.values())


def _method(t: Texts, found: Assessment) -> str:
    clause = found.site.rules.clause
    clauses = "; ".join(dict.fromkeys(clause(k) for k in ("share", "acceleration", "spectral", "limits")))
    keys = ["a_method_bound", *(["a_method_coulomb"] if _slides(found) else []), "a_method_curve"]
    keys += ["a_method_crush"] if _crushes(found) else []
    lines = "".join(f"<li>{t.say(key, clauses=clauses)}</li>" for key in keys)
    return f"<h3>{t.say('a_method')}</h3><ul>{lines}</ul>"


@cache
def validation_rows() -> dict[str, Any]:
    """Return the cases that concern assessments, as the validation book has them."""
    text = (files("concio.report") / "validation_rows.json").read_text(encoding="utf-8")
    table: dict[str, Any] = json.loads(text)
    return table


def _validation(t: Texts, found: Assessment) -> str:
    """Return the cases that concern what was used: plane or space, with or without joints that slide."""
    wanted = ["local_mechanisms", "block_on_base" if found.model.dim == 2 else "blocks_in_space"]
    if _slides(found):
        wanted.append("ferris_tin_loi" if found.model.dim == 2 else "corner_walls")
    table = validation_rows()
    rows = []
    for case in wanted:
        given = table[case]
        worst = max(given["rows"], key=lambda r: r["difference"])
        size = t.n(worst["difference"], 2) if worst["difference"] else "&lt; 1e-9"
        source = t.words.get(f"source_{case}", given["source"])
        rows.append([t.say(f"case_{case}"), escape(source), str(len(given["rows"])), size,
                     t.n(worst["tolerance"], 2)])  # fmt: skip
    head = [t.words[k] for k in ("a_case", "a_source", "a_rows", "a_worst", "a_allowed")]
    text = f"<p>{t.say('a_validation_text')}</p>{t.table(head, rows, 2)}"
    return f"<h3>{t.say('a_validation')}</h3>{text}"


def _hand(t: Texts, found: Assessment, head: Head) -> str:
    """Return alpha_0 of the mechanism that decides once more, in full, and of all others as a number."""
    if not found.mechanisms:
        return ""
    m, check = found.mechanisms[0], found.hand_checks[0]
    text = t.say("a_hand_text", name=t.name(m), way=t.way(m.direction), open=t.n(check.open, 1),
                 clause=m.site.rules.clause("multiplier"))  # fmt: skip
    moves = "".join(f"<li>{g + 1}. {escape(b.label)}: {escape(_motion(t, m, g))}</li>"
                    for g, b in enumerate(m.mechanics.blocks[:BLOCK_BY_BLOCK]))  # fmt: skip
    result = t.say("a_result", resists=t.n(check.resists, 7), pushes=t.n(check.pushes, 7), hand=t.n(check.alpha, 9),
                   alpha=t.n(check.program, 9))  # fmt: skip
    parts = [f"<h3>{t.say('a_hand')}</h3><p>{text}</p><p>{t.say('a_motion')}:</p><ul>{moves}</ul>",
             _work(t, found, check, whole=head.full), f"<p><b>{result}</b></p>"]  # fmt: skip
    if len(found.mechanisms) > 1:
        rows = [[escape(t.name(o)), escape(t.way(o.direction)), t.n(c.program, 6), t.n(c.alpha, 6),
                 t.n(c.difference, 1)] for k, (o, c) in enumerate(zip(found.mechanisms, found.hand_checks, strict=True))
                if head.full or k == 0 or o.section is None or not c.agrees]  # fmt: skip
        names = [t.words[k] for k in ("name", "direction", "a_by_program", "a_by_hand", "a_difference")]
        parts.append(f"<p>{t.say('a_all')}</p>{t.table(names, rows, 2)}")
    stuck = max(c.left_open for c in found.hand_checks)
    if stuck > min(AGREES.values()):
        parts.append(f"<p>{t.say('a_stuck', stuck=t.n(stuck, 1))}</p>")
    return "".join(parts)


def _motion(t: Texts, m: LocalMechanism, g: int) -> str:
    """Return how a macro-block moves."""
    dim = m.assembly.model.dim
    block = m.mechanics.blocks[g]
    move = m.velocity.reshape(len(m.mechanics.blocks), motions(dim))[g]
    shift, turn = move[:dim], move[dim:]
    reach = max(float(np.ptp(np.asarray(m.assembly.model.bodies[b].vertices), axis=0).max()) for b in block.bodies)
    if float(np.abs(turn).max()) * reach < 1e-6 * float(np.abs(move).max()):
        return t.words["a_shifts"].format(shift=t.pair(shift))
    if dim == 3:
        return t.words["a_screws"].format(shift=t.pair(shift), angle=t.pair(turn))
    centre = block.centre + turned_left(shift) / turn[0]
    return t.words["a_turns"].format(angle=t.n(float(turn[0]), 6), point=t.pair(centre, 6))


def _work(t: Texts, found: Assessment, check: HandCheck, *, whole: bool) -> str:
    """Return the table of forces, virtual displacements and work."""
    weights = check.part("weight")
    rows = list(weights) if whole or len(weights) <= BLOCK_BY_BLOCK else _summed(t, weights)
    rows += [r for kind in ("load", "tie", "joint") for r in check.part(kind)]
    numbers = ("rise", "along", "resists", "pushes")
    tops = {key: max((abs(getattr(r, key)) for r in rows), default=0.0) for key in numbers}

    def told(row: HandRow, key: str) -> str:
        value = float(getattr(row, key))
        return t.n(value if abs(value) > ROUNDING * tops[key] else 0.0, 6)

    made = [
        [_name(t, found, r), t.n(r.size, 6), t.pair(r.point, 6), told(r, "rise"), told(r, "along") if r.pushes else "",
         told(r, "resists"), told(r, "pushes") if r.pushes else ""]
        for r in rows
    ]  # fmt: skip
    made.append([f"<b>{t.say('a_sum')}</b>", "", "", "", "", f"<b>{t.n(check.resists, 7)}</b>",
                 f"<b>{t.n(check.pushes, 7)}</b>"])  # fmt: skip
    keys = ("a_on", "a_force", "a_point", "a_rise", "a_along", "a_resists", "a_pushes")
    return t.table([t.words[k] for k in keys], made, 1)


def _summed(t: Texts, weights: Sequence[HandRow]) -> list[HandRow]:
    """Return the weights of each macro-block as one, in their common centroid."""
    made = []
    for g in sorted({r.block for r in weights}):
        own = [r for r in weights if r.block == g]
        size = sum(r.size for r in own)
        point = np.sum([r.size * np.array(r.point) for r in own], axis=0) / size
        resists, pushes = sum(r.resists for r in own), sum(r.pushes for r in own)
        label = t.words["a_weights_of" if len(own) > 1 else "a_weight_of_one"].format(number=g + 1, n=len(own))
        made.append(HandRow("sum", label, g, own[0].load, size, tuple(point.tolist()), resists / size, pushes / size,
                            resists, pushes))  # fmt: skip
    return made


def _name(t: Texts, found: Assessment, row: HandRow) -> str:
    """Return what a row of the table is of."""
    if row.kind == "sum":
        return escape(row.name)
    if row.kind == "load":
        model = found.mechanisms[0].section or found.model
        kind = t.words[f"load_{model.loads[row.load].kind}"]
        text = t.words["a_load_on"].format(name=row.name, kind=kind, number=row.load + 1)
        return escape(text if row.own else t.words["a_taken"].format(what=text))
    key = {"weight": "a_weight_of", "tie": "a_tie_of", "joint": "a_slide_of"}[row.kind]
    name = row.name
    if row.kind == "joint":  # "-" stands for what does not move
        name = " / ".join(t.words["a_still"] if part == "-" else part for part in name.split(" / "))
    return t.say(key, name=name)


def _judgement(t: Texts, found: Assessment, head: Head) -> str:
    """Return the grounds of a judgement, and the judgement where the author has given one."""
    told = grounds(found, t.language, write=t.n, name=t.named, way=t.way)
    lines = "".join(f"<li>{escape(line)}</li>" for line in told)
    own = escape(head.judgement) if head.judgement else "<span class=fill></span><span class=fill></span>"
    return (f"<h3>{t.say('a_judgement')}</h3><ul>{lines}</ul>"
            f"<p class=keep>{t.say('a_judgement_line')} {own}</p>")  # fmt: skip


def _attention(t: Texts, told: Verdict) -> str:
    lines = [*told.attention, *told.unchecked]
    text = "".join(f"<li>{escape(line)}</li>" for line in lines)
    body = f"<ul>{text}</ul>" if lines else f"<p>{t.say('a_attention_none')}</p>"
    return f"<h3>{t.say('a_attention')}</h3>{body}"


def _symbols(t: Texts) -> str:
    text = "".join(f"<span><b>{symbol}</b> {t.say(key)}</span>" for symbol, key in SYMBOLS)
    return f"<h3>{t.say('a_symbols')}</h3><p class=symbols>{text}</p>"


def _signature(t: Texts, head: Head) -> str:
    """Return the place for name, date, signature and stamp."""
    fill = t.words["to_fill"]
    rows = [("a_sign", head.author or fill), ("date", head.date or fill), ("a_signature", fill)]
    facts = "".join(f"<tr><th>{t.say(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows)
    return (f"<div class=sign><table class=facts><tbody>{facts}</tbody></table>"
            f"<div class=stamp>{t.say('a_stamp')}</div></div>")  # fmt: skip
