"""What an assessment found: mechanisms with their curves, limits and checks, weakest first."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from concio.analysis.seismic.coverage import Covered
from concio.analysis.seismic.hand_check import HandCheck, hand_check
from concio.analysis.seismic.hand_forces import hand_forces
from concio.analysis.seismic.local_mechanism import LevelOutcome, LocalMechanism, NoMechanism
from concio.analysis.seismic.open_items import OpenItem, open_items
from concio.analysis.seismic.out_of_plane import StripFound
from concio.analysis.seismic.site import Site
from concio.analysis.seismic.strip_ties import StripTie, multiplier_needed, strip_tie
from concio.analysis.seismic.what_if import sensitivity_of_mechanism
from concio.analysis.sensitivity import Sensitivity
from concio.contact.assembly import Assembly
from concio.model.model import Model
from concio.solvers.statics.associated_limit import LimitLoad
from concio.verdict.assessment_notes import assessment_notes
from concio.verdict.assessment_verdict import assessment_verdict
from concio.verdict.question import Acting
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

__all__ = ["Assessment", "LevelOutcome", "LocalMechanism", "NoMechanism"]


@dataclass(frozen=True, eq=False, repr=False)
class Assessment(Shown):
    """What :func:`concio.assess` found.

    Parameters
    ----------
    model : Model
    site : Site
    levels : tuple of str
    mechanisms : tuple of LocalMechanism
        Weakest first: the weakest of all of each push, the named ones, and those of parts that decide something.
    locked : tuple of NoMechanism
        Searches in which no mechanism was found to check, and why.
    knowledge : str
    confidence : float
        FC.
    confidence_by : {"knowledge", "crushing", "given"}
        Where it comes from; "crushing": joints without compressive strength ask for the largest.
    curve : {"followed", "straight"}
        Which capacity curve counts.
    arguments : mapping
        Of the call, for assessing a changed model again.
    others : tuple of LocalMechanism
        Mechanisms of parts of the structure that were followed and decide nothing.
    late : tuple of (str, float)
        Parts that begin to move too late to decide and were not followed, and the height at which they start [m].
    sought : int
        Searches made, over all pushes.
    parts : tuple of str
        Parts that were searched by default.
    places : mapping of str to (int, int)
        For "levels", "openings" (lines of them), "returns" (faces of them) and "changes" (other lines): how many were
        sought at, and how many there are, over all pushes.
    bounds : mapping of str to LimitLoad
        For each push the associated limit over all motions: no multiplier of a collapse lies above it.
    acting : tuple of Acting
        What is multiplied, and what acts as it is.
    covered : tuple of Covered
        What the search covered, kind by kind: places, motions that were met, the least multiplier.
    assembly : Assembly
        One of the model, with what it was found to hold.
    strips : tuple of StripFound
        Of a facade drawn in elevation, its strips out of the plane, the weakest first. The worst mechanism of each
        stands among ``mechanisms``.
    """

    model: Model
    site: Site
    levels: tuple[str, ...]
    mechanisms: tuple[LocalMechanism, ...]
    locked: tuple[NoMechanism, ...]
    knowledge: str
    confidence: float
    confidence_by: str
    curve: str
    arguments: Mapping[str, Any]
    others: tuple[LocalMechanism, ...]
    late: tuple[tuple[str, float], ...]
    sought: int
    parts: tuple[str, ...]
    places: Mapping[str, tuple[int, int]]
    bounds: Mapping[str, LimitLoad]
    acting: tuple[Acting, ...]
    covered: tuple[Covered, ...]
    assembly: Assembly
    strips: tuple[StripFound, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """What asks for attention in the numbers of the site and in the decisions of the author."""
        return assessment_notes(self)

    @property
    def worst(self) -> LocalMechanism | None:
        """The weakest mechanism; None where none was found."""
        return self.mechanisms[0] if self.mechanisms else None

    @property
    def zeta(self) -> float:
        """The least zeta_E at the ultimate limit states asked for; ``inf`` where there is no mechanism."""
        return self.worst.zeta if self.worst is not None else math.inf

    @property
    def least(self) -> float:
        """The least zeta_E at all limit states asked for, those of serviceability included."""
        return min((m.least for m in self.mechanisms), default=math.inf)

    @cached_property
    def hand_checks(self) -> tuple[HandCheck, ...]:
        """For each mechanism alpha_0 once more, by virtual work from the coordinates of the model."""
        forces = hand_forces(self.model)
        return tuple(
            hand_check(m, self.model, self.arguments.get("live"), forces) if m.section is None
            else hand_check(m, m.section, None, hand_forces(m.section)) for m in self.mechanisms
        )  # fmt: skip

    def sensitivity(self, mechanism: LocalMechanism | None = None) -> Sensitivity | None:
        """Return the derivative of alpha_0 with respect to every number of the model, by duality.

        Parameters
        ----------
        mechanism : LocalMechanism, optional
            By default the weakest.

        Returns
        -------
        Sensitivity or None
            None where a joint slides in the mechanism: alpha_0 is not an optimum then, and duality says nothing.
        """
        m = self.worst if mechanism is None else mechanism
        return None if m is None else sensitivity_of_mechanism(m.section or self.model, m, self.arguments.get("live"))

    @cached_property
    def strip_ties(self) -> tuple[StripTie, ...]:
        """For each strip of a facade in elevation that needs one, the least force of a tie, and its height.

        With it no mechanism of the strip begins to move outwards below the demands of the linear checks.
        """
        asked = [(s.strip, multiplier_needed(self.site, self.levels, s.strip, self.confidence, self.arguments.get("q")))
                 for s in self.strips if not s.like]  # fmt: skip
        found = [strip_tie(strip, target) for strip, target in asked if target > 0]
        return tuple(tie for tie in found if tie.force > 0)

    @cached_property
    def open(self) -> tuple[OpenItem, ...]:
        """What was asked for, or is to be expected, and was not checked."""
        return open_items(self)

    @property
    def complete(self) -> bool:
        """Whether nothing that was asked for, or is to be expected, was left unchecked."""
        return not self.open

    @property
    def holds(self) -> bool:
        """Whether every mechanism can take every limit state; false where something was not checked."""
        return self.least >= 1.0 and self.complete

    @property
    def verdict(self) -> Verdict:
        """Question, answer, proof, limits, and what was not checked."""
        return assessment_verdict(self)

    def report(self, path: str | os.PathLike[str], *, language: str = "en", **options: Any) -> Path:
        """Write the report, one HTML file that prints to a clean PDF, or a docx file where the name ends so.

        Parameters
        ----------
        path : str or Path
        language : {"en", "it"}
        **options
            ``head``, ``tie``, ``anchors``, ``varied``, ``sensitivity`` of
            :class:`concio.report.assessment_page.AssessmentReport`.

        Returns
        -------
        Path
            ``path``.
        """
        written: Path = view(self, "report", Path(path), language=language, **options)
        return written

    def __repr__(self) -> str:
        lines = [f"<Assessment: {len(self.mechanisms)} mechanisms, {self.verdict.outcome.value}"]
        return "\n  ".join([*lines, *(repr(m) for m in self.mechanisms)]) + ">"

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        return {
            "code": self.site.rules.name,
            "levels": list(self.levels),
            "knowledge": self.knowledge,
            "confidence_factor": self.confidence,
            "confidence_by": self.confidence_by,
            "curve": self.curve,
            "zeta_E": _number(self.zeta),
            "zeta_E_of": self.worst.decisive.level if self.worst is not None and self.worst.decisive else None,
            "least_zeta_E": _number(self.least),
            "holds": self.holds,
            "complete": self.complete,
            "engine": self.model.engine,
            "mechanisms": [m.summary() for m in self.mechanisms],
            "no_mechanism": [
                {"name": n.name, "direction": n.direction, "multiplier": _number(n.multiplier), "why": n.sentence}
                for n in self.locked
            ],
            "sought": self.sought,
            "parts": list(self.parts),
            "sought_at": {kind: {"sought": a, "there": b} for kind, (a, b) in self.places.items()},
            "covered": [
                {"kind": c.kind, "there": c.there, "sought": c.sought, "searches": c.searches,
                 "least_multiplier": _number(c.multiplier), "motions": list(c.motions)} for c in self.covered
            ],
            "strips": [
                {"name": s.strip.name, "kind": s.strip.kind, "sides": list(s.strip.sides), "base": s.strip.base,
                 "least_multiplier": _number(s.multiplier), "zeta_E": _number(s.zeta), "least_zeta_E": _number(s.least),
                 "same_numbers_as": s.like or None, "followed": s.followed} for s in self.strips
            ],
            "followed_beside": [m.summary() for m in self.others],
            "upper_bounds": {way: _number(bound.upper) for way, bound in self.bounds.items()},
            "attention": list(self.verdict.attention),
            "verdict": self.verdict.as_dict(),
        }  # fmt: skip


def _number(value: float) -> float | None:
    """Return a number, or None for what is none."""
    return value if math.isfinite(value) else None
