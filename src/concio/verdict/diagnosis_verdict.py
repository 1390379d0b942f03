"""The verdict on the cause of cracks: which motions explain what was measured, and what these cannot determine."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from scipy.special import gammainccinv

from concio.display import number
from concio.problem.tolerances import CERTIFIED
from concio.verdict.attention import attention_of, joints_not_made
from concio.verdict.diagnosis_words import WORDS
from concio.verdict.question import Question, question_of
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.cracks.cause import Cause
    from concio.analysis.cracks.diagnosis import Diagnosis
    from concio.analysis.cracks.mistakes import Doubt
    from concio.analysis.cracks.places import Place

Write = Callable[[float, int], str]
PLACES = 3
"""Places named as the next to be measured."""
COARSE = 1.0
"""Change of a reading, in errors, from which on finer steps are asked for."""
FAR = 20.0
"""Times the misfit allowed beyond which a choice was left after one state (:data:`concio.analysis.cracks.fit.FAR`)."""
NOTABLE = 0.5
"""Change of a reading, in errors, from which on the order of motions is worth a word."""


def diagnosis_verdict(found: Diagnosis, language: str = "en", *, write: Write = number) -> Verdict:
    """Return the verdict of a diagnosis.

    Parameters
    ----------
    found : Diagnosis
    language : {"en", "it"}
    write : callable, optional
        Writes a number with some digits, as the language does.
    """
    return _Words(found, language, write).verdict()


class _Words:
    """Puts one diagnosis into words."""

    def __init__(self, found: Diagnosis, language: str, write: Write) -> None:
        self.found, self.language, self.words, self.write = found, language, WORDS[language], write
        self.comma = write(0.5, 1) == "0,5"
        self.units = found.model.report

    def say(self, key: str, **values: object) -> str:
        """Return a sentence; numbers in it are written as the language does."""
        told = {k: self.write(v, 4) if isinstance(v, float) else str(v) for k, v in values.items()}
        return self.words[key].format(**told)

    def verdict(self) -> Verdict:
        """Return all of it."""
        found = self.found
        outcome, status = self.outcome()
        return Verdict(
            outcome=outcome,
            status=status,
            question=self.question(),
            headline=self.headline(status),
            answer=" ".join(filter(None, (self.answer(status), *self.after()))),
            proof=self.proof(),
            meaning=self.words["meaning"],
            limits=self.limits(),
            unchecked=self.unchecked(),
            attention=(*attention_of(found.model, found.assembly.detection), *self.noticed()),
            next_steps=self.next_steps(status),
            language=self.language,
        )

    def outcome(self) -> tuple[Outcome, str]:
        """Return the outcome and its word."""
        found = self.found
        if found.refinement > COARSE:
            return Outcome.INCOMPLETE if found.causes else Outcome.UNDECIDED, "too_coarse"
        if len(found.causes) > 1:
            return Outcome.UNDECIDED, "several_causes"
        if found.causes and found.doubts:
            return Outcome.UNDECIDED, "several_causes"
        if found.causes and found.forced:
            return Outcome.INCOMPLETE, "forced_together"
        if found.causes and not found.causes[0].determined:
            return Outcome.INCOMPLETE, "not_determined"
        if found.causes and found.lost:
            return Outcome.INCOMPLETE, "not_all_followed"
        if found.causes:
            return Outcome.HOLDS, "one_cause" if found.causes[0].chosen else "no_motion"
        if found.doubts:
            return Outcome.INCOMPLETE, "measurement_in_doubt"
        if found.lost:
            return Outcome.UNDECIDED, "not_followed"
        return Outcome.FAILS, "no_cause"

    def question(self) -> Question:
        """Return what was asked, under which loads."""
        found = self.found
        asked = self.say(
            "asked", k=len(found.candidates), most=min(found.most, len(found.candidates)), n=len(found.measurements),
            confidence=f"{100 * found.confidence:g}",
        )  # fmt: skip
        factors = None if found.best is None else found.best.prediction.factors
        question = question_of(asked, found.assembly, factors or found.forward.moved.base)
        own = {g for g, c in zip(found.forward.moved.groups, found.candidates, strict=True) if c.body}
        return replace(question, acting=tuple(a for a in question.acting if a.group not in own))

    def headline(self, status: str) -> str:
        """Return the answer in a few words."""
        found = self.found
        first = found.causes[0] if found.causes else None
        cause = self.cause(first, intervals=False) if first is not None else ""
        keys = {
            "one_cause": "headline_one", "no_motion": "headline_rest", "several_causes": "headline_several",
            "not_determined": "headline_loose", "not_all_followed": "headline_partly",
            "too_coarse": "headline_coarse", "forced_together": "headline_forced",
            "measurement_in_doubt": "headline_doubt", "not_followed": "headline_lost", "no_cause": "headline_none",
        }  # fmt: skip
        names = ", ".join(dict.fromkeys(f"'{d.measurement}'" for d in found.doubts))
        return self.say(keys[status], cause=cause, count=len(found.causes) + len(found.doubts), names=names)

    def answer(self, status: str) -> str:
        """Return which causes explain the measurements."""
        found = self.found
        if found.causes and len(found.causes) + len(found.doubts) > 1:
            causes = [self.cause(c) for c in found.causes]
            told = self.one(found.causes[0])
            if len(causes) > 1:
                told = self.say("several", count=len(causes), causes=self.words["or"].join(causes))
            return " ".join((told, *map(self.rival, found.doubts)))
        if found.causes:
            return self.one(found.causes[0])
        if found.doubts:
            return " ".join(map(self.doubt, found.doubts))
        if found.nearest is None:
            return self.say("none_at_all", most=self.looked)
        near = found.nearest
        worst = int(abs(near.residual).argmax())
        return self.say(
            "none", most=self.looked, cause=self.cause(near, intervals=False), misfit=near.misfit,
            allowed=self.allowed(near), worst=found.measurements[worst].name, away=abs(float(near.residual[worst])),
        )  # fmt: skip

    @property
    def looked(self) -> int:
        """The most motions that were tried together."""
        return max((len(t.chosen) for t in self.found.trials), default=0)

    def one(self, cause: Cause) -> str:
        """Return a cause with its misfit."""
        key = "one" if cause.chosen else "rest"
        return self.say(key, cause=self.cause(cause), misfit=cause.misfit, freedom=cause.freedom,
                        allowed=self.allowed(cause))  # fmt: skip

    def allowed(self, cause: Cause) -> float:
        """Return the misfit that is within the errors."""
        if cause.freedom <= 0:
            return 0.0
        return float(2 * gammainccinv(cause.freedom / 2, 1 - self.found.confidence))

    def cause(self, cause: Cause, *, intervals: bool = True) -> str:
        """Return the motions of a cause in words."""
        if not cause.chosen:
            return self.words["nothing"]
        told = []
        for name, c, s, a, b in zip(cause.names, cause.chosen, cause.motion, cause.low, cause.high, strict=True):
            kind = self.found.candidates[c].quantity
            size = max(abs(v) for v in (s, a, b) if math.isfinite(v))
            motion, low, high = (self.quantity(kind, float(v), size) for v in (s, a, b))
            if not intervals:
                told.append(f"'{name}' {motion}")
            elif math.isfinite(a) and math.isfinite(b):
                told.append(self.say("motion", name=name, motion=motion, low=low, high=high))
            else:
                told.append(self.say("motion_open", name=name, motion=motion))
        return self.words["and"].join(told)

    def quantity(self, kind: str, value: float, size: float = 0.0) -> str:
        """Return a motion with its unit; of a load group the change of its factor."""
        if not math.isfinite(value):
            return self.words["unlimited"]
        if kind == "number":
            return self.say("number", value=self.write(value, 3))
        factor, symbol = self.units.factor(kind, size or value)
        return f"{self.write(factor * value, 3)} {symbol}"

    def doubt(self, doubt: Doubt) -> str:
        """Return what is suspicious about a measurement, in sentences."""
        kind = self.found.measurements[doubt.number].quantity
        size = max(abs(doubt.predicted), abs(doubt.measured))
        return self.say(
            "doubt", name=doubt.measurement, cause=self.cause(doubt.cause), away=doubt.deviations,
            measured=self.quantity(kind, doubt.measured, size), predicted=self.quantity(kind, doubt.predicted, size),
            mistake=self.mistake(doubt),
        )  # fmt: skip

    def rival(self, doubt: Doubt) -> str:
        """Return a simpler cause that contradicts one measurement."""
        told = self.say("rivals", name=doubt.measurement, cause=self.cause(doubt.cause), mistake=self.mistake(doubt))
        return told[0].upper() + told[1:]

    def mistake(self, doubt: Doubt) -> str:
        """Return which mistake would explain a measurement."""
        place = "" if doubt.place is None else f"{doubt.place[0]} | {doubt.place[1]}"
        return self.say(f"mistake_{doubt.mistake}", factor=doubt.factor, place=place)

    def after(self) -> tuple[str, ...]:
        """Return what fits better still, whether it stands, what another centimetre does, and where to measure next."""
        return (*self.additions(), *self.stands(), self.next_places())

    def additions(self) -> tuple[str, ...]:
        """Return the best further motion, with which the simplest cause fits clearly better."""
        told = []
        for a in self.found.additions[:1]:
            assert a.cause is not None
            told.append(self.say("addition", motions=self.cause(a.cause), misfit=a.misfit))
        return tuple(told)

    def stands(self) -> tuple[str, ...]:
        """Return whether the structure stands where the simplest cause has brought it."""
        found = self.found
        if found.best is None or (not found.causes and not found.doubts):
            return ()
        future = found.future
        if future is None:
            return (self.words["stands_small" if found.best.chosen else "stands_rest"],)
        told = []
        if not future.large:
            told.append(self.words["stands_small"])
        elif not future.began:
            return ()
        elif not future.stands:
            return (self.say("stands_not", share=f"{self.write(100 * future.followed, 3)} %"),)
        elif math.isinf(future.limit):
            told.append(self.say("stands_far", times=future.asked))
        else:
            told.append(self.say("stands", left=self.quantity("motion", future.left)))
        if future.large and not future.stands_another:
            told.append(self.words["another_fails"])
        elif math.isfinite(future.opening):
            now, then = (self.quantity("motion", v, future.opening) for v in (future.opening_now, future.opening))
            told.append(self.say("another", now=now, then=then))
        return tuple(told)

    def next_places(self) -> str:
        """Return where to measure next."""
        several = len(self.found.causes) + len(self.found.doubts) > 1
        told = [self.place(p, several) for p in self.found.places[:PLACES] if p.gain > 1.0]
        return self.say("next", places="; ".join(told)) if told else ""

    def place(self, place: Place, several: bool) -> str:
        """Return a place with what is predicted there."""
        at = ("; " if self.comma else ", ").join(self.write(v, 4) for v in place.at)
        axis = "xyz"[max(range(len(place.direction)), key=lambda i: abs(place.direction[i]))] if place.direction else ""
        name = self.say(f"place_{place.kind}", joint=" | ".join(place.joint), at=at, axis=axis)
        if not several:
            return self.say("spread", place=name, spread=self.quantity("motion", place.spread))
        size = max(abs(v) for v in place.predicted)
        values = self.words["or"].strip("; ").join(f" {self.quantity('motion', v, size)} " for v in place.predicted)
        return self.say("predicted", place=name, values=values.strip())

    def proof(self) -> str:
        """Return which equations were evaluated."""
        found = self.found
        if not found.shown:
            return ""
        worst = max(c.certificate for c in found.shown)
        told = self.say("proof", worst=self.short(worst), allowed=f"{CERTIFIED:.0e}", tried=len(found.trials),
                        runs=found.forward.runs)  # fmt: skip
        future = found.future
        if future is None or not future.large or not future.began:
            return told
        return told + self.say("proof_large", residual=self.short(future.residual))

    def short(self, value: float) -> str:
        """Return a residual with two digits."""
        return f"{value:.1e}".replace(".", "," if self.comma else ".")

    def limits(self) -> tuple[str, ...]:
        """Return what limits the answer."""
        found = self.found
        told = [*joints_not_made(found.assembly.detection), self.words["together"], self.words["small"]]
        if found.lent:
            told.append(self.say("lent", size=self.write(found.lent, 3)))
        if self.looked < len(found.candidates):
            told.append(self.say("sparse", size=self.looked))
        if found.left:
            told.append(self.say("left" if found.left > 1 else "left_one", count=found.left, far=f"{FAR:g}"))
        if not found.causes:
            told.append(self.words["local"])
        for unseen in found.unseen:
            parts = [
                self.say("unseen_part", name=n, motion=self.quantity(self.kind(n), s))
                for n, s in zip(unseen.names, unseen.motions, strict=True)
            ]
            told.append(self.say("unseen", motions=self.words["and"].join(parts), change=self.write(unseen.change, 2)))
        return tuple(told)

    def kind(self, name: str) -> str:
        """Return the kind of quantity of a candidate."""
        return next(c.quantity for c in self.found.candidates if c.name == name)

    def unchecked(self) -> tuple[str, ...]:
        """Return what would be expected and was not examined."""
        found = self.found
        told = []
        if found.lost:
            key = "unchecked_lost" if len(found.lost) > 1 else "unchecked_lost_one"
            told.append(self.say(key, count=len(found.lost)))
        if found.best is not None and found.best.chosen and (found.future is None or not found.future.large):
            told.append(self.words["unchecked_large"])
        elif found.future is not None and not found.future.began:
            told.append(self.words["unchecked_began"])
        return tuple(told)

    def noticed(self) -> tuple[str, ...]:
        """Return what asks for attention in the fit itself."""
        found = self.found
        told = []
        if found.forced:
            closing = self.quantity("motion", found.closing)
            told.append(self.say("forced", closing=closing, change=self.write(found.closing / found.width, 2)))
        if found.refinement > COARSE:
            told.append(self.say("coarse", change=found.refinement))
        if found.orders > NOTABLE:
            told.append(self.say("orders", change=found.orders))
        return tuple(told)

    def next_steps(self, status: str) -> tuple[str, ...]:
        """Return what to do next."""
        keys = {
            "several_causes": ("step_measure", "step_watch"), "not_determined": ("step_measure", "step_watch"),
            "measurement_in_doubt": ("step_doubt", "step_watch"), "no_cause": ("step_candidates",),
            "not_followed": ("step_candidates",), "forced_together": ("step_forced", "step_watch"),
        }  # fmt: skip
        return tuple(self.words[k] for k in keys.get(status, ("step_watch",)))
