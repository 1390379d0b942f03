"""What an assessment found: mechanisms with their curves, limits and checks, weakest first."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.seismic.chain import Chain
from concio.analysis.seismic.checks import Check, Displacement, return_period
from concio.analysis.seismic.curve import CapacityCurve
from concio.analysis.seismic.free_standing import ElasticBranch
from concio.analysis.seismic.linkage import Force, Linkage
from concio.analysis.seismic.macro_blocks import Mechanics, carried
from concio.analysis.seismic.mechanism import LARGEST, Found
from concio.analysis.seismic.sequence import Sequence
from concio.analysis.seismic.site import Hazard, Site
from concio.contact.assembly import Assembly
from concio.kinematics.rigid import motions
from concio.model.model import Model

Array = np.ndarray

PARALLEL = 1e-3
"""Velocities out of a plane below this share of the others are none."""


@dataclass(frozen=True)
class LevelOutcome:
    """What a mechanism can take at one limit state.

    Parameters
    ----------
    level : str
    a_g : float
        Acceleration on rock at which demand meets capacity [g]; ``inf`` where none does.
    zeta : float
        That over the acceleration of the site.
    T_R : float
        Its return period [years]; ``nan`` where the hazards known do not tell.
    check : Check
        The one that decides.
    """

    level: str
    a_g: float
    zeta: float
    T_R: float
    check: Check

    @property
    def holds(self) -> bool:
        """Whether the site's acceleration is not larger."""
        return self.zeta >= 1.0


@dataclass(frozen=True, eq=False, repr=False)
class LocalMechanism:
    """One mechanism, examined.

    Parameters
    ----------
    name : str
        As it was asked for.
    direction : str
        Which way the earthquake pushes.
    found : Found
        Multiplier with its proof.
    assembly : Assembly
        With the loads of the earthquake.
    linkage : Linkage or Sequence
        Macro-blocks, joints, forces and control point.
    chain : Chain
        The forces of the earthquake.
    dead : tuple of (str, Force)
        All other forces on the macro-blocks.
    control : (body, point)
    level : float
        Height at which it starts, above the base of the building [m].
    multiplier : float
        alpha_0.
    confidence : float
        FC.
    factor : float
        Spectral acceleration over alpha: g / (e* FC) [m/s2].
    followed : CapacityCurve
    straight : CapacityCurve or None
        None where alpha does not vanish on the followed curve.
    limits : dict of str to Displacement
        By limit state.
    checks : tuple of Check
    periods : dict of str to Hazard
        By limit state.
    site : Site
    velocity : (3 G,) or (6 G,) array
        Motion of the macro-blocks, for a control point that moves by one.
    branch : ElasticBranch or None
        Of an element that is free to vibrate.
    """

    name: str
    direction: str
    found: Found
    assembly: Assembly
    linkage: Linkage | Sequence
    chain: Chain
    dead: tuple[tuple[str, Force], ...]
    control: tuple[str, tuple[float, ...]]
    level: float
    multiplier: float
    confidence: float
    factor: float
    followed: CapacityCurve
    straight: CapacityCurve | None
    limits: Mapping[str, Displacement]
    checks: tuple[Check, ...]
    periods: Mapping[str, Hazard]
    site: Site
    velocity: Array = field(repr=False)
    branch: ElasticBranch | None = None

    @property
    def mechanics(self) -> Mechanics:
        """Macro-blocks and joints."""
        return self.linkage.mechanics

    def velocity_at(self, block: int, points: Array) -> Array:
        """Return the velocity (..., d) of points (..., d) of a macro-block, for a control point that moves by one."""
        d = points.shape[-1]
        motion = self.velocity.reshape(len(self.mechanics.blocks), motions(d))[block]
        return carried(motion, points - self.mechanics.blocks[block].centre)

    @property
    def in_one_plane(self) -> bool:
        """Whether all its points move parallel to one plane, as the code's method supposes."""
        bodies = self.assembly.model.bodies
        moved = [self.velocity_at(g, np.asarray(bodies[b].vertices)) for b, g in self.mechanics.of_body.items()]
        sizes = np.linalg.svd(np.vstack(moved), compute_uv=False)
        return len(sizes) < 3 or bool(sizes[2] <= PARALLEL * sizes[0])

    @property
    def e_star(self) -> float:
        """Share of the mass that takes part."""
        return self.chain.e_star

    @property
    def onset(self) -> float:
        """a_0* [m/s2]."""
        return self.multiplier * self.factor

    @property
    def d0(self) -> float:
        """Spectral displacement at which the multiplier vanishes [m]; ``nan`` where it does not."""
        return self.chain.spectral * self.followed.end

    def spectral_curve(self, curve: CapacityCurve) -> tuple[Array, Array]:
        """Return spectral displacements [m] and accelerations [m/s2] of a capacity curve, (n,) each."""
        return self.chain.spectral * curve.displacement, self.factor * curve.multiplier

    def outcome(self, level: str) -> LevelOutcome:
        """Return what the mechanism can take at a limit state, over all places where it is checked.

        Of a limit state of displacement the check in displacements decides where there is one, but its acceleration is
        never less than that of the onset.
        """
        own = [c for c in self.checks if c.level == level]
        decisive = [c for c in own if c.kind == "displacement"] or own
        best: list[tuple[float, Check]] = []
        for check in decisive:
            best.append((max(check.a_g, check.least), check))
        a_g, check = min(best, key=lambda pair: pair[0])
        zeta = a_g / self.periods[level].a_g
        return LevelOutcome(level, a_g, zeta, return_period(self.site, a_g), check)

    @property
    def outcomes(self) -> tuple[LevelOutcome, ...]:
        """What it can take at each limit state."""
        return tuple(self.outcome(level) for level in self.periods if any(c.level == level for c in self.checks))

    @property
    def unchecked(self) -> tuple[str, ...]:
        """Limit states that could not be checked: without a curve that ends there is no check in displacements."""
        return tuple(level for level in self.periods if not any(c.level == level for c in self.checks))

    @property
    def complete(self) -> bool:
        """Whether every limit state was checked, with a multiplier that is no mere upper bound."""
        return not self.unchecked and self.found.flow != "associated"

    @property
    def zeta(self) -> float:
        """The least zeta_E of all limit states."""
        return min((o.zeta for o in self.outcomes), default=math.inf)

    def __repr__(self) -> str:
        zeta = f"zeta_E {self.zeta:.4g}" if math.isfinite(self.zeta) else "no check"
        return f"<LocalMechanism '{self.name}', push {self.direction}: alpha_0 {self.multiplier:.6g}, {zeta}>"

    def summary(self) -> dict[str, Any]:
        """Return its numbers."""
        return {
            "name": self.name,
            "direction": self.direction,
            "bodies": [list(b.names) for b in self.mechanics.blocks],
            "alpha0": self.multiplier,
            "associated_multiplier": self.found.associated.multiplier,
            "flow": self.found.flow,
            "unchecked": list(self.unchecked),
            "e_star": self.e_star,
            "a0_star": self.onset,
            "control_body": self.control[0],
            "control_point": list(self.control[1]),
            "level": self.level,
            "in_one_plane": self.in_one_plane,
            "d_C0": _number(self.followed.end),
            "d0": _number(self.d0),
            "curve_ends": self.followed.reason,
            "elastic_branch": None if self.branch is None else self.branch.summary(),
            "limits": {
                level: {"d": v.d, "a": v.a, "T": _number(v.T), "set_by": v.why} for level, v in self.limits.items()
            },
            "checks": [
                {
                    "level": c.level, "kind": c.kind, "place": c.place, "capacity": c.capacity, "demand": c.demand,
                    "unit": c.unit, "ratio": _number(c.ratio), "holds": c.holds, "a_g": _number(c.a_g),
                    "zeta": _number(c.zeta), "clause": c.clause,
                }
                for c in self.checks
            ],
            "outcomes": {
                o.level: {"a_g": _number(o.a_g), "zeta_E": _number(o.zeta), "T_R": _number(o.T_R)}
                for o in self.outcomes
            },
        }  # fmt: skip


@dataclass(frozen=True)
class NoMechanism:
    """A search that gave no mechanism to check.

    Parameters
    ----------
    name : str
    direction : str
    multiplier : float
        The least one; ``inf`` where any push is carried.
    """

    name: str
    direction: str
    multiplier: float

    @property
    def sentence(self) -> str:
        """Why."""
        if math.isinf(self.multiplier):
            return "locked: friction and geometry carry any push, so that no mechanism forms"
        return f"no mechanism below {LARGEST:g} g: the least multiplier is {self.multiplier:.4g}"


@dataclass(frozen=True, eq=False, repr=False)
class Assessment:
    """What :func:`concio.assess` found.

    Parameters
    ----------
    model : Model
    site : Site
    levels : tuple of str
    mechanisms : tuple of LocalMechanism
        Weakest first.
    locked : tuple of NoMechanism
        Searches in which no mechanism was found to check, and why.
    knowledge : str
    confidence : float
        FC.
    confidence_by : {"knowledge", "crushing", "given"}
        Where it comes from; "crushing": joints without compressive strength ask for the largest.
    curve : {"followed", "straight"}
        Which capacity curve counts.
    notes : tuple of str
        What asks for attention.
    arguments : mapping
        Of the call, for assessing a changed model again.
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
    notes: tuple[str, ...]
    arguments: Mapping[str, Any]

    @property
    def worst(self) -> LocalMechanism | None:
        """The weakest mechanism; None where none was found."""
        return self.mechanisms[0] if self.mechanisms else None

    @property
    def zeta(self) -> float:
        """The least zeta_E; ``inf`` where there is no mechanism."""
        return self.worst.zeta if self.worst is not None else math.inf

    @property
    def complete(self) -> bool:
        """Whether every limit state of every mechanism was checked, with multipliers that are no mere upper bounds."""
        return all(m.complete for m in self.mechanisms)

    @property
    def holds(self) -> bool:
        """Whether every mechanism can take every limit state; false where one could not be checked."""
        return self.zeta >= 1.0 and self.complete

    def report(self, path: str | os.PathLike[str], *, language: str = "en", **options: Any) -> Path:
        """Write the report, one HTML file that prints to a clean PDF.

        Parameters
        ----------
        path : str or Path
        language : {"en", "it"}
        **options
            ``head``, ``tie``, ``anchors``, ``varied`` of :class:`concio.report.assessment_page.AssessmentReport`.

        Returns
        -------
        Path
            ``path``.
        """
        from concio.report.assessment_page import write_assessment_report

        return write_assessment_report(self, Path(path), language=language, **options)

    def __repr__(self) -> str:
        word = "every limit state is met" if self.holds else "not every limit state is met, or could be checked"
        lines = [f"<Assessment: {len(self.mechanisms)} mechanisms, {word}"]
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
            "holds": self.holds,
            "complete": self.complete,
            "engine": self.model.engine,
            "mechanisms": [m.summary() for m in self.mechanisms],
            "no_mechanism": [{"name": n.name, "direction": n.direction, "why": n.sentence} for n in self.locked],
            "attention": list(self.notes),
        }


def _number(value: float) -> float | None:
    """Return a number, or None for what is none."""
    return value if math.isfinite(value) else None
