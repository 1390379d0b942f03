"""The verdict of a seismic assessment: what pushes, the least zeta_E by limit state, its proof, and what is open.

It is the only place that says whether a mechanism or a structure is verified; console, ``--json``, report and notebook
are written from it, the report in its own language.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from concio.display import number
from concio.problem.limits_of_work import MOST_SLIDING
from concio.verdict.assessment_notes import assessment_notes
from concio.verdict.assessment_words import WORDS
from concio.verdict.attention import attention_of, joints_not_made
from concio.verdict.question import Question, other_stages, thickness_words
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.seismic.assessment import Assessment
    from concio.analysis.seismic.checks import Check
    from concio.analysis.seismic.local_mechanism import LocalMechanism, NoMechanism
    from concio.analysis.seismic.open_items import OpenItem

MOST_NAMES = 4
"""More mechanisms than this are counted in a sentence."""

TOGETHER = "and what slides with it"
"""How the names of the least parts that slide end, as :mod:`concio.analysis.seismic.sliding_parts` gives them."""

APART = 0.01
"""Relative difference of zeta_E and capacity over demand above which a sentence says why."""

ROUNDED = 1e-16
"""Smaller gaps are given as smaller than this."""

CUT = {
    "joints end": "its joints reach the end of their travel",
    "joint opens": "a joint opens, or a tie goes slack or yields",
    "several motions": "its joints allow more than one motion, or none",
    "no forces": "its joints carry no forces in equilibrium",
    "not asked": "no limit state asks for it",
    "no state": "no collapse state is found from which to continue",
    "jams": "its blocks jam and the multiplier rises far above alpha_0",
    "long": "too many changes of its joints to follow",
    "far": "it does not end",
}
"""Why a curve ends before its multiplier vanishes, in English."""

STATUS = {Outcome.HOLDS: "verified", Outcome.FAILS: "not_verified", Outcome.INCOMPLETE: "incomplete"}

Write = Callable[[float, int], str]


def assessment_verdict(
    found: Assessment, language: str = "en", *, write: Write = number, name: Callable[[str], str] | None = None,
    reason: Callable[[str], str] | None = None, way: Callable[[str], str] | None = None,
    of_model: Callable[[str], str] = str,
) -> Verdict:  # fmt: skip
    """Return the verdict of an assessment.

    Parameters
    ----------
    found : Assessment
    language : {"en", "it"}
    write : callable, optional
        Writes a number with some digits, as the language does.
    name, reason, way : callable, optional
        Names of mechanisms, why a curve ends, and which way is pushed, in the language.
    of_model : callable, optional
        Puts a sentence about the model, which all commands share, into the language.
    """
    return _Words(found, language, write, name or str, reason or _reason, way or str, of_model).verdict()


def none_sentence(none: NoMechanism, language: str = "en", largest: float = 2.0, write: Write = number) -> str:
    """Return why a search gave no mechanism to check."""
    if math.isinf(none.multiplier):
        return WORDS[language]["locked"]
    return WORDS[language]["large"].format(largest=f"{largest:g}", alpha=write(none.multiplier, 4))


def grounds(
    found: Assessment, language: str = "en", *, write: Write = number, name: Callable[[str], str] = str,
    way: Callable[[str], str] = str,
) -> tuple[str, ...]:  # fmt: skip
    """Return on what a judgement of acceptability can stand: the check by hand, the proofs, what is open.

    Parameters
    ----------
    found : Assessment
    language : {"en", "it"}
    write, name, way : callable, optional
        As :func:`assessment_verdict`.
    """
    words, lines = WORDS[language], []
    for m, check in zip(found.mechanisms[:1], found.hand_checks[:1], strict=True):
        lines.append(words["ground_hand"].format(name=name(m.name), hand=write(check.alpha, 9),
                     alpha=write(check.program, 9), difference=f"{check.difference:.0e}"))  # fmt: skip
    worst = max((check.difference for check in found.hand_checks), default=0.0)
    wrong = sum(not check.agrees for check in found.hand_checks)
    if wrong or len(found.mechanisms) > 1:
        key, n = ("ground_differs", wrong) if wrong else ("ground_all", len(found.mechanisms))
        lines.append(words[key].format(n=n, difference=f"{worst:.0e}"))
    lines += [words["ground_bound"].format(way=way(push), alpha=write(bound.multiplier, 6), gap=_gap(bound.gap))
              for push, bound in found.bounds.items() if bound.checked and math.isfinite(bound.multiplier)]  # fmt: skip
    if found.open:
        lines.append(words["ground_open"].format(n=len(found.open)))
    return tuple(lines)


def check_words(check: Check, language: str = "en", *, decides: bool = True, write: Write = number) -> str:
    """Return the outcome of one line "capacity over demand", with its ratio.

    Parameters
    ----------
    check : Check
    language : {"en", "it"}
    decides : bool
        Whether its limit state is decided by it; a linear check beside one in displacements does not decide.
    write : callable, optional
        Writes a number with some digits.
    """
    words = WORDS[language]
    if check.at_rest and check.demand > check.capacity:
        return words["row_rest"].format(least=write(check.least, 4))
    word = words["row_holds" if check.holds else "row_fails"].format(ratio=write(check.ratio, 4))
    return word if decides else words["row_beside"].format(word=word)


def ratio_words(ratio: float, holds: bool, language: str = "en", write: Write = number) -> str:
    """Return whether a ratio that is not a line of a mechanism is enough."""
    return WORDS[language]["row_holds" if holds else "row_fails"].format(ratio=write(ratio, 4))


def _gap(gap: float) -> str:
    """Return a duality gap; none is below what rounding leaves."""
    return f"{gap:.0e}" if gap >= ROUNDED else f"< {ROUNDED:.0e}"


class _Words:
    """Puts the verdict of one assessment into words."""

    def __init__(
        self, found: Assessment, language: str, write: Write, name: Callable[[str], str], reason: Callable[[str], str],
        way: Callable[[str], str], of_model: Callable[[str], str],
    ) -> None:  # fmt: skip
        self.found, self.language, self.words, self.write = found, language, WORDS[language], write
        self.name, self.reason = name, reason
        self.way, self.of_model = way, of_model

    def say(self, key: str, **values: Any) -> str:
        """Return a sentence; numbers in it are written as the language does."""
        told = {k: self.write(v, 4) if isinstance(v, float) else str(v) for k, v in values.items()}
        return self.words[key].format(**told)

    def verdict(self) -> Verdict:
        """Return all of it."""
        found = self.found
        outcome = Outcome.FAILS if found.least < 1.0 else Outcome.INCOMPLETE if found.open else Outcome.HOLDS
        asked = self.say("asked", levels=", ".join(found.levels), code=found.site.rules.name, FC=found.confidence)
        return Verdict(
            outcome=outcome,
            status=STATUS[outcome],
            question=Question(asked, found.acting, (*thickness_words(found.model), *other_stages(found.model))),
            headline=self.headline(outcome),
            answer=self.answer(outcome),
            proof=self.proof(),
            meaning=self.say("meaning"),
            limits=self.limits(),
            unchecked=tuple(self.item(item) for item in found.open),
            attention=(
                *(self.of_model(line) for line in attention_of(found.model, found.assembly.detection)),
                *assessment_notes(found, self.language, self.write), *self.assumed(),
            ),
            language=self.language,
        )

    def assumed(self) -> tuple[str, ...]:
        """Return what of the site was not given."""
        site = self.found.site
        what = ", ".join(self.say(f"assumed_{key}", value=getattr(site, key)) for key in site.assumed)
        return (self.say("assumed", what=what),) if what else ()

    def by_level(self) -> dict[str, float]:
        """Return the least zeta_E of all mechanisms at each limit state."""
        return {level: min((m.zeta_at(level) for m in self.found.mechanisms), default=math.inf)
                for level in self.found.levels}  # fmt: skip

    def headline(self, outcome: Outcome) -> str:
        """Return the answer in a few words, by name of the limit state."""
        worst = self.found.worst
        if worst is None:
            return self.say("headline_none" if outcome is Outcome.HOLDS else "headline_none_incomplete")
        level, zeta = self.decisive(worst)
        if outcome is Outcome.FAILS and zeta >= 1.0:
            level, zeta = min(self.by_level().items(), key=lambda item: item[1])
        elif worst.decisive is None:
            return self.say("headline_unchecked", level=level)
        return self.say(f"headline_{outcome.value}", zeta=zeta, level=level)

    def decisive(self, worst: LocalMechanism) -> tuple[str, float]:
        """Return the ultimate limit state that decides, and zeta_E there."""
        if worst.decisive is None:
            return ", ".join(worst.site.ultimate(self.found.levels)), math.inf
        return worst.decisive.level, worst.decisive.zeta

    def answer(self, outcome: Outcome) -> str:
        """Return the answer in sentences."""
        worst = self.found.worst
        if worst is None:
            why = "; ".join(self.say("none", name=self.name(n.name), way=self.way(n.direction), why=self.none(n))
                            for n in self.found.locked)  # fmt: skip
            text = self.say("answer_none", why=why)
            return text if outcome is Outcome.HOLDS else f"{text} {self.say('incomplete')}"
        level, zeta = self.decisive(worst)
        key = "answer" if worst.decisive else "answer_unchecked"
        parts = [self.say(key, level=level, zeta=zeta, name=self.name(worst.name), way=self.way(worst.direction),
                          alpha=self.write(worst.multiplier, 6))]  # fmt: skip
        levels = self.by_level()
        if len(levels) > 1:
            seen = {o.level for m in self.found.mechanisms for o in m.outcomes}
            none = self.say("not_checked")
            told = "; ".join(self.say("rest", level=k, zeta=v if k in seen else none) for k, v in levels.items())
            parts.append(self.say("by_level", levels=told))
        if outcome is Outcome.FAILS and zeta >= 1.0:
            low, least = min(levels.items(), key=lambda item: item[1])
            return " ".join([*parts, self.say("fails_other", level=low, zeta=least)])
        return " ".join([*parts, self.say(outcome.value)])

    def none(self, none: NoMechanism) -> str:
        """Return why a search gave no mechanism."""
        if math.isinf(none.multiplier):
            return self.say("locked")
        return self.say("large", largest=2, alpha=none.multiplier)

    def proof(self) -> str:
        """Return what proves the multiplier of the mechanism that decides; each gap belongs to its own number."""
        worst = self.found.worst
        if worst is None:
            return self.say("proof_none")
        flow = worst.found.flow.replace(" ", "_")
        bound, whole = worst.found.associated, self.found.bounds.get(worst.direction)
        if flow == "Coulomb" and whole is not None:
            if whole.upper >= worst.multiplier:
                bound = whole
            else:  # it decides by its zeta_E, while the whole begins to move at less
                flow = "Coulomb_part"
        return self.say(f"proof_{flow}", name=self.name(worst.name), way=self.way(worst.direction), upper=bound.upper,
                        gap=_gap(bound.gap))  # fmt: skip

    def limits(self) -> tuple[str, ...]:
        """Return what limits the answer."""
        found = self.found
        ways = len(found.bounds)
        named = len(found.arguments.get("mechanisms") or {}) * ways
        followed = len(found.mechanisms) + len(found.others)
        limits = [self.of_model(line) for line in joints_not_made(found.assembly.detection)]
        places = {kind: found.places.get(kind, (0, 0))[0] for kind in ("levels", "openings", "returns", "changes")}
        limits.append(self.say("sought", sought=found.sought, named=named, parts=found.sought - named - ways,
                               followed=followed, **places))  # fmt: skip
        limits += [self.say("left_out", sought=a, there=b, what=self.say(f"what_{kind}"))
                   for kind, (a, b) in found.places.items() if a < b]  # fmt: skip
        worst = found.worst
        own = worst is not None and worst.name in (found.arguments.get("mechanisms") or {})
        if worst is not None and worst.found.moving is not None and not own:
            bodies = "; ".join(b.label for b in worst.mechanics.blocks[:MOST_NAMES])
            key = "part" if worst.name == "weakest of all" else "part_decides"
            limits.append(self.say(key, bodies=bodies, name=self.name(worst.name)))
        if worst is not None and self.slides_alike(worst):
            limits.append(self.say("least_alike" if self.least_parts(worst) else "alike", name=self.name(worst.name)))
        limits += [self.say("brittle", tie=t.name, force=t.strength) for t in found.model.ties if t.strength < t.most
                   and t.yield_force is not None]  # fmt: skip
        apart = [
            (m, o) for m in found.mechanisms for o in m.outcomes
            if o.check.kind == "displacement" and not o.check.at_rest and math.isfinite(o.zeta)
            and o.check.a_g >= o.check.least and abs(o.zeta / o.check.ratio - 1.0) > APART
        ]  # fmt: skip
        if apart:
            m, o = apart[0]
            key = "corner_one" if len(apart) == 2 else "corner_more"
            more = self.say(key, n=len(apart) - 1) if len(apart) > 1 else ""
            limits.append(self.say("corner", name=self.name(m.name), level=o.level, zeta=o.zeta,
                                   ratio=o.check.ratio) + more)  # fmt: skip
        limits += [
            self.say("tie_limit", name=self.name(m.name), level=level)
            for m in found.mechanisms[:MOST_NAMES] for level, limit in m.limits.items() if limit.why == "ties"
        ]  # fmt: skip
        limits += [
            self.say("cut", name=self.name(m.name), way=self.way(m.direction), d=float(m.followed.end),
                     reason=self.reason(m.followed.reason))
            for m in found.mechanisms[:MOST_NAMES] if m.followed.ends and m.followed.reason != "falls"
        ]  # fmt: skip
        if found.strips:
            limits.append(self.strips())
        excused = found.arguments.get("elsewhere", ())
        if excused:
            limits.append(self.say("elsewhere", items=", ".join(self.say(f"elsewhere_{item}") for item in excused)))
        return tuple(limits)

    def slides_alike(self, worst: LocalMechanism) -> bool:
        """Return whether other blocks slide from the multiplier of a mechanism that slides on, and fare otherwise."""
        if not worst.mechanics.slides:
            return False
        return any(
            m.mechanics.slides and m.direction == worst.direction
            and math.isclose(m.multiplier, worst.multiplier, rel_tol=1e-6)
            and not math.isclose(m.least, worst.least, rel_tol=1e-6)
            for m in (*self.found.mechanisms, *self.found.others)
        )  # fmt: skip

    def least_parts(self, worst: LocalMechanism) -> bool:
        """Return whether the least parts that slide with a mechanism's push were followed.

        They are in the plane, where they are not too many and a mechanism slides by Coulomb's law.
        """
        alike = [m for m in (*self.found.mechanisms, *self.found.others) if m.direction == worst.direction]
        if any(m.name.endswith(TOGETHER) for m in alike):
            return True
        few = sum(b.kind != "fixed" for b in self.found.model.bodies) <= MOST_SLIDING
        sure = any(m.mechanics.slides and m.found.flow != "associated" for m in alike)
        return self.found.model.dim == 2 and few and sure

    def strips(self) -> str:
        """Return how a facade was searched out of its plane."""
        heights = dict.fromkeys(s.edge[0][1] for f in self.found.strips for s in f.strip.section.supports if s.edge)
        told = "; ".join(self.write(float(z), 4) for z in sorted(heights))
        held = self.say("strips_held", heights=told) if told else self.say("strips_free")
        courses = max(len(f.strip.section.free_bodies) for f in self.found.strips)
        return self.say("strips", n=len(self.found.strips), courses=courses, held=held)

    def item(self, item: OpenItem) -> str:
        """Return something that was not checked."""
        values = dict(item.values)
        if "name" in values:
            values["name"] = self.name(values["name"])
        if "way" in values:
            values["way"] = self.way(values["way"])
        if "reason" in values:
            values["reason"] = self.reason(values["reason"])
        if item.kind == "height":
            shown = [self.say("high", name=self.name(n), z=float(z)) for n, z in values["names"][:MOST_NAMES]]
            more = len(values["names"]) - len(shown)
            values["names"] = ", ".join([*shown, self.say("and_more", n=more)] if more else shown)
        live = ", live" if item.kind == "out of plane" and self.found.arguments.get("live") else ""
        return self.say(f"open_{item.kind}{live}", **values)


def _reason(key: str) -> str:
    """Return why a curve is cut, in English."""
    return CUT.get(key, key)
