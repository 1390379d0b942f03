"""The same bridge with one thing otherwise: without soil pressure, without spread, with a thicker ring, less fill."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from concio.analysis.bridges.sweep import Sweep
from concio.errors import ConcioError
from concio.model.fill import Fill
from concio.model.generate.arch_bridges import rebuilt
from concio.model.model import Model
from concio.model.road.earth import with_fill, with_vehicle, without_fill, without_pressure, without_vehicle
from concio.representation import short_repr

BARE = "ring alone"
WEIGHT = "weight of the fill"
SPREAD = "spread of the load"
PASSIVE = "pressure of the soil"

PARTS = (BARE, WEIGHT, SPREAD, PASSIVE)
"""What a limit load owes to what, one added after the other."""


@short_repr
@dataclass(frozen=True)
class Change:
    """What comes of one datum changed.

    Parameters
    ----------
    name : str
        Key of the datum.
    unit : str
    value : float
        As given.
    low, high : float
        Less and more of it.
    at_low, at_high : float
        Associated multiplier with these, at the position of the worst.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    at_low: float
    at_high: float

    @property
    def swing(self) -> float:
        """How far the multiplier goes between them."""
        return abs(self.at_high - self.at_low)


def parts(model: Model, position: float, direction: str) -> dict[str, float]:
    """Return the associated multiplier as the parts of a bridge are added: ring, weight of fill, spread, pressure."""
    fill = model.fill
    assert fill is not None
    weight = replace(fill, spread="none", passive=0.0, mobilised=1.0, pressure="none")
    bare = replace(weight, unit_weight=0.0, layers=(), fill_line=(), spandrels=0.0)
    models = {
        BARE: refilled(model, bare), WEIGHT: refilled(model, weight), SPREAD: without_pressure(model), PASSIVE: model
    }  # fmt: skip
    return {name: multiplier_at(one, position, direction) for name, one in models.items()}


def refilled(model: Model, fill: Fill) -> Model:
    """Return a model with other fill under the same vehicle, as wide as it is."""
    vehicle = model.vehicle
    found = with_fill(without_fill(without_vehicle(model)), replace(fill, width="full"))
    return found if vehicle is None else with_vehicle(found, vehicle)


def multiplier_at(model: Model, position: float, direction: str) -> float:
    """Return the associated multiplier of a vehicle at one position; nan where it cannot be found."""
    try:
        found = Sweep(model).at(position, direction)
    except ConcioError:
        return float("nan")
    return float("nan") if found is None else found.multiplier


def changes(model: Model, position: float, direction: str) -> tuple[Change, ...]:
    """Return what comes of each datum with less and with more of it, the one that matters most first."""
    found = []
    for name, unit, value, step, changed in _data(model):
        ends = [value - step, value + step]
        at = [multiplier_at(m, position, direction) if (m := _tried(changed, v)) else float("nan") for v in ends]
        found.append(Change(name, unit, value, *ends, *at))
    return tuple(sorted(found, key=lambda c: -c.swing if np.isfinite(c.swing) else 0.0))


def _tried(changed: Callable[[float], Model | None], value: float) -> Model | None:
    try:
        return changed(value)
    except ConcioError:
        return None


def _data(model: Model) -> Iterator[tuple[str, str, float, float, Callable[[float], Model | None]]]:
    """Yield name, unit, value, change, and what makes the model of a value."""
    fill = model.fill
    assert fill is not None

    def filled(key: str) -> Callable[[float], Model]:
        def made(value: float) -> Model:
            values: dict[str, Any] = {key: value}
            return refilled(model, replace(fill, **values))

        return made

    ring = _ring(model)
    if ring is not None:
        yield "ring", "m", ring, 0.010, lambda v: _with_ring(model, v / ring)
    if fill.cover is not None:
        yield "cover", "m", fill.cover, min(0.05, 0.5 * fill.cover), filled("cover")
    yield "fill unit weight", "kN/m3", fill.unit_weight, 0.1 * fill.unit_weight, filled("unit_weight")
    if fill.friction_angle is not None and fill.passive is None:
        yield "friction angle", "deg", fill.friction_angle, 5.0, filled("friction_angle")
        if fill.mobilised > 0:
            yield "mobilised", "-", fill.mobilised, 0.2 * fill.mobilised, filled("mobilised")
    elif fill.passive:
        yield "passive", "-", fill.passive, 0.2 * fill.passive, filled("passive")
    for name, law in model.laws.items():
        if law.friction > 0:
            yield f"friction '{name}'", "-", law.friction, 0.1, _lawful(model, name, "friction")
        if law.compressive_strength is not None:
            strength = law.compressive_strength
            made = _lawful(model, name, "compressive_strength")
            yield f"strength '{name}'", "kN/m2", strength, 0.2 * strength, made


def _lawful(model: Model, name: str, key: str) -> Callable[[float], Model]:
    """Return what makes the model with another value of a joint law."""

    def made(value: float) -> Model:
        values: dict[str, Any] = {key: value}
        return replace(model, laws={**model.laws, name: replace(model.laws[name], **values)})

    return made


def _ring(model: Model) -> float | None:
    """Return the thickness of all rings together, where the bridge can be made again."""
    arguments = model.generator.get("arguments") or model.generator.get("drawn")
    if not isinstance(arguments, dict) or "ring" not in arguments:
        return None
    rings = arguments["ring"]
    return float(sum(rings)) if isinstance(rings, list) else float(rings)


def _with_ring(model: Model, factor: float) -> Model | None:
    """Return the bridge with all rings thicker by a factor, its fill and vehicle on it."""
    bodies = rebuilt(model, factor)
    vehicle, fill = model.vehicle, model.fill
    assert fill is not None
    bare = replace(without_fill(without_vehicle(model)), bodies=bodies)
    found = with_fill(bare, replace(fill, width="full"))
    return found if vehicle is None else with_vehicle(found, vehicle)
