"""The least strengthening that brings zeta_E of an assessment to a value: a tie, mass, a buttress, a grouted zone.

zeta_E follows from curves and spectra and is not a linear programme of any of them (for an associated multiplier,
which is one, ``least`` of a limit result proves its answer). So amounts are tried from below, and each trial is a
whole assessment: all mechanisms are sought, followed and checked again. What comes out is a bracket of two certified
assessments, one that does not reach the value and one that does; amounts far below the first were examined only where
they were tried.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from scipy.optimize import brentq

from concio.analysis.entry_point import entry_point
from concio.analysis.seismic.assess import assess
from concio.analysis.seismic.assessment import Assessment
from concio.analysis.seismic.buttress import SIDES, buttress_box, with_buttress
from concio.analysis.seismic.weakest_mechanism import chosen_bodies
from concio.analysis.tie_places import tie_at_height
from concio.arguments import closest, strict
from concio.display import number
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Model
from concio.model.rules import JointRule

KINDS = {"tie": "kN", "mass": "kN", "buttress": "m", "grout": "kN/m2"}
"""Kinds of strengthening with the unit of their amount: yield force, weight, width, cohesion."""

ENOUGH = 1e-4
"""Relative accuracy of an amount."""

SHARES_OF_LARGEST = (1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 1.0)
"""Shares of the largest amount that are tried one after the other, until one does."""

STRONGEST_GROUT = 500.0
"""Largest cohesion of a grouted zone that is tried by default [kN/m2]."""

UNIT_WEIGHT = 20.0
"""Of a buttress that states none [kN/m3]."""


@dataclass(frozen=True)
class Measure:
    """What is strengthened, and how.

    Parameters
    ----------
    kind : {"tie", "mass", "buttress", "grout"}
        "tie": the yield force of a tie of the model [kN]; "mass": weight on bodies, which pushes as well [kN];
        "buttress": the width of a block against a face [m]; "grout": cohesion in the joints of a zone
        [kN/m2], which holds what slides: joints have no tensile strength in an assessment.
    of : tuple of str
        The name of the tie; for the other kinds bodies by name, role, layer or pattern.
    side : {"left", "right", "-x", "+x", "-y", "+y"}
        Of a buttress: at which side of these bodies it stands; in space "left" is -x.
    height : float, optional
        Of a buttress, from the foot of these bodies [m]; by default all of theirs.
    unit_weight : float
        Of a buttress [kN/m3].
    heights : tuple of float
        Of a tie: heights at which it could be, the one where it needs the least force is found [m]; none for its own.

    Examples
    --------
    >>> from concio.seismic import Measure
    >>> Measure("mass", ("c6",)).unit
    'kN'
    """

    kind: str
    of: tuple[str, ...]
    side: str = "left"
    height: float | None = None
    unit_weight: float = UNIT_WEIGHT
    heights: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            msg = f"there is no strengthening '{self.kind}'"
            raise InputError(msg, hint=closest(self.kind, tuple(KINDS)))
        object.__setattr__(self, "of", tuple(self.of))
        object.__setattr__(self, "heights", tuple(dict.fromkeys(float(h) for h in self.heights)))
        if self.heights and self.kind != "tie":
            msg = f"a {self.kind} has no heights to choose from"
            raise InputError(msg, hint="heights are those of a tie")
        own = [("side", self.side != "left"), ("height", self.height is not None),
               ("unit_weight", self.unit_weight != UNIT_WEIGHT)]  # fmt: skip
        idle = [name for name, given in own if given and self.kind != "buttress"]
        if idle:
            msg = f"a {self.kind} has no {idle[0]}"
            raise InputError(msg, hint=f"{idle[0]} is that of a buttress: leave it out")
        for name, value in (("height", self.height), ("unit_weight", self.unit_weight)):
            if value is not None and not 0 < value < math.inf:
                msg = f"{name} = {value:g} of a buttress must be positive and finite"
                raise InputError(msg)
        if self.side not in SIDES:
            msg = f"a buttress has no side '{self.side}'"
            raise InputError(msg, hint=closest(self.side, tuple(SIDES)))
        if not self.of or (self.kind == "tie" and len(self.of) != 1):
            msg = "a strengthening says what it is of: one tie, or bodies"
            raise InputError(msg, hint='for example of = ["t1"]')

    @property
    def unit(self) -> str:
        """Of its amount."""
        return KINDS[self.kind]

    def applied(self, model: Model, amount: float) -> Model:
        """Return a model with this much of it; as it is for an amount of zero.

        Parameters
        ----------
        model : Model
        amount : float

        Raises
        ------
        InputError
            The model has no such tie or bodies, or no ground for a buttress.
        """
        return APPLIED[self.kind](self, model, amount)

    def most(self, model: Model) -> float:
        """Return the largest amount that is tried by default: the weight of the model, the height, a strong grout."""
        if self.kind in ("tie", "mass"):
            return sum(model.materials[b.material].unit_weight * b.volume for b in model.free_bodies)
        if self.kind == "grout":
            return STRONGEST_GROUT
        low, high = buttress_box(model, chosen_bodies(model, "buttress", self.of), self.side, self.height, 0.0)
        return float(high[-1] - low[-1])


@dataclass(frozen=True, eq=False)
class Strengthened:
    """The least amount of a strengthening for a value of zeta_E.

    Parameters
    ----------
    measure : Measure
    wanted : float
        zeta_E.
    amount : float
        In the unit of the measure; zero where none is needed, ``inf`` where none that was tried does.
    fails_at : float
        Largest smaller amount that was assessed and does not reach it; ``nan`` where none is needed.
    reached : float
        Least zeta_E of all limit states with the amount, or the best that was met.
    largest : float
        Largest amount that was tried.
    before : Assessment or None
        Without it; None where the model does not stand so.
    after : Assessment
        With the amount, or the best that was met.
    trials : mapping of float to float
        zeta_E by the amounts that were assessed; ``nan`` where the model does not stand.
    height : float
        Of a tie that was looked for at several heights, the one at which it needs least [m]; else ``nan``.
    by_height : mapping of float to float
        The force at each of these heights [kN]; ``inf`` where a tie there needs more than at one before it, or no force
        does.
    """

    measure: Measure
    wanted: float
    amount: float
    fails_at: float
    reached: float
    largest: float
    before: Assessment | None
    after: Assessment
    trials: Mapping[float, float] = field(default_factory=dict)
    height: float = math.nan
    by_height: Mapping[float, float] = field(default_factory=dict)

    @property
    def sentence(self) -> str:
        """What was found, in a sentence."""
        what = f"{self.measure.kind} of {', '.join(self.measure.of)}"
        what += f" at z = {number(self.height, 4)} m" if self.by_height else ""
        if self.amount == 0:
            return f"{what}: not needed, zeta_E is {number(self.reached, 4)} without it"
        unit = self.measure.unit
        if math.isinf(self.amount):
            return f"{what}: no amount up to {number(self.largest, 4)} {unit} does: zeta_E {number(self.reached, 4)}"
        return (
            f"{what}: {number(self.amount, 5)} {unit} bring zeta_E to {number(self.reached, 4)}, "
            f"{number(self.fails_at, 5)} {unit} do not"
        )


@strict
@entry_point
def strengthen(
    model: Model, measure: Measure, *, zeta: float = 1.0, largest: float | None = None, **arguments: Any
) -> Strengthened:
    """Return the least amount of a strengthening that brings the least zeta_E of all mechanisms to ``zeta``.

    It is the least over all limit states asked for. Every trial searches the mechanisms again, since the weakest one
    changes. More of a strengthening may also be worse: amounts are tried from below, and the first bracket counts.

    Parameters
    ----------
    model : Model
    measure : Measure
    zeta : float
    largest : float, optional
        Largest amount to try; by default as ``Measure.most``.
    **arguments
        Of :func:`concio.assess`.

    Raises
    ------
    InputError
        There is no such tie or body; or as :func:`concio.assess`.
    NoEquilibriumError
        The model stands with no amount that was tried.

    Examples
    --------
    Weight on a pillar that tips does not help, for it pushes as much as it holds:

    >>> import concio
    >>> from concio.seismic import Measure, strengthen
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", unit_weight=20.0)
    >>> site = concio.Site({"SLV": {"a_g": 0.30, "F0": 2.45, "Tc": 0.32}}, soil="C")
    >>> asked = {"site": site, "levels": ("SLV",), "direction": "left", "elsewhere": ("out of plane",)}
    >>> found = strengthen(pillar, Measure("mass", ("b01",)), **asked)
    >>> found.amount, round(found.reached, 3) < 1.0
    (inf, True)
    """
    most = measure.most(model) if largest is None else largest
    if not 0 < zeta < math.inf:
        msg = f"zeta = {zeta:g} must be positive and finite"
        raise InputError(msg, hint="the value that zeta_E is to reach, such as 1.0")
    if not 0 < most < math.inf:
        msg = f"the largest amount to try, {most:g} {measure.unit}, must be positive"
        raise InputError(msg)
    if measure.heights:
        return _by_height(model, measure, zeta, most, arguments)
    measure.applied(model, most)
    tried: dict[float, Assessment | None] = {}

    def assessed(amount: float) -> Assessment | None:
        if amount not in tried:
            try:
                tried[amount] = assess(measure.applied(model, amount), **arguments)
            except NoEquilibriumError:  # without a tie a thrust may push the wall over before any earthquake
                tried[amount] = None
        return tried[amount]

    def missing(amount: float) -> float:
        made = assessed(amount)
        return -zeta if made is None else min(made.least, 10.0 * zeta) - zeta

    amount, below = least_amount(missing, most)
    before = assessed(0.0)
    best = [a for a in tried.values() if a is not None]
    after = tried[amount] if math.isfinite(amount) else max(best, key=lambda a: a.least, default=None)
    trials = {k: math.nan if a is None else a.least for k, a in sorted(tried.items())}
    if after is None:  # it stands with no amount: why, is told by the exception
        after = assess(measure.applied(model, most), **arguments)
    reached = after.least
    return Strengthened(measure, zeta, amount, below, reached, most, before, after, trials)


def _by_height(model: Model, measure: Measure, zeta: float, most: float, arguments: Mapping[str, Any]) -> Strengthened:
    """Return what a tie needs at the height at which it needs least; elsewhere it is not settled what more it needs."""
    own, name = replace(measure, heights=()), measure.of[0]
    made = {h: tie_at_height(model, name, h) for h in measure.heights}
    best: Strengthened | None = None
    forces: dict[float, float] = {}
    at = measure.heights[0]
    for height, moved in made.items():
        if best is not None and math.isfinite(best.amount):
            try:
                short = assess(own.applied(moved, best.amount), **arguments).least < zeta
            except NoEquilibriumError:
                short = True
            if short:
                forces[height] = math.inf
                continue
        largest = most if best is None or not math.isfinite(best.amount) else best.amount
        found = strengthen(moved, own, zeta=zeta, largest=largest, **arguments) if largest > 0 else best
        assert found is not None
        forces[height] = found.amount
        if best is None or found.amount < best.amount or (math.isinf(found.amount) and found.reached > best.reached):
            best, at = found, height
    assert best is not None
    return replace(best, measure=measure, height=at, by_height=forces)


def least_amount(missing: Callable[[float], float], most: float) -> tuple[float, float]:
    """Return the least amount met at which nothing is missing, and the largest one below it at which something is.

    Parameters
    ----------
    missing : callable
        Negative where something is missing.
    most : float
        Largest amount that is tried.

    Returns
    -------
    (float, float)
        ``(0, nan)`` where none is needed, ``(inf, most)`` where no amount that was tried does.
    """
    if missing(0.0) >= 0:
        return 0.0, math.nan
    low = high = 0.0
    for share in SHARES_OF_LARGEST:  # from below: with much more of it other mechanisms may be worse off again
        high = share * most
        if missing(high) >= 0:
            break
        low = high
    else:
        return math.inf, most
    found = float(brentq(missing, low, high, xtol=ENOUGH * most * 0.01, rtol=ENOUGH))
    while missing(found) < 0:  # on the safe side of the accuracy
        low, found = found, min(found * (1 + ENOUGH), high)
    while found > low and missing(below := max(found * (1 - 2 * ENOUGH), low)) >= 0:
        found = below
    return found, max(found * (1 - 2 * ENOUGH), low)


# -- what is applied --------------------------------------------------------------------------------------------------


def _tie(measure: Measure, model: Model, amount: float) -> Model:
    names, name = [t.name for t in model.ties], measure.of[0]
    if name not in names:
        msg = f"there is no tie called '{name}'"
        raise InputError(msg, hint=closest(name, names) if names else "give the model a tie")
    if amount <= 0:
        return replace(model, ties=tuple(t for t in model.ties if t.name != name))
    ties = tuple(replace(t, yield_force=amount, prestress=min(t.prestress, amount)) if t.name == name else t
                 for t in model.ties)  # fmt: skip
    return replace(model, ties=ties)


def _mass(measure: Measure, model: Model, amount: float) -> Model:
    chosen = chosen_bodies(model, "mass", measure.of)
    if amount <= 0:
        return model
    more = amount / sum(model.bodies[i].volume for i in chosen)
    materials, bodies = dict(model.materials), list(model.bodies)
    for i in chosen:
        own = bodies[i].material
        heavier = f"{own} with mass"
        materials[heavier] = replace(materials[own], unit_weight=materials[own].unit_weight + more)
        bodies[i] = replace(bodies[i], material=heavier)
    return replace(model, bodies=tuple(bodies), materials=materials)


def _buttress(measure: Measure, model: Model, amount: float) -> Model:
    chosen = chosen_bodies(model, "buttress", measure.of)
    if amount <= 0:
        return model
    return with_buttress(model, chosen, measure.side, measure.height, amount, measure.unit_weight)


def _grout(measure: Measure, model: Model, amount: float) -> Model:
    if amount <= 0:
        return model
    used = [model.laws[rule.law] for rule in model.rules]
    weakest = min(used, key=lambda law: law.friction)
    laws = {**model.laws, "grout": replace(weakest, cohesion=weakest.cohesion + amount)}
    rules = tuple(JointRule("grout", between=(p, q)) for k, p in enumerate(measure.of) for q in measure.of[k:])
    return replace(model, laws=laws, rules=(*model.rules, *rules))


APPLIED: Mapping[str, Callable[[Measure, Model, float], Model]] = {
    "tie": _tie, "mass": _mass, "buttress": _buttress, "grout": _grout
}  # fmt: skip
