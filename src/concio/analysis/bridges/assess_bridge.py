"""How much of a vehicle a masonry arch bridge carries: every position, the worst, and what the answer rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from concio.analysis.bridges.bridge_result import Bracket, BridgeResult, Coulomb
from concio.analysis.bridges.mexe import mexe_of
from concio.analysis.bridges.service import service_state, with_settlement
from concio.analysis.bridges.sweep import APART, FINE, Standing, Sweep, grid, least, lowest, placed, search
from concio.analysis.bridges.two_vehicles import second_vehicle, worst_apart
from concio.analysis.bridges.variants import changes, parts
from concio.analysis.entry_point import entry_point
from concio.analysis.lent_compliance import lend
from concio.analysis.limit import limit
from concio.arguments import strict
from concio.errors import InputError, NoEquilibriumError, SolverError
from concio.model.model import Model
from concio.model.road.earth import with_vehicle, without_pressure
from concio.model.road.vehicles import find_vehicle
from concio.problem.solution import Progress, ProgressCallback, Status
from concio.solvers.methods import find
from concio.solvers.statics.existence import find_mechanism
from concio.verdict.bridge_verdict import ASKED, DEAD_NOT_STANDING
from concio.verdict.not_standing import not_standing, of_the_joints

Array = np.ndarray

POSITIONS_CHECKED = 40
"""Positions at which Coulomb states are found, unless more or fewer are asked for."""


@strict
@entry_point
def assess_bridge(
    model: Model,
    *,
    required: float = 1.0,
    step: float | None = None,
    fine: float = FINE,
    worst: int = 3,
    checked: int = POSITIONS_CHECKED,
    sensitivity: bool = True,
    others: Sequence[str] = (),
    second: str | None = None,
    apart: Sequence[float] = (),
    settled: Mapping[str, float] | None = None,
    span_rise: float | None = None,
    progress: ProgressCallback | None = None,
) -> BridgeResult:
    """Find the load factor of a vehicle at every position on a bridge, and the worst.

    Parameters
    ----------
    model : Model
        Plane, with fill and a vehicle (:func:`concio.with_fill`, :func:`concio.with_vehicle`).
    required : float
        Load factor that is asked for at every position.
    step : float, optional
        Distance of positions of the first grid [m]; by default a fortieth of the shortest span.
    fine : float
        Distance to which the worst positions are refined [m].
    worst : int
        At how many positions the bracket of associated bound and Coulomb load steps is found, each the least in its
        neighbourhood, at most.
    checked : int
        At how many positions a Coulomb state under ``required`` times the vehicle is found; 0 leaves that out, and the
        answer open.
    sensitivity : bool
        Whether ring, fill, friction and strength are varied, at the worst position.
    others : sequence of str
        Further vehicles of the library, each with its own worst position.
    second : str, optional
        A vehicle of the library that is on the bridge together with the first, or "same"; its axles alone count. The
        answer is for both, at the distance at which they are worst.
    apart : sequence of float
        Distances between the reference points of the two that are examined [m].
    settled : mapping of str to float, optional
        Downward settlement of fixed bodies by name, for a second working state [m].
    span_rise : float, optional
        Span/rise factor for the comparison with MEXE where the arch is flat.
    progress : callable, optional

    Raises
    ------
    InputError
        The model has no fill or no vehicle; a number is out of its range.
    NoEquilibriumError
        The bridge does not stand without the vehicle.
    SolverError
        The vehicle reaches no masonry, or the callback asked to stop.

    Examples
    --------
    How many times an axle of 100 kN can cross a bridge of 3 m, at its worst position:

    >>> import concio
    >>> bare = concio.bridge(span=3.0, rise=0.75, ring=0.215, voussoirs=16, block="rigid", width=2.0)
    >>> filled = concio.with_fill(bare, concio.Fill(cover=0.3, friction_angle=30.0, mobilised=0.3))
    >>> loaded = concio.with_vehicle(filled, concio.find_vehicle("single axle"))
    >>> found = concio.assess_bridge(loaded, step=0.5, fine=0.1, checked=3, sensitivity=False)
    >>> round(found.worst.multiplier, 2)
    1.76
    """
    if not 0 < required < np.inf:
        msg = f"required = {required:g} must be positive"
        raise InputError(msg, hint="the load factor that is asked for, 1 for the vehicle as it is")
    _refuse_numbers(fine, worst, checked, span_rise)
    if model.dim != 2:
        msg = "bridges are assessed in the plane; the model is in space"
        raise InputError(msg, hint="give the plane model of a strip")
    also = {name: replace(find_vehicle(name), direction="both") for name in others}
    with_settlement(model, settled or {})
    if second is None and apart:
        msg = "distances between two vehicles are given, and no second vehicle"
        raise InputError(msg, where="apart", hint="name it, or say 'same'")
    follower = None if second is None else second_vehicle(model, second, apart)
    sweep = Sweep(model)
    _refuse_what_does_not_stand(sweep)
    distances: dict[float, float] = {}
    if follower is not None:
        model, distances = worst_apart(model, follower, apart, step=step, progress=progress)
        sweep = Sweep(model)
    standings = search(sweep, step=step, fine=fine, worst=worst, progress=progress)
    low, high = sweep.reach()
    few = least(lowest(standings), max(worst, 1), APART * (high - low))
    if not few:
        msg = "no position of the vehicle has a load factor: nothing bounds its load anywhere"
        raise SolverError(msg, hint="does the vehicle stand on masonry that can move?")
    loaded = [placed(model, s) for s in few]
    brackets = []
    for s, one in zip(few[:worst], loaded, strict=False):
        _tell(progress, "bracket", f"x = {s.position:.3g} m")
        assert one.vehicle is not None, "placed"
        brackets.append(Bracket(s, limit(one, one.vehicle.group, path=False, steps=True, search=False)))
    place = few[0].position, few[0].direction
    _tell(progress, "bridge", "without the pressure of the soil")
    soil = any(t.kind == "soil" for t in model.ties)
    return BridgeResult(
        model=loaded[0],
        required=required,
        standings=standings,
        brackets=tuple(brackets),
        coulomb=_coulomb(sweep, required, checked, step, few, progress),
        parts=parts(model, *place),
        without_soil=_worst_of(without_pressure(model), step, fine) if soil else few[0],
        changes=changes(model, *place) if sensitivity else (),
        others={name: _worst_of(with_vehicle(model, one), step, fine) for name, one in also.items()},
        service=service_state(loaded[0]),
        settled=service_state(loaded[0], settled) if settled else None,
        settlements=dict(settled or {}),
        mexe=mexe_of(model, span_rise=span_rise),
        fine=fine,
        apart=distances,
    )  # fmt: skip


def _refuse_numbers(fine: float, worst: int, checked: int, span_rise: float | None) -> None:
    """Refuse numbers that cannot be meant."""
    hints = "the distance to which the worst positions are refined", "a factor of MEXE: 1, or less of flat arches"
    for key, number, hint in zip(("fine", "span_rise"), (fine, span_rise), hints, strict=True):
        if number is not None and not 0 < number < np.inf:
            msg = f"{key} = {number:g} must be positive"
            raise InputError(msg, hint=hint)
    for key, count in (("worst", worst), ("checked", checked)):
        if count < 0:
            msg = f"{key} = {count} must not be negative"
            raise InputError(msg, hint="a number of positions")


def _tell(progress: ProgressCallback | None, stage: str, words: str) -> None:
    if progress is not None and progress(Progress(stage, 0, float("nan"), words)):
        msg = "stopped on request"
        raise SolverError(msg)


def _refuse_what_does_not_stand(sweep: Sweep) -> None:
    if find_mechanism(sweep.dead) is None:
        return
    told = not_standing(sweep.assembly, ASKED, DEAD_NOT_STANDING)
    what = of_the_joints(DEAD_NOT_STANDING, sweep.assembly.detection)
    raise NoEquilibriumError(what, hint="look at it with 'concio run' and no vehicle", verdict=told)


def _worst_of(model: Model, step: float | None, fine: float) -> Standing | None:
    """Return the standing of the least multiplier of a model of its own; None where it does not stand or has none."""
    sweep = Sweep(model)
    if find_mechanism(sweep.dead) is not None:
        return None
    found = least(search(sweep, step=step, fine=fine, worst=1), 1, 0.0)
    return found[0] if found else None


def _coulomb(
    sweep: Sweep, required: float, count: int, step: float | None, few: Sequence[Standing],
    progress: ProgressCallback | None,
) -> tuple[Coulomb, ...]:  # fmt: skip
    """Return Coulomb states under ``required`` times the vehicle at some positions, the worst among them."""
    if count <= 0:
        return ()
    places = [(s.position, s.direction) for s in few]
    every = [p for p in grid(sweep, step) if sweep.at(*p) is not None]
    picked = np.unique(np.linspace(0, len(every) - 1, min(count, len(every))).astype(int))
    places += [every[k] for k in picked if every[k] not in places]
    lent = lend(sweep.assembly).problem()
    solver = find("auto")
    found = []
    for k, (x, way) in enumerate(places):
        if progress is not None:
            progress(Progress("Coulomb states", k, float("nan"), f"{way}, x = {x:.3g} m"))
        standing = sweep.at(x, way)
        live, _, _ = sweep.load(x, way, None if standing is None else standing.loaded)
        if standing is not None and standing.limit.checked and standing.limit.upper < required:
            found.append(Coulomb(x, way, Status.NO_EQUILIBRIUM))
            continue
        found.append(Coulomb(x, way, solver(lent.with_loads(lent.f + required * live)).status))
    return tuple(sorted(found, key=lambda c: (c.direction, c.position)))
