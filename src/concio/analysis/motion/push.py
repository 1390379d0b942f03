"""Pushing a structure over: equilibria at large displacements, past the peak, until nothing is carried any more."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from concio.analysis.entry_point import entry_point
from concio.analysis.motion.interruption import Interruption
from concio.analysis.motion.near_origin import Near
from concio.analysis.motion.not_begun import proof_at_rest
from concio.analysis.motion.push_apart import NoStartError, PushAsked, followed
from concio.analysis.motion.push_asked import (
    control_asked,
    direction_asked,
    factors_asked,
    live_asked,
    side_asked,
)
from concio.analysis.motion.push_result import PushResult
from concio.analysis.motion.scheme import Scheme
from concio.arguments import strict
from concio.contact.applied import free_group, pushed
from concio.contact.assembly import assemble
from concio.contact.points import Followed
from concio.contact.reference import Reference
from concio.errors import ConcioError, InputError, NoEquilibriumError, SolverError
from concio.model.model import Model
from concio.model.stages import ControlPoint
from concio.problem.contact_problem import Engine
from concio.problem.solution import ProgressCallback
from concio.units import GRAVITY
from concio.verdict.not_standing import FOLLOWED_AWAY, not_standing
from concio.verdict.verdict import Outcome

Array = np.ndarray


@strict
@entry_point
def push(
    model: Model,
    *,
    control: ControlPoint | Literal["load"] | None = None,
    live: str | Sequence[str] | None = None,
    direction: float | Sequence[float] | None = None,
    step: float | None = None,
    until: float | None = None,
    smallest: float = 0.0,
    factors: Mapping[str, float] | None = None,
    points: Sequence[ControlPoint] = (),
    gravity: float = GRAVITY,
    brittle: bool = True,
    engine: Engine | None = None,
    progress: ProgressCallback | None = None,
) -> PushResult:
    """Push a structure over: statics at large displacements, past the peak, until its strength is lost.

    Contacts are looked for where the bodies stand, loads act where they are, and every point of the curve is checked
    against the equations of the displaced structure.

    Parameters
    ----------
    model : Model
        With every support, tie and load. In the plane with every joint law; in space on joints that
        do not dilate, those of elastic bodies with friction alone.
    control : ControlPoint or "load", optional
        What grows: the displacement of a point, the load, or by default the mean displacement on which the load works
        (for a share of the weights, the mean displacement of the masses).
    live : str or sequence of str, optional
        Load groups that the multiplier scales. By default the group "live", and where a model has none a share of all
        weights along ``direction``: self-weights and loads from above, as in :func:`concio.assess`.
    direction : float, (x, y) or (x, y, z), optional
        Direction of that share, by default along x; 1 or -1 is along x, (x, y) horizontal in space. Of load groups
        that are multiplied, the side to which they push: where their resultant points to the other side they grow with
        the opposite sign.
    step : float, optional
        Largest step of the controlled displacement [m], default a twentieth of the bodies' width; under load control
        of the multiplier, default 0.05.
    until : float, optional
        Controlled displacement [m], or multiplier, at which to stop.
    smallest : float
        Multiplier at which the strength counts as lost.
    factors : mapping of str to float, optional
        Factors of load groups; groups not named have 1.
    points : sequence of ControlPoint
        Points to follow besides.
    gravity : float
        Turns weights into masses, of which only ratios matter here [m/s2].
    brittle : bool
        Whether joints lose cohesion and tensile strength for good once either was used up.
    engine : {"superlu", "pardiso"}, optional
        What factorises linear systems; by default that of the model.
    progress : callable, optional
        Called at every point; true stops, and what was computed is kept. So does Ctrl-C.

    Returns
    -------
    PushResult

    Raises
    ------
    InputError
        The model or an argument cannot be used.
    NoEquilibriumError
        The structure does not stand at multiplier zero: a certificate proves it, or it moves away.
    SolverError
        Neither an equilibrium at multiplier zero nor anything that excludes one was found.

    Examples
    --------
    A block, 0.5 m wide and 2 m high, begins to turn over at 0.25 of its weight. It falls once its centroid has
    moved by half its width:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    >>> pushed = concio.push(pillar)
    >>> round(float(pushed.peak), 4), round(float(pushed.capacity), 4)
    (0.25, 0.25)
    """
    near = Near.of(model)
    reference = Reference.of(near.model, gravity)
    chosen = factors_asked(reference, factors)
    groups = stated = live_asked(reference, live)
    along = direction_asked(1.0 if direction is None else direction, reference.disc.dim)
    sign = side_asked(reference, groups, chosen, None if direction is None else along)
    if not stated:
        groups = (free_group(model),)
        reference = Reference.of(pushed(near.model, along.tolist(), groups[0], chosen), gravity)
    point, by_load = control_asked(control)
    there = None if point is None else near.point(point)
    asked = PushAsked(
        reference, Scheme(brittle=brittle), chosen, groups, there, by_load, step, until, float(smallest), sign, engine,
        progress,
    )  # fmt: skip
    whole = asked.statics(reference)
    unit = whole.unit(reference.at_rest().placement.turns)
    if not unit.any():
        msg = "what is to be multiplied has no force: there is nothing to push with"
        raise InputError(msg, hint="give materials a unit_weight, or name the groups to multiply (live)")
    Followed.of(reference, *near.points(points), *([] if there is None else [there]))  # refused before anything moves
    clock_begun = clock.perf_counter()
    try:
        with Interruption() as interruption:
            run = followed(asked, interruption)
    except NoStartError as lost:
        raise _not_begun(model, lost, chosen, stated) from None
    found = PushResult(
        model=near.model, gravity=gravity, ending=run.ending, displacement=np.array(run.displacement),
        multiplier=np.array(run.multiplier), residual=np.array(run.residual),
        centre=np.array([s.centre for s in run.states]), rotation=np.array([s.rotation for s in run.states]),
        strain=np.array([s.strain for s in run.states]), reaction=np.array(run.reactions),
        reactions_of=run.reactions_of, events=tuple(run.events), live=stated, direction=along,
        force=unit[whole.frames.places].sum(axis=0), factors=chosen, control=there, points=near.points(points),
        notes=tuple(run.notes), seconds=clock.perf_counter() - clock_begun, lent_compliance=run.lent,
        end=run.states[-1], until=asked.until if np.isfinite(asked.until) else None, by_load=by_load, reversed=sign < 0,
        structures=run.structures,
    )  # fmt: skip
    return near.told(found, points, point)


def _not_begun(model: Model, lost: NoStartError, factors: Mapping[str, float], live: tuple[str, ...]) -> ConcioError:
    """Return what to raise where no equilibrium was found before the push: proven, seen or open."""
    assembly, wanted = assemble(model), "a capacity curve at large displacements"
    proof = proof_at_rest(assembly, {**factors, **dict.fromkeys(live, 0.0)}) if lost.share in (0.0, 1.0) else ""
    proof = proof or (FOLLOWED_AWAY if lost.away else "")
    told = not_standing(
        assembly, wanted, str(lost), factors=factors, multiplied=live, moving=lost.moving, proof=proof,
        shown=bool(proof),
    )  # fmt: skip
    if told.outcome is not Outcome.FAILS:
        hint = f"not checked: {told.unchecked[0]}" if told.unchecked else "ask 'concio run' whether it stands"
        return SolverError(told.answer, hint=hint, verdict=told)
    hint = "see 'concio run' for its collapse; the factors of dead loads may be meant otherwise"
    return NoEquilibriumError(str(lost), hint=hint, verdict=told)
