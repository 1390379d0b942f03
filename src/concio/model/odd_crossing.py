"""Numbers of fill, road and vehicle that are possible but implausible: tonnes for kN, a vehicle wider than its bridge.

Each finding is a sentence for a person; :mod:`concio.model.plausibility` puts them into the one list of attention.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from concio.model.crossing import STRETCH, TONNES, Vehicle
from concio.model.fill import Fill
from concio.model.model import Body, Model
from concio.units import GRAVITY

NEWTONS = 1_000.0
"""Axles heavier than this were perhaps given in newtons [kN]."""
LIGHT, HEAVY = 5.0, 40.0
"""Unit weights of fill and road layers lie between these [kN/m3]; ballast, asphalt and concrete have 16 to 25."""
DEEP = 20.0
"""Larger depths of cover are reported [m]."""
FAR = 200.0
"""Axles that follow each other at larger distances are reported [m]."""
WIDER = 1e-6


def odd_crossing(model: Model) -> list[str]:
    """Return a sentence for each number of ring, fill, road and vehicle that is implausible."""
    found = _ring(model.generator)
    if model.fill is not None:
        found += _fill(model.fill)
    if model.vehicle is not None:
        found += [*_axles(model.vehicle), *_width(model, model.vehicle)]
        found += [*_everywhere(model.vehicle), *_gaps(model.vehicle)]
    return found


def _ring(generator: Mapping[str, object]) -> list[str]:
    """Return a sentence where the rings of a bridge are thicker than half of its shortest span."""
    given = generator.get("arguments")
    if generator.get("kind") != "bridge" or not isinstance(given, Mapping):
        return []
    ring, span = sum(given["ring"]), min(given["span"])
    if ring <= 0.5 * span:
        return []
    return [f"a ring of {ring:g} m in a span of {span:g} m is more than half of it: is that its unit?"]


def _fill(fill: Fill) -> list[str]:
    found = []
    weights = [("the fill", fill.unit_weight), *((f"layer '{x.name}'", x.unit_weight) for x in fill.layers)]
    for what, weight in weights:
        if weight > HEAVY:
            found.append(f"{what} weighs {weight:g} kN/m3, more than any fill: masses are written with their unit, "
                         f"'{weight:g} kg/m3'")  # fmt: skip
        elif 0 < weight < LIGHT:
            found.append(f"{what} weighs {weight:g} kN/m3, less than any fill: masses are written with their unit, "
                         f"'{weight:g} t/m3'")  # fmt: skip
    if fill.cover is not None and fill.cover > DEEP:
        found.append(f"a cover of {fill.cover:g} m is more than that of any bridge: is that its unit?")
    return found


def _axles(vehicle: Vehicle) -> list[str]:
    """Return a sentence where axles are so light that they may be tonnes, or so heavy that they may be newtons."""
    heaviest = vehicle.heaviest.load
    stretch = vehicle.heaviest.length is not None and vehicle.heaviest.length >= STRETCH
    told = f"the heaviest axle of vehicle '{vehicle.name}' is {heaviest:g} kN: "
    if heaviest > NEWTONS and not stretch:
        return [f"{told}if newtons were meant, write '{heaviest:g} N'"]
    if heaviest > TONNES or heaviest == 1.0:  # a unit load is to be multiplied
        return []
    return [f"{told}if tonnes were meant, write '{heaviest:g} tf', which is {heaviest * GRAVITY:.4g} kN"]


def _everywhere(vehicle: Vehicle) -> list[str]:
    """Return a sentence where load that counts where it is unfavourable stands on all of the road."""
    if vehicle.position is None or not vehicle.unfavourable or vehicle.loaded is not None or not vehicle.uniform:
        return []
    return [
        f"the uniform load of vehicle '{vehicle.name}' stands on the whole road here, and may help the bridge: "
        "'concio bridge' finds where it is unfavourable, and loaded in [vehicle] puts it there"
    ]


def _gaps(vehicle: Vehicle) -> list[str]:
    """Return a sentence where axles that follow each other are so far apart that a place may be in other units."""
    places = sorted(a.at for a in vehicle.points)
    gap = max((b - a for a, b in pairwise(places)), default=0.0)
    if gap <= FAR:
        return []
    return [f"two axles of vehicle '{vehicle.name}' that follow each other are {gap:g} m apart: is that its unit?"]


def _width(model: Model, vehicle: Vehicle) -> list[str]:
    """Return a sentence where the vehicle is wider than the structure that is computed."""
    wide = max(vehicle.width if a.width is None else a.width for a in vehicle.axles)
    own = max((b.thickness for b in model.bodies if isinstance(b, Body) and b.kind != "fixed"), default=wide)
    if wide <= own * (1 + WIDER) or vehicle.heaviest.load == 1.0:
        return []
    return [
        f"vehicle '{vehicle.name}' is {wide:g} m wide, the structure below it {own:g} m: all of its load is put on "
        "that width"
    ]
