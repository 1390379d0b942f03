"""One mechanism of an assessment with its curve, limits and checks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from concio.analysis.seismic.checks import Check, Displacement, return_period
from concio.analysis.seismic.curve import CapacityCurve
from concio.analysis.seismic.free_standing import ElasticBranch
from concio.analysis.seismic.linkage import Force, Linkage
from concio.analysis.seismic.macro_blocks import Mechanics, carried
from concio.analysis.seismic.participation import Chain
from concio.analysis.seismic.sequence import Sequence
from concio.analysis.seismic.site import Hazard, Site
from concio.analysis.seismic.weakest_mechanism import Found
from concio.contact.assembly import Assembly
from concio.kinematics.rigid import motions
from concio.model.model import Model
from concio.verdict.assessment_verdict import none_sentence

Array = np.ndarray

ABOVE = 1e-6
"""Mechanisms that start higher than this are above the ground [m]."""

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
        Its return period [years]; ``nan`` where it cannot be computed from the hazards known.
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
    accept_linear : bool
        Whether the linear check decides a limit state where it is met at every place and gives the larger zeta_E.
    q : float or None
        Behaviour factor of the linear check, where it is not that of the code.
    e_star : float
        Share of the mass that takes part: that of the chain, or what the author has decided.
    section : Model or None
        Of a strip out of the plane of a facade, the model of its section; None for mechanisms of the model itself.
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
    accept_linear: bool = False
    q: float | None = None
    e_star: float = math.nan
    section: Model | None = None

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
        never less than that of the onset. A linear check that is met decides only where the author accepts it.
        """
        own = [c for c in self.checks if c.level == level]
        a_g, check = _least_of([c for c in own if c.kind == "displacement"] or own)
        linear = self._accepted(level)
        if linear:
            a_g, check = max((a_g, check), _least_of(linear), key=lambda pair: pair[0])
        zeta = a_g / self.periods[level].a_g
        return LevelOutcome(level, a_g, zeta, return_period(self.site, a_g), check)

    def _accepted(self, level: str) -> list[Check]:
        """Return the linear checks of a limit state that decide it: all are met, and the author accepts them."""
        linear = [c for c in self.checks if c.level == level and c.kind == "linear"]
        return linear if self.accept_linear and all(c.holds for c in linear) else []

    def decided_by(self, check: Check) -> bool:
        """Return whether a check may decide its limit state: a linear one does not beside one in displacements."""
        if check in self._accepted(check.level):
            return True
        own = [c for c in self.checks if c.level == check.level]
        return check.kind == "displacement" or not any(c.kind == "displacement" for c in own)

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
        """Whether every limit state was checked, with a multiplier that is not a mere upper bound."""
        return not self.unchecked and self.found.flow != "associated"

    @property
    def at_its_height(self) -> bool:
        """Whether the checks count where it starts: on the ground, or as the building amplifies the motion there."""
        return bool(self.site.building) or self.level <= ABOVE

    def zeta_at(self, level: str) -> float:
        """Return zeta_E at a limit state; ``inf`` where it could not be checked."""
        return self.outcome(level).zeta if any(c.level == level for c in self.checks) else math.inf

    @property
    def zeta(self) -> float:
        """The least zeta_E of the ultimate limit states asked for, or of all where there is none among them."""
        ultimate = self.site.ultimate(tuple(self.periods))
        return min((self.zeta_at(level) for level in ultimate), default=math.inf)

    @property
    def least(self) -> float:
        """The least zeta_E of all limit states, those of serviceability included."""
        return min((o.zeta for o in self.outcomes), default=math.inf)

    @property
    def decisive(self) -> LevelOutcome | None:
        """Outcome at the ultimate limit state whose zeta_E is least; None where none could be checked."""
        ultimate = self.site.ultimate(tuple(self.periods))
        return min((o for o in self.outcomes if o.level in ultimate), key=lambda o: o.zeta, default=None)

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
            "at_its_height": self.at_its_height,
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
                    "unit": c.unit, "ratio": _number(c.ratio), "holds": c.holds, "at_rest": c.at_rest,
                    "a_g": _number(c.a_g), "zeta": _number(c.zeta), "clause": c.clause,
                }
                for c in self.checks
            ],
            "outcomes": {
                o.level: {"a_g": _number(o.a_g), "zeta_E": _number(o.zeta), "T_R": _number(o.T_R)}
                for o in self.outcomes
            },
        }  # fmt: skip


def _least_of(checks: list[Check]) -> tuple[float, Check]:
    """Return the acceleration that is reached first, and the check that it is of."""
    return min(((max(c.a_g, c.least), c) for c in checks), key=lambda pair: pair[0])


@dataclass(frozen=True)
class NoMechanism:
    """A search that gave no mechanism to check.

    Parameters
    ----------
    name : str
    direction : str
    multiplier : float
        The least one; ``inf`` where no push is the last.
    doubtful : bool
        Whether Coulomb friction may hold less: what was found stands on joints that open as they slide.
    """

    name: str
    direction: str
    multiplier: float
    doubtful: bool = False

    @property
    def sentence(self) -> str:
        """Why."""
        return none_sentence(self)


def _number(value: float) -> float | None:
    """Return a number, or None for what is none."""
    return value if math.isfinite(value) else None
