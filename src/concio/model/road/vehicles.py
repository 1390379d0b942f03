"""Vehicles by name: a library that is data with its sources, and convoys of several."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import Any

from concio.arguments import closest, strict
from concio.errors import InputError
from concio.model.crossing import Axle, Vehicle
from concio.units import DECIMAL_COMMA

WITHOUT_SOURCE = {
    r"linee guida|guidelines|2020": "schemes of the Italian guidelines of 2020 are not in the library, for want of a "
    "source of their axle loads",
    r"^ra ?\d+": "of Route Availability the library has 3, 5, 8 and 10, whose axle loads Network Rail publishes",
}
"""What a name is taken to mean that is not found, with the reason."""


@cache
def vehicles() -> Mapping[str, Vehicle]:
    """Return the vehicles that come with concio, by name.

    Examples
    --------
    >>> from concio.bridges import vehicles
    >>> vehicles()["single axle"].total
    100.0
    """
    text = files("concio.model.road").joinpath("vehicles.toml").read_text(encoding="utf-8")
    found = {}
    for name, table in tomllib.loads(text).items():
        axles = axles_of([*table.pop("axles")], table.pop("lanes", []))
        found[name] = Vehicle(name, axles, **table)
    return found


@strict
def find_vehicle(name: str) -> Vehicle:
    """Return a vehicle of the library.

    Raises
    ------
    InputError
        There is none of that name.

    Examples
    --------
    >>> import concio
    >>> vehicle = concio.find_vehicle("single axle")
    >>> vehicle.total, len(vehicle.axles)
    (100.0, 1)
    """
    known = vehicles()
    if name not in known:
        msg = f"there is no vehicle '{name}'"
        own = "your own is axles = [[place, load], ...]"
        told = (why for meant, why in WITHOUT_SOURCE.items() if re.search(meant, name, re.IGNORECASE))
        raise InputError(msg, where="vehicle", hint=f"{next(told, None) or closest(name, known)}; {own}")
    return known[name]


def axles_of(axles: Sequence[Any], lanes: Sequence[Sequence[Any]] = ()) -> tuple[Axle, ...]:
    """Return axles from pairs (place, load) or tables, and stretches of uniform load from (from, to, kN per m).

    Raises
    ------
    InputError
        One has another form.
    """
    found = []
    for k, given in enumerate(axles, 1):
        if isinstance(given, Axle):
            found.append(given)
        elif isinstance(given, Mapping):
            found.append(Axle(**given))
        elif isinstance(given, Sequence) and not isinstance(given, str) and len(given) == 2:
            found.append(Axle(given[0], given[1]))
        else:
            msg = f"axle {k} = {given!r} is not a pair"
            commas = isinstance(given, Sequence) and not isinstance(given, str) and len(given) > 2
            told = f"; {DECIMAL_COMMA}" if commas else ""
            raise InputError(msg, where="vehicle", hint=f"write [place in m, load in kN]{told}")
    for k, lane in enumerate(lanes, 1):
        if len(lane) != 3 or not lane[1] > lane[0]:
            msg = f"stretch {k} = {list(lane)} is not [from, to, kN per m]"
            raise InputError(msg, where="vehicle, lanes")
        first, last, load = (float(v) for v in lane)
        found.append(Axle(0.5 * (first + last), load * (last - first), length=last - first))
    return tuple(found)


def convoy(vehicle: Vehicle, others: Sequence[tuple[Vehicle, float]]) -> Vehicle:
    """Return a vehicle followed or preceded by others whose reference points are at distances from its own [m]."""
    axles = list(vehicle.axles)
    for other, distance in others:
        ratio = other.dynamic * other.factor / (vehicle.dynamic * vehicle.factor)
        for axle in other.axles:
            length = other.footprint if axle.length is None and other.footprint != vehicle.footprint else axle.length
            width = other.width if axle.width is None and other.width != vehicle.width else axle.width
            axles.append(replace(axle, at=axle.at + distance, load=axle.load * ratio, length=length, width=width))
    name = " + ".join([vehicle.name, *(f"{other.name} at {distance:g} m" for other, distance in others)])
    sources = "; ".join(dict.fromkeys(v.source for v in (vehicle, *(o for o, _ in others)) if v.source))
    return replace(vehicle, name=name, axles=tuple(axles), source=sources)
