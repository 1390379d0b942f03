r"""Bridges that were loaded to failure, beside one model for all of them.

The measured loads are failure loads. The computed load is the upper bound for rigid blocks at the position of the test:
no equilibrium exists beyond it. All bridges have the same assumptions, and no parameter is fitted: masonry and fill
weigh 20 kN/m3, joints slide with mu = 0.6, the load is a strip of 0.75 m across the whole bridge (Prestwood and the
model bridges: 0.30 and 0.215 m) that spreads 1:2, the soil presses with at most k times the vertical stress, joints
crush at 5 MPa in one line and not at all in the others. Spandrel walls, skew, backing and tension are neglected.

Dimensions are those that papers on these tests quote; the reports of the tests were not at hand. Prestwood and
Torksey come nearest to a plane test. At Preston and Bargower, which are skew, and at Dundee, Strathmashie and
Bridgemill spandrel walls and anchors took part; Preston and Bargower crushed. Barlae, with a skew of 29 degrees, is
left out, and Shinafoot, for whose ring different values are quoted. The rings of the Bolton model bridges were
bonded, or separated by sand.

Deep arches without backing (Preston, Bargower, Dundee) carry next to nothing where the soil does not press; flat ones
hardly need it. No one value of k brings model and tests together.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import concio
from concio.analysis.bridges.sweep import Sweep
from validation_cases.row import Row

SOURCE = (
    "Failure loads: J. Page, Load tests to collapse on masonry arch bridges, in Arch Bridges (1995), with the TRL "
    "reports that it sums up (RR 110, RR 159, CR 26, CR 155); C. Melbourne and M. Gilbert, The behaviour of "
    "multiring brickwork arch bridges, Struct. Eng. 73 (1995)."
)
MEASURED = "experiment"


@dataclass(frozen=True)
class Tested:
    """A bridge and its failure load [kN]; lengths in m, ``share`` is the place of the load in the span."""

    shape: str
    span: float
    rise: float
    ring: float
    cover: float
    width: float
    share: float
    load: float
    footprint: float = 0.75


BRIDGES = {
    "Prestwood": Tested("segmental", 6.55, 1.428, 0.220, 0.165, 3.80, 0.25, 228.0, 0.30),
    "Torksey": Tested("segmental", 4.90, 1.155, 0.343, 0.246, 7.80, 0.25, 1080.0),
    "Strathmashie": Tested("segmental", 9.43, 2.990, 0.600, 0.411, 5.81, 0.25, 1325.0),
    "Bridgemill": Tested("parabolic", 18.30, 2.850, 0.711, 0.203, 8.30, 0.25, 3100.0),
    "Preston": Tested("elliptical", 4.95, 1.640, 0.360, 0.380, 5.70, 1 / 3, 2110.0),
    "Bargower": Tested("segmental", 10.36, 5.180, 0.588, 1.200, 8.68, 1 / 3, 5600.0),
    "Dundee": Tested("semicircular", 4.00, 2.000, 0.250, 0.250, 6.00, 0.25, 1050.0),
}
CASES = (("k = 0", 0.0, None), ("k = 1", 1.0, None), ("k = 3", 3.0, None), ("k = 1, f_c 5 MPa", 1.0, 5000.0))


def sweep_of(
    bridge: Tested, passive: float, strength: float | None, *, weights: tuple[float, float] = (20.0, 20.0), **more: Any
) -> Sweep:
    """Return the positions of an axle of 1 kN on a bridge, with weights of masonry and fill [kN/m3]."""
    law = concio.JointLaw(0.6, compressive_strength=strength)
    options: dict[str, Any] = {"ring": bridge.ring, "voussoirs": 60, "friction": law, "block": "rigid", **more}
    model = concio.bridge(
        shape=bridge.shape,  # type: ignore[arg-type]
        span=bridge.span, rise=bridge.rise, width=bridge.width, unit_weight=weights[0], **options,
    )  # fmt: skip
    filled = concio.with_fill(model, concio.Fill(cover=bridge.cover, unit_weight=weights[1], passive=passive))
    axle = concio.Vehicle("axle", (concio.Axle(0.0, 1.0),), footprint=bridge.footprint)
    return Sweep(concio.with_vehicle(filled, axle))


@cache
def bound(name: str, passive: float, strength: float | None) -> float:
    """Return the load at the position of the test beyond which nothing is in equilibrium [kN]."""
    bridge = BRIDGES[name]
    found = sweep_of(bridge, passive, strength).at(bridge.share * bridge.span)
    assert found is not None
    assert found.limit.checked
    return found.multiplier


@cache
def bolton(span: float, ring: float, rings: int, voussoirs: int, *, bonded: bool) -> float:
    """Return the same of a model bridge of several rings, for k = 1."""
    more = {"ring": ring if bonded else [ring / rings] * rings, "ring_friction": None if bonded else 0.6}
    bridge = Tested("segmental", span, span / 4, ring, 0.30, 2.88, 0.25, np.nan, 0.215)
    sweep = sweep_of(bridge, 1.0, None, weights=(22.6, 22.2), voussoirs=voussoirs, **more)
    found = sweep.at(0.25 * span)
    assert found is not None
    return found.multiplier


def rows() -> list[Row]:
    found = [
        Row(f"{name}, {text}", bridge.load, bound(name, k, strength), 0, MEASURED, "kN", check="experiment")
        for name, bridge in BRIDGES.items() for text, k, strength in CASES
    ]  # fmt: skip
    for text, load, (span, ring, rings, n), bonded in (
        ("Bolton 3 m, bonded, k = 1", 540.0, (3.0, 0.215, 2, 46), True),
        ("Bolton 3 m, debonded, mu 0.6, k = 1", 360.0, (3.0, 0.215, 2, 46), False),
        ("Bolton 5 m, bonded, k = 1", 1720.0, (5.0, 0.44, 4, 76), True),
        ("Bolton 5 m, debonded, mu 0.6, k = 1", 500.0, (5.0, 0.44, 4, 76), False),
    ):
        value = bolton(span, ring, rings, n, bonded=bonded)
        found.append(Row(text, load, value, 0, MEASURED, "kN", check="experiment"))
    return found


def figure(axes: Any) -> None:
    names = list(BRIDGES)
    for name, k, strength, mark in (("k = 0", 0.0, None, "v"), ("k = 3", 3.0, None, "^"), ("f_c 5 MPa", 1.0, 5e3, "s")):
        ratio = [bound(b, k, strength) / BRIDGES[b].load for b in names]
        axes.plot(range(len(names)), ratio, mark, ms=5, color="#222222", mfc="none", label=name)
    axes.axhline(1.0, color="#D55E00", lw=0.8)
    axes.set_xticks(range(len(names)), names, rotation=30, ha="right", fontsize=8)
    axes.set_ylabel("computed over measured")
    axes.legend(frameon=False, fontsize=8)
    axes.set_title("Bridges that were loaded to failure", fontsize=9, loc="left")
