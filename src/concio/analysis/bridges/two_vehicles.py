"""Two vehicles on a bridge: the distance between them at which they are worst."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from concio.analysis.bridges.sweep import Sweep, search
from concio.errors import InputError
from concio.model.crossing import Vehicle
from concio.model.model import Model
from concio.model.road.earth import with_vehicle
from concio.model.road.vehicles import convoy, find_vehicle
from concio.problem.solution import ProgressCallback

SAME = "same"
"""Word for a second vehicle that is like the first."""


def second_vehicle(model: Model, name: str, apart: Sequence[float]) -> Vehicle:
    """Return the vehicle that goes with that of a model: axles only, uniform load counts once.

    Raises
    ------
    InputError
        There is none of that name, it has no axles, or no distance is given.
    """
    if model.vehicle is None:
        msg = "the model has no vehicle that a second one could follow"
        raise InputError(msg, hint="add [vehicle]")
    found = model.vehicle if name == SAME else find_vehicle(name)
    if not found.points:
        msg = f"vehicle '{found.name}' has no axles: a uniform load cannot be on one road twice"
        raise InputError(msg, where="second", hint="give axles, or lanes with a gap between them")
    if not apart or not all(0 < d < np.inf for d in apart):
        msg = "a second vehicle needs distances from the first, all of them positive"
        raise InputError(msg, where="apart", hint="for example 8, 12 and 16 m, between the reference points")
    return replace(found, axles=found.points, position=None)


def worst_apart(
    model: Model, second: Vehicle, apart: Sequence[float], *, step: float | None,
    progress: ProgressCallback | None = None,
) -> tuple[Model, dict[float, float]]:  # fmt: skip
    """Return the model under both vehicles where they are worst, and the least multiplier for each distance.

    Parameters
    ----------
    model : Model
        With fill and the first vehicle.
    second : Vehicle
    apart : sequence of float
        Distances between reference points [m]; a second vehicle unlike the first is put before and behind it, where
        the distance is negative.
    step : float or None
        Distance of positions [m].
    progress : callable, optional
    """
    first = model.vehicle
    assert first is not None
    alike = replace(first, axles=first.points, position=None) == second
    distances = sorted({float(d) for d in apart} | (set() if alike else {-float(d) for d in apart}))
    found, models = {}, {}
    for d in distances:
        models[d] = with_vehicle(model, replace(convoy(first, [(second, d)]), position=None))
        standings = search(Sweep(models[d]), step=step, fine=np.inf, worst=1, progress=progress)
        found[d] = min((s.multiplier for s in standings), default=np.inf)
    return models[min(found, key=lambda d: found[d])], found
