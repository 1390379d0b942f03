"""From cracks to cause: ``concio.diagnose(model, measurements, candidates)``."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from concio.analysis.cracks.additions import additions_of
from concio.analysis.cracks.cause import Cause, cause_of
from concio.analysis.cracks.diagnosis import Diagnosis
from concio.analysis.cracks.fit import FAR, Fit, Fitter
from concio.analysis.cracks.forward import Forward, Prediction
from concio.analysis.cracks.future import Future, future_of
from concio.analysis.cracks.measurement import AT_A_JOINT, Candidate, Measurement
from concio.analysis.cracks.mistakes import Doubt, doubts_of
from concio.analysis.cracks.moved import moved_model
from concio.analysis.cracks.observed import readings
from concio.analysis.cracks.places import Place, next_places
from concio.analysis.cracks.search import Found, Trial, allowed, search
from concio.analysis.cracks.undetermined import Unseen, rivals_of, unseen_of
from concio.analysis.entry_point import entry_point
from concio.arguments import strict
from concio.contact.assembly import as_assembly
from concio.contact.separate import surroundings
from concio.errors import InputError
from concio.model.model import Model, require_model
from concio.problem.solution import ProgressCallback

Array = np.ndarray

LEAST = 5.0
"""Motions are expected to be at least this many errors large."""
HALF = 2.0
"""A rotation that is expected moves points at the size of the structure over this by what was measured."""
FINER = 4
"""The simplest cause is followed once more in this many times as many steps."""
WARMER = 10.0
"""Changes of temperature are expected to be of this size [K]."""
MOST = 3
"""Motions tried together unless stated otherwise."""
STEPS = (4, 16, 64)
"""Steps of a path that is followed in steps: the next number is taken where readings change too much in finer ones."""
CHANGED = 0.3
"""Change of a reading in finer steps, in errors, up to which steps are fine enough."""
COARSE = 1.0
"""Change of a reading, in errors, beyond which nothing can be said: only then are the most steps taken."""


@strict
@entry_point
def diagnose(
    model: Model,
    measurements: Sequence[Measurement],
    candidates: Sequence[Candidate],
    *,
    most: int = MOST,
    beyond: int = 0,
    confidence: float = 0.95,
    method: Literal["events", "steps"] | None = None,
    steps: int | None = None,
    large: bool = True,
    progress: ProgressCallback | None = None,
) -> Diagnosis:
    """Return the motions that explain what was measured, all that are within the errors, the simplest first.

    The structure is loaded, then supports are moved; every prediction is a certified settlement path. Choices of few
    candidates are fitted first, and the search ends with the number of motions at which the first cause is found.

    Parameters
    ----------
    model : Model
        As it stood before anything moved, in the plane or in space.
    measurements : sequence of Measurement
    candidates : sequence of Candidate
    most : int
        Maximum number of motions tried together.
    beyond : int
        How many motions more than the simplest cause has are examined.
    confidence : float
        Of the set of causes and of every interval.
    method : {"events", "steps"}, optional
        How paths are followed; by default event by event in the plane up to 150 contact pairs, else in steps.
    steps : int, optional
        Load steps, if the path is followed in steps. By default 4, and 16 where no cause was found, or a best
        fit, followed again in four times as many, changes a reading by more than 0.3 errors; 64 where it then still
        changes by more than an error, or no cause was found. What the change comes to is reported.
    large : bool
        Whether the simplest cause is followed at large displacements, to its limit; in the plane.
    progress : callable, optional

    Raises
    ------
    InputError
        A measurement or a candidate cannot be used, or there are not more measurements than one.
    NoEquilibriumError
        The structure does not stand under its loads before anything moves.

    Examples
    --------
    A flat arch opens by 10 mm at its crown and by 5.3 mm at one springer:

    >>> import concio
    >>> import math
    >>> arch = concio.arch(shape="flat", span=1.2, ring=0.3, voussoirs=6, skew=70, block="rigid", friction=2.0)
    >>> top = (-0.6 - 0.3 / math.tan(math.radians(70)), 0.3)
    >>> cracks = [
    ...     concio.Measurement("crown", "opening", "0.2 mm", "10.1 mm", ("v03", "v04"), at=(0.0, 0.0)),
    ...     concio.Measurement("springer", "opening", "0.2 mm", "5.2 mm", ("left abutment", "v01"), at=top),
    ... ]
    >>> spreads = concio.Candidate("abutment gives way", body="left abutment", direction=(-1, 0), low=0.0)
    >>> found = concio.diagnose(arch, cracks, [spreads], large=False)
    >>> print(found.verdict.status, f"{1e3 * found.best.motion[0]:.1f} mm")
    one_cause 10.0 mm
    """
    begun = clock.perf_counter()
    require_model(model)
    given = tuple(measurements), tuple(candidates)
    _check(model, *given, most, beyond, confidence, steps)
    scale = expected(model, *given)
    moved = moved_model(model, given[1], scale)
    assembly = as_assembly(moved.model)
    found = readings(assembly, given[0])
    low, high, value, error = (
        np.array([getattr(t, key) for t in things])
        for key, things in (("low", given[1]), ("high", given[1]), ("value", given[0]), ("error", given[0]))
    )
    trials: tuple[Trial, ...] = ()
    coarse = changed = np.inf
    number: int | None = STEPS[0] if steps is None else steps
    while number is not None:
        forward = Forward.of(assembly, moved, found, method, number)
        case = _Case(Fitter(forward, value, error, low, high, scale), *given, confidence)
        searched = search(
            case.fitter, [c.mover for c in given[1]], most=most, beyond=beyond, confidence=confidence,
            coarse=trials, change=changed, progress=progress,
        )  # fmt: skip
        trials = searched.trials
        coarse, changed = case.refinement(searched)
        found_any = bool(searched.accepted or searched.spoiled)
        number = None if steps is not None else case.next_steps(searched, coarse, found_any=found_any)
        if not found_any:  # a true cause may be turned down on coarse paths: nothing of them is taken over
            trials, changed = (), np.inf
    fitter = case.fitter
    causes = tuple(case.cause(fit) for fit in searched.accepted)
    doubts = case.doubts(searched)
    nearest = case.nearest(searched) if not causes else None
    best = causes[0] if causes else doubts[0].cause if doubts else nearest
    left = [*causes, *(d.cause for d in doubts if d.cause.left_out)]
    width = float(np.median([m.error for m in given[0] if m.quantity == "motion"] or [scale.min() / LEAST]))
    names = [c.name for c in given[1]]
    additions = additions_of(fitter, causes[0], names, confidence) if causes else ()
    unseen = unseen_of(fitter, best, names) if best is not None else ()
    return Diagnosis(
        model, *given, found, forward, causes, doubts, searched.trials, nearest, unseen,
        case.places(left, unseen, width), case.future(best, large), case.orders(best), coarse, confidence, most,
        clock.perf_counter() - begun, additions,
    )  # fmt: skip


def expected(model: Model, measurements: Sequence[Measurement], candidates: Sequence[Candidate]) -> Array:
    """Return motions (k,) of the size that the measurements let expect [m, rad, or change of a load factor]."""
    half = _size(model, measurements, candidates) / HALF
    sizes = [max(abs(m.value), LEAST * m.error) * (half if m.quantity == "rotation" else 1.0) for m in measurements]
    size = sorted(sizes)[-2]  # the largest may be a mistake
    kinds = {"motion": size, "rotation": size / half, "number": 1.0}
    warmest = {t.group: WARMER / max(abs(t.change), 1.0) for t in model.temperatures}
    sizes = [warmest.get(c.group, kinds[c.quantity]) for c in candidates]
    return np.array([min(own, max(c.high, -c.low)) for own, c in zip(sizes, candidates, strict=True)])


def _size(model: Model, measurements: Sequence[Measurement], candidates: Sequence[Candidate]) -> float:
    """Return the size of the largest structure that anything measured, or anything that may move, belongs to [m]."""
    named = {name for m in measurements for name in (m.body, m.other, *(m.joint or ()))} | {c.body for c in candidates}
    own = [k for k, body in enumerate(model.bodies) if body.name in named]
    return surroundings(model).of(own) if own else model.size


@dataclass(frozen=True, eq=False)
class _Case:
    """What was measured, with its fits."""

    fitter: Fitter
    measurements: tuple[Measurement, ...]
    candidates: tuple[Candidate, ...]
    confidence: float

    def cause(self, fit: Fit) -> Cause:
        """Return a fit as a cause, with intervals."""
        return cause_of(self.fitter, fit, tuple(c.name for c in self.candidates), self.confidence)

    def doubts(self, searched: Found) -> tuple[Doubt, ...]:
        """Return the measurements that simpler causes contradict: where causes remain, those with a mistake to name."""
        forward = self.fitter.forward
        fits = searched.spoiled
        if fits and not searched.accepted:
            fewest = min(len(f.chosen) for f in fits)
            fits = tuple(f for f in fits if len(f.chosen) == fewest)
        told = [
            doubt
            for fit in fits
            for doubt in doubts_of(forward, self.cause(fit), self.measurements, forward.readings)
        ]
        return tuple(d for d in told if not searched.accepted or d.mistake != "unknown")

    def nearest(self, searched: Found) -> Cause | None:
        """Return the fit with the least misfit."""
        fits = [t.fit for t in searched.trials if t.fit is not None]
        return self.cause(min(fits, key=lambda f: f.misfit)) if fits else None

    def places(self, causes: Sequence[Cause], unseen: Sequence[Unseen], width: float) -> tuple[Place, ...]:
        """Return where to measure next: of places that were measured, those that a cause leaves out alone."""
        forward = self.fitter.forward
        out = {i for c in causes for i in c.left_out}
        known = [
            ("slip" if m.kind == "slip" else "opening", r)
            for i, (m, r) in enumerate(zip(self.measurements, forward.readings, strict=True))
            if m.kind in AT_A_JOINT and i not in out
        ]
        rivals: tuple[Prediction, ...] = ()
        if len(causes) == 1:
            names, limit = [c.name for c in self.candidates], allowed(causes[0].freedom, self.confidence)
            rivals = rivals_of(self.fitter, causes[0], unseen, names, max(limit, causes[0].misfit))
        return next_places(forward, causes, width, known=known, rivals=rivals)

    def future(self, best: Cause | None, large: bool) -> Future | None:
        """Return what happens to the structure if the cause goes on."""
        return None if best is None else future_of(self.fitter.forward, best, self.candidates, large=large)

    def orders(self, best: Cause | None) -> float:
        """Return how much the readings change, in errors, where motions come one after the other."""
        if best is None or len(best.chosen) < 2:
            return 0.0
        parts = []
        for c in best.chosen:
            part = np.zeros(len(self.candidates))
            part[c] = best.motions[c]
            parts.append(part)
        ends = [self.fitter.forward.in_order(order) for order in (parts, parts[::-1])]
        changes = [np.abs(e.values - best.predicted) / self.fitter.error for e in ends if e.reached]
        return float(max((c.max() for c in changes), default=np.inf))

    def refinement(self, searched: Found) -> tuple[float, float]:
        """Return how much readings change, in errors, where the paths of the best fits are followed in finer steps.

        The largest change of a reading, and the largest root of the sum of squares of the changes of a fit.
        """
        changes = [self._change(f, 1, FINER) for f in self._best(searched)]
        largest = max((float(c.max()) for c in changes), default=0.0)
        return largest, max((float(np.linalg.norm(c)) for c in changes), default=0.0)

    def next_steps(self, searched: Found, coarse: float, *, found_any: bool) -> int | None:
        """Return the steps with which to search again; None where these were fine enough, or no more are taken.

        Steps that change the best fits by more than an error are passed over where the most steps do so again: paths
        that come to another equilibrium of friction in some of the steps are not nearer in more of them.
        """
        number = self.fitter.forward.steps
        finer = [s for s in STEPS if s > number]
        exact = self.fitter.forward.method == "events"
        enough = coarse <= (CHANGED if number == STEPS[0] else COARSE)
        if exact or not finer or (found_any and enough):
            return None
        last = finer[-1]
        if len(finer) > 1 and coarse > COARSE:
            times = finer[0] // number, last // number
            if any(float(self._change(f, *times).max()) > COARSE for f in self._best(searched)):
                return last
        return finer[0]

    def _best(self, searched: Found) -> list[Fit]:
        """Return the simplest cause and the best fit of every number of motions that is not far off.

        One that is turned down because its path was walked too coarsely is no less a fault than one that is taken.
        """
        near = [t.fit for t in searched.trials if t.fit is not None and t.chosen and not t.coarse]
        tried = [f for f in near if f.misfit <= FAR * allowed(f.freedom, self.confidence)]
        tried = tried or sorted(near, key=lambda f: f.misfit)[:1]
        sizes = {len(f.chosen) for f in tried}
        best = [min((f for f in tried if len(f.chosen) == s), key=lambda f: f.misfit) for s in sorted(sizes)]
        first = [f for f in (*searched.accepted, *searched.spoiled) if f.chosen][:1]
        return list(dict.fromkeys((*first, *best)))

    def _change(self, fit: Fit, times: int, finer: int) -> Array:
        """Return by how much the readings (n,) of a fit differ between two numbers of steps, in errors."""
        fine, less = (self.fitter.forward.refined(fit.motions, n) for n in (finer, times))
        change: Array = np.abs(fine.values - less.values) / self.fitter.error
        return change if fine.reached and less.reached else np.full(len(change), np.inf)


def _check(
    model: Model, measurements: tuple[Measurement, ...], candidates: tuple[Candidate, ...], most: int, beyond: int,
    confidence: float, steps: int | None,
) -> None:  # fmt: skip
    """Refuse what cannot be meant.

    Raises
    ------
    InputError
    """
    for thing, kind, what in ((measurements, Measurement, "measurements"), (candidates, Candidate, "candidates")):
        wrong = next((t for t in thing if not isinstance(t, kind)), None)
        if wrong is not None:
            msg = f"a {kind.__name__} is needed, {type(wrong).__name__} was given"
            raise InputError(msg, where=what, hint=f"concio.{kind.__name__}(...)")
    if len(measurements) < 2:
        msg = f"{len(measurements)} measurement{'s' * (len(measurements) != 1)}: any motion explains it"
        raise InputError(msg, where="measurements", hint="give at least two; joints that are closed count as well")
    if not 0 < confidence < 1:
        msg = f"confidence = {confidence!r} must lie between 0 and 1"
        raise InputError(msg, hint="0.95 is usual")
    for key, value, least in (("most", most, 1), ("beyond", beyond, 0), ("steps", 1 if steps is None else steps, 1)):
        if value < least:
            msg = f"{key} = {value!r} must be at least {least}"
            raise InputError(msg)
