r"""The least force of a tie that holds a strip of a facade out of its plane, and the height at which it is least.

The tie pulls the strip inwards at one height, with at most its yield force F. That the strip carries a multiplier
:math:`\alpha` of its weight outwards is a linear programme in F: by virtual work every motion v of its courses asks for

.. math:: F \ge \frac{\alpha\, g^T v + f^T v}{v_F},

f being what is dead, g the push and v_F how fast the motion lengthens the tie; the largest of these over all motions is
the least force (:mod:`concio.analysis.least_strengthening`). The multiplier that is asked for is that with which no
mechanism begins to move below the demands of the linear checks, at the ground and at the top, e* being one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.least_strengthening import least_strengthening
from concio.analysis.seismic.directions import pushes
from concio.analysis.seismic.sections import Strip
from concio.analysis.seismic.site import Site
from concio.analysis.seismic.weakest_mechanism import Mechanisms
from concio.contact.assembly import assemble
from concio.errors import InputError
from concio.model.actions import Tie
from concio.model.model import Model
from concio.solvers.statics.associated_limit import associated_limit

ROD = "tie"
"""Name of the tie in a section."""

NEAR = 1e-9
"""Distances below this share of the size of a section are none."""

ENDLESS = 1e3
"""Times the weight of a strip: a tie that yields there never does."""

SAME = 1e-9
"""Relative difference up to which a multiplier reaches another."""


@dataclass(frozen=True, eq=False)
class StripTie:
    """The least force of a tie of a strip.

    Parameters
    ----------
    strip : Strip
    target : float
        Multiplier that is asked for.
    force : float
        On the width of the strip [kN]; zero where none is needed, ``inf`` where none does at any height.
    height : float
        Where that is least [m].
    by_height : mapping of float to float
        The least force at each height that was examined [kN].
    before : float
        Multiplier without a tie, pushed outwards.
    reached : float
        With the force: below the target only where joints slide, which Coulomb friction holds less than the programme.

    Examples
    --------
    That of a strip is found by :func:`strip_tie`; here one of 2 m that needs 9 kN:

    >>> from types import SimpleNamespace
    >>> from concio.seismic import StripTie
    >>> strip = SimpleNamespace(sides=(0.0, 2.0))
    >>> tie = StripTie(strip, target=0.2, force=9.0, height=4.0, by_height={4.0: 9.0}, before=0.1, reached=0.2)
    >>> tie.per_metre, tie.holds
    (4.5, True)
    """

    strip: Strip
    target: float
    force: float
    height: float
    by_height: Mapping[float, float]
    before: float
    reached: float

    @property
    def per_metre(self) -> float:
        """Force on a metre of facade [kN/m]."""
        return self.force / (self.strip.sides[1] - self.strip.sides[0])

    @property
    def holds(self) -> bool:
        """Whether the force reaches the target with Coulomb friction too."""
        return math.isfinite(self.force) and self.reached >= self.target * (1.0 - SAME)


def strip_tie(strip: Strip, target: float, heights: Sequence[float] | None = None) -> StripTie:
    """Return the least force of a tie with which a strip carries a multiplier outwards.

    Parameters
    ----------
    strip : Strip
    target : float
    heights : sequence of float, optional
        At which the tie could be [m]; by default the upper edges of all courses.

    Raises
    ------
    InputError
        The tie meets no course at a height.

    Examples
    --------
    A wall of 4 m that is 0.5 m thick overturns at 0.125. A tie at its head is to bring that to 0.25: the moment that is
    missing, 0.125 times the weight of 228 kN at half of the height, needs 14.25 kN there:

    >>> import numpy as np
    >>> import concio
    >>> from concio.analysis.seismic.sections import OutOfPlane, strips_of
    >>> from concio.analysis.seismic.strip_ties import strip_tie
    >>> ground = concio.Body("ground", np.array([[-1, -1], [7, -1], [7, 0], [-1, 0.0]]), kind="fixed")
    >>> wall = concio.Body("wall", np.array([[0, 0], [6, 0], [6, 4], [0, 4.0]]), kind="rigid", thickness=0.5)
    >>> facade = concio.Model((ground, wall), {"block": concio.Rigid(unit_weight=19)},
    ...                       {"joint": concio.JointLaw(friction=0.6)}, loads=(concio.Load("weight", (0, -1)),))
    >>> (strip,) = strips_of(facade, OutOfPlane(), [[1]])
    >>> found = strip_tie(strip, 0.25)
    >>> round(found.force, 6), found.height, found.holds
    (14.25, 4.0, True)
    """
    (push,) = pushes(strip.section, "left", ())
    tops = [float(b.vertices[:, 1].max()) for b in strip.section.free_bodies]
    total = sum(push.model.materials[b.material].unit_weight * b.volume for b in push.model.free_bodies)
    total += sum(abs(load.value[1]) for load in push.model.loads if load.at is not None)
    found: dict[float, float] = {}
    for height in sorted(tops if heights is None else {float(h) for h in heights}, reverse=True):
        held = with_tie(push.model, height)
        if _associated(held, push.groups, ENDLESS * total) < target:  # no force at that height is enough
            found[height] = math.inf
            continue
        found[height] = least_strengthening(assemble(held), push.groups, target, "tie", ROD).amount
    best = min(found, key=lambda h: found[h])
    force, forces = found[best], dict(sorted(found.items()))
    before = _associated(push.model, push.groups, 0.0)
    needed = 0.0 < force < math.inf
    reached = carried_with(with_tie(push.model, best), push.groups, force) if needed else before
    return StripTie(strip, target, force, best, forces, before, reached)


def with_tie(section: Model, height: float) -> Model:
    """Return a section with a tie from the middle of a course to a fixed point far inside, of a force of one.

    At the upper edge of a course it is on that course.

    Raises
    ------
    InputError
        There is no course at that height.
    """
    near = NEAR * section.size
    own = [b for b in section.free_bodies if b.vertices[:, 1].min() + near < height <= b.vertices[:, 1].max() + near]
    if not own:
        msg = f"a tie at {height:g} m meets no course of the strip"
        raise InputError(msg, hint="heights are those of the drawing")
    body = own[0]
    x = float(np.mean([body.vertices[:, 0].min(), body.vertices[:, 0].max()]))
    far = x + 10.0 * section.size
    return replace(section, ties=(Tie(ROD, body.name, (x, height), "", (far, height), stiffness=1.0, yield_force=1.0),))


def carried_with(model: Model, groups: tuple[str, ...], force: float) -> float:
    """Return the least multiplier that is met with a yield force of the tie [kN], of Coulomb friction."""
    held = replace(model, ties=tuple(replace(tie, yield_force=force) for tie in model.ties))
    return Mechanisms(assemble(held), groups, 1.0).find().multiplier


def _associated(model: Model, groups: tuple[str, ...], force: float) -> float:
    """Return the associated multiplier with a yield force of the tie [kN]; -inf where there is none."""
    assembly = assemble(replace(model, ties=tuple(replace(tie, yield_force=force) for tie in model.ties)))
    dead = assembly.problem(dict.fromkeys(groups, 0.0))
    live = assembly.problem(dict.fromkeys(groups, 1.0), like=dead).f - dead.f
    found = associated_limit(dead, live).multiplier
    return -math.inf if math.isnan(found) else found


def multiplier_needed(
    site: Site, levels: Sequence[str], strip: Strip, confidence: float, q: float | None = None
) -> float:
    """Return the multiplier with which no mechanism of a strip begins to move below the demand of a linear check.

    That of the limit states that have one, or that ask for the onset; zero where none does. The participating mass is
    all of it and the height that of the top, which are on the safe side.

    Parameters
    ----------
    site : Site
    levels : sequence of str
    strip : Strip
    confidence : float
        FC.
    q : float, optional
        Behaviour factor; by default that of the code.
    """
    base = min((b.base for b in site.building if hasattr(b, "base")), default=0.0)
    top = max(float(b.vertices[:, 1].max()) for b in strip.section.free_bodies) - base
    most = 0.0
    for level in levels:
        rule = site.rules.tables["levels"][level]
        if rule["kind"] != "onset" and "q" not in rule:
            continue
        factor = 1.0 if "q" not in rule else float(rule["q"]) if q is None else q
        ground = site.spectrum(site.at(level))
        high = site.at_height(ground, top)
        felt = [float(s.acceleration(0.0, 5.0)) for s in (ground, high) if s is not None]
        most = max(most, max(felt) / factor)
    return most * confidence / site.rules.gravity
