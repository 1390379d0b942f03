"""Masonry arch bridges: fill, vehicles, and the load factor of a vehicle at every position.

>>> from concio import bridges
>>> bridges.find_vehicle("single axle").total
100.0

The functions and classes are those of ``concio`` itself. Beside them are the library of vehicles, rules of spread and
the parts of a result. :func:`concio.bridge` makes the masonry.
"""

from __future__ import annotations

from concio.analysis.bridges.assess_bridge import assess_bridge
from concio.analysis.bridges.bridge_result import Bracket, BridgeResult, Coulomb
from concio.analysis.bridges.mexe import Mexe, mexe
from concio.analysis.bridges.service import ServiceState
from concio.analysis.bridges.sweep import Standing
from concio.analysis.bridges.variants import Change
from concio.model.crossing import Axle, Vehicle
from concio.model.fill import Fill, Layer
from concio.model.road.earth import with_fill, with_vehicle
from concio.model.road.spread import SpreadRule
from concio.model.road.vehicles import find_vehicle, vehicles

__all__ = [
    "Axle",
    "Bracket",
    "BridgeResult",
    "Change",
    "Coulomb",
    "Fill",
    "Layer",
    "Mexe",
    "ServiceState",
    "SpreadRule",
    "Standing",
    "Vehicle",
    "assess_bridge",
    "find_vehicle",
    "mexe",
    "vehicles",
    "with_fill",
    "with_vehicle",
]
