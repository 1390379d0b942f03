"""What a diagnosis gives: the causes within the errors, what was examined, and what to do next."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.cracks.additions import Addition
from concio.analysis.cracks.cause import Cause
from concio.analysis.cracks.forward import Forward
from concio.analysis.cracks.future import Future
from concio.analysis.cracks.measurement import Candidate, Measurement
from concio.analysis.cracks.mistakes import Doubt
from concio.analysis.cracks.observed import Reading
from concio.analysis.cracks.places import Place
from concio.analysis.cracks.search import Trial
from concio.analysis.cracks.undetermined import Unseen
from concio.contact.assembly import Assembly
from concio.model.model import Model
from concio.verdict.diagnosis_verdict import diagnosis_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.diagnosis_accessor import DiagnosisPlots

Array = np.ndarray

FORCED = 1.0
"""Errors by which joints may close by the compliance that was added to them."""


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Shown):
    """The causes that explain what was measured on a structure.

    Parameters
    ----------
    model : Model
        As it was given.
    measurements : tuple of Measurement
    candidates : tuple of Candidate
    readings : tuple of Reading
        What each measurement reads of a state.
    forward : Forward
        Predicts the measurements for any motions.
    causes : tuple of Cause
        Those within the errors, the simplest first: fewest supports, then fewest motions, then least misfit.
    doubts : tuple of Doubt
        Measurements that all others contradict, each with the cause that then remains.
    trials : tuple of Trial
        Every choice of candidates that was examined, with its best fit.
    nearest : Cause or None
        The best fit, where none is within the errors.
    unseen : tuple of Unseen
        Combinations of motions that these measurements cannot determine.
    places : tuple of Place
        Where to measure next.
    future : Future or None
        What happens to the structure if the simplest cause goes on; None where nothing moves.
    orders : float
        Largest change of a reading of the simplest cause, in errors, where its motions come one after the other instead
        of together; 0 where there is one.
    refinement : float
        Largest change of such a reading, in errors, where the path is followed in four times as many steps.
    confidence : float
    most : int
        Largest number of motions that were tried together.
    seconds : float
    additions : tuple of Addition
        Further motions with which the simplest cause fits clearly better, though it is within the errors without.
    """

    model: Model
    measurements: tuple[Measurement, ...]
    candidates: tuple[Candidate, ...]
    readings: tuple[Reading, ...]
    forward: Forward
    causes: tuple[Cause, ...]
    doubts: tuple[Doubt, ...]
    trials: tuple[Trial, ...]
    nearest: Cause | None
    unseen: tuple[Unseen, ...]
    places: tuple[Place, ...]
    future: Future | None
    orders: float
    refinement: float
    confidence: float
    most: int
    seconds: float
    additions: tuple[Addition, ...] = ()

    def __repr__(self) -> str:
        return "\n".join((self.verdict.sentence, *self.verdict.lines(self.model.report)))

    @property
    def assembly(self) -> Assembly:
        """The assembly in which every candidate has a load group."""
        return self.forward.assembly

    @property
    def best(self) -> Cause | None:
        """The simplest cause: within the errors, else with a measurement left out, else the nearest; None without."""
        if self.causes:
            return self.causes[0]
        return self.doubts[0].cause if self.doubts else self.nearest

    @property
    def shown(self) -> tuple[Cause, ...]:
        """Causes drawn: within the errors, with a measurement left out, less simple but better; or the nearest."""
        better = (a.cause for a in self.additions if a.cause is not None)
        return (*self.causes, *(d.cause for d in self.doubts), *better) or tuple(filter(None, (self.nearest,)))

    @property
    def lost(self) -> tuple[Trial, ...]:
        """Choices of which no motion was reached."""
        return tuple(t for t in self.trials if t.fit is None)

    @property
    def width(self) -> float:
        """Error of the measurements of lengths [m], their median; of tilts alone that of points at the model's size."""
        errors = [m.error for m in self.measurements if m.quantity == "motion"]
        return float(np.median(errors or [m.error * self.model.size for m in self.measurements]))

    @property
    def lent(self) -> float:
        """Compliance added to hard joints between rigid blocks [m/kN, a pair of mean area]; 0 for none."""
        return self.forward.loaded.assembly.lent_compliance

    @cached_property
    def closing(self) -> float:
        """How far that compliance lets a joint close at most, of all causes [m]."""
        return max((self.forward.closing(c.prediction) for c in self.shown), default=0.0)

    @property
    def forced(self) -> bool:
        """Whether a cause forces rigid blocks together: joints close by more than an error of what was measured."""
        return self.closing > FORCED * self.width

    @property
    def left(self) -> int:
        """Number of choices that were left after one state, far from the measurements."""
        return sum(t.fit is not None and t.fit.left for t in self.trials)

    @cached_property
    def verdict(self) -> Verdict:
        """The answer with its question."""
        return diagnosis_verdict(self)

    @property
    def plot(self) -> DiagnosisPlots:
        """Figures by name: ``found.plot.cracks()``; matplotlib is loaded here."""
        plots: DiagnosisPlots = view(self, "plot")
        return plots

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``: plain types, kN, m and rad."""
        names = [m.name for m in self.measurements]
        return {
            "status": self.verdict.status,
            "sentence": self.verdict.sentence,
            "verdict": self.verdict.as_dict(),
            "title": self.model.title,
            "confidence": self.confidence,
            "measurements": [
                {"name": m.name, "kind": m.kind, "value": m.value, "error": m.error} for m in self.measurements
            ],
            "candidates": [{"name": c.name, "moves": c.mover, "quantity": c.quantity} for c in self.candidates],
            "causes": [_told(c, names) for c in self.causes],
            "nearest": None if self.nearest is None else _told(self.nearest, names),
            "doubts": [
                {
                    "measurement": d.measurement, "measured": d.measured, "predicted": d.predicted,
                    "deviations": d.deviations, "mistake": d.mistake, "factor": d.factor,
                    "place": None if d.place is None else list(d.place), "cause": _told(d.cause, names),
                }
                for d in self.doubts
            ],
            "unseen": [{"names": list(u.names), "motions": list(u.motions), "change": u.change} for u in self.unseen],
            "additions": [
                {
                    "name": a.name, "motion": a.motion, "misfit": a.misfit,
                    "motions": dict(zip(a.names, a.motions.tolist(), strict=True)),
                    "cause": None if a.cause is None else _told(a.cause, names),
                }
                for a in self.additions
            ],
            "measure_next": [
                {
                    "kind": p.kind, "joint": list(p.joint), "at": list(p.at), "predicted": list(p.predicted),
                    "spread": p.spread, "gain": p.gain, "direction": list(p.direction),
                }
                for p in self.places
            ],
            "closing": self.closing,
            "future": None if self.future is None else _plain(vars(self.future)),
            "order_of_motions": self.orders,
            "refinement": self.refinement,
            "tried": len(self.trials),
            "paths": self.forward.runs,
            "method": self.forward.method,
            "seconds": round(self.seconds, 3),
        }  # fmt: skip


def _told(cause: Cause, names: list[str]) -> dict[str, Any]:
    return {
        "motions": [
            {"name": n, "motion": float(s), "low": _finite(a), "high": _finite(b)}
            for n, s, a, b in zip(cause.names, cause.motion, cause.low, cause.high, strict=True)
        ],
        "misfit": cause.misfit,
        "freedom": cause.freedom,
        "probability": _finite(cause.probability),
        "certificate": cause.certificate,
        "left_out": [names[i] for i in cause.left_out],
        "predicted": [float(v) for v in cause.predicted],
        "residual": [float(v) for v in cause.residual],
    }


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    return {k: _finite(v) if isinstance(v, float) else v for k, v in values.items()}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
