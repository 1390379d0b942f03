r"""Arch bridges with fill under one axle.

Rigid voussoirs between radial joints; fill as vertical strips of weight between the extrados and a level road; the axle
as a strip of length b, uniform over b + z at the depth z; against each voussoir the soil presses with at most
:math:`k \gamma_f z\, \mathrm{d}y\, w`. An independent linear programme of the same statement gives the numbers; it
integrates the spread voussoir by voussoir, here it is integrated along the extrados.

A second programme, in `tests/validation/arch_programme.py`, is written from the statement alone and gives the load at
positions along the span; there both integrate the spread along the extrados. The crushing joints have graded contact
points, the programmes the rectangular stress block; beside the second one the difference is below a thousandth.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from arch_programme import Arch

import concio
from concio.analysis.bridges.sweep import Sweep, search
from validation_cases.row import Row

SOURCE = (
    "Independent linear programmes of the same statement (two codes agree on the bare ring)."
)

SPREAD = "the spread is integrated along the extrados here, voussoir by voussoir there"
BLOCK = "graded contact points meet the rectangular stress block to one per cent"
CRUSHES = "twenty graded contact points stand for the rectangular stress block of the programme"
PROGRAMME = "the programme integrates weights and spread in strips"


@cache
def prestwood(
    k: float, spread: str = "uniform 1:2", strength: float | None = None, n: int = 80, ring: float = 0.22,
    cover: float = 0.165,
) -> Sweep:  # fmt: skip
    """Prestwood bridge under one axle of 1 kN."""
    law = concio.JointLaw(1e3, compressive_strength=strength)
    model = concio.bridge(span=6.55, rise=1.428, ring=ring, voussoirs=n, width=3.8, block="rigid", friction=law,
                          unit_weight=20.0)  # fmt: skip
    return _under_an_axle(model, concio.Fill(cover=cover, unit_weight=20.0, passive=k, spread=spread), 0.30)


@cache
def rings(span: float, thickness: float, number: int, n: int, mu: float | None) -> Sweep:
    """A model bridge of several rings, bonded where mu is None, under one axle of 1 kN."""
    options: dict[str, Any] = {"span": span, "rise": span / 4, "voussoirs": n, "width": 2.88, "block": "rigid"}
    ring = thickness if mu is None else [thickness / number] * number
    model = concio.bridge(ring=ring, ring_friction=mu, friction=0.6, unit_weight=22.6, **options)
    return _under_an_axle(model, concio.Fill(cover=0.30, unit_weight=22.2, passive=1.0), 0.215)


def _under_an_axle(model: concio.Model, fill: concio.Fill, footprint: float) -> Sweep:
    axle = concio.Vehicle("axle", (concio.Axle(0.0, 1.0),), footprint=footprint)
    return Sweep(concio.with_vehicle(concio.with_fill(model, fill), axle))


def load(sweep: Sweep, x: float) -> float:
    """Return the axle load at x beyond which nothing is in equilibrium [kN]."""
    found = sweep.at(x)
    assert found is not None
    assert found.limit.checked
    return found.multiplier


@cache
def worst_of_prestwood() -> tuple[float, float]:
    """Return the worst position as a share of the span, and its load [kN], for k = 1."""
    found = min(search(prestwood(1.0), step=0.3, worst=1), key=lambda s: s.multiplier)
    return min(found.position, 6.55 - found.position) / 6.55, found.multiplier


def rows() -> list[Row]:
    quarter = 0.25 * 6.55
    found = [
        Row(f"Prestwood, k = {k:g}, axle at L/4", expected, load(prestwood(k), quarter), 1e-3, SPREAD, "kN",
            check="second method") for k, expected in ((0.0, 121.99), (1.0, 161.79), (3.0, 211.24))
    ]  # fmt: skip
    found += [
        Row(f"Prestwood, k = {k:g}, without spread", expected, load(prestwood(k, "none"), quarter), 1e-3, SPREAD, "kN",
            check="second method") for k, expected in ((0.0, 108.40), (1.0, 142.28), (3.0, 182.58))
    ]  # fmt: skip
    found += [
        Row(f"Prestwood, k = {k:g}, f_c = 4.5 MPa", expected, load(prestwood(k, strength=4500.0), quarter), 1e-2, BLOCK,
            "kN", check="second method") for k, expected in ((0.0, 107.3), (1.0, 140.8), (3.0, 179.4))
    ]  # fmt: skip
    others: tuple[tuple[str, float, dict[str, Any]], ...] = (
        ("20 voussoirs", 165.65, {"n": 20}), ("40 voussoirs", 162.82, {"n": 40}), ("160 voussoirs", 161.60, {"n": 160}),
        ("ring of 0.20 m", 133.6, {"ring": 0.20}), ("ring of 0.24 m", 191.5, {"ring": 0.24}),
        ("cover of 0.10 m", 136.6, {"cover": 0.10}), ("cover of 0.20 m", 175.2, {"cover": 0.20}),
    )  # fmt: skip
    found += [
        Row(f"Prestwood, k = 1, {what}", expected, load(prestwood(1.0, **changed), quarter), 1e-3, SPREAD, "kN",
            check="second method") for what, expected, changed in others
    ]  # fmt: skip
    found.append(Row("Prestwood, k = 1, axle at the crown", 416.3, load(prestwood(1.0), 3.275), 1e-3, SPREAD, "kN",
                     check="second method"))  # fmt: skip
    share, _ = worst_of_prestwood()
    nearer = float(share < 0.25)
    found.append(Row("Prestwood, k = 1: the worst position lies nearer to the springing than L/4", 1.0, nearer, 0,
                     "yes or no"))  # fmt: skip
    for what, expected, mu in (("bonded", 264.0, None), ("mu 0.6", 124.9, 0.6), ("mu 0.5", 118.0, 0.5),
                               ("mu 0.3", 105.5, 0.3), ("mu 0", 88.9, 0.0)):  # fmt: skip
        found.append(Row(f"two rings over 3 m, between them {what}", expected, load(rings(3.0, 0.215, 2, 46, mu), 0.75),
                         1e-3, SPREAD, "kN", check="second method"))  # fmt: skip
    for what, expected, mu in (("bonded", 904.2, None), ("mu 0.6", 204.3, 0.6)):
        found.append(Row(f"four rings over 5 m, between them {what}", expected, load(rings(5.0, 0.44, 4, 76, mu), 1.25),
                         1e-3, SPREAD, "kN", check="second method"))  # fmt: skip
    other = Arch(6.55, 1.428, 0.22, 80, 20.0, 20.0, 0.165, 0.30, 3.8, 1.0)
    for tenth in range(1, 11):
        x = 0.05 * tenth
        found.append(Row(f"Prestwood, k = 1, axle at {x:.2f} L", other.axle(x * 6.55), load(prestwood(1.0), x * 6.55),
                         1e-4, PROGRAMME, "kN", check="second method"))  # fmt: skip
    for k in (0.0, 1.0, 3.0):
        block = Arch(6.55, 1.428, 0.22, 80, 20.0, 20.0, 0.165, 0.30, 3.8, k, strength=4500.0).axle(quarter)
        crushed = load(prestwood(k, strength=4500.0), quarter)
        found.append(Row(f"Prestwood, k = {k:g}, f_c = 4.5 MPa, beside the second programme", block, crushed, 1e-3,
                         CRUSHES, "kN", check="second method"))  # fmt: skip
    return found


def figure(axes: Any) -> None:
    for k, style in ((0.0, "-"), (1.0, "--"), (3.0, ":")):
        x = np.linspace(0.35, 6.2, 41)
        axes.plot(x / 6.55, [load(prestwood(k, n=40), float(v)) for v in x], style, color="#222222", label=f"k = {k:g}")
    axes.axhline(228.0, color="#D55E00", lw=0.8)
    axes.annotate("measured, axle at L/4", (0.02, 228.0), (0, 3), textcoords="offset points", ha="left", fontsize=8)
    axes.set_ylim(0, 600)
    axes.set_xlabel("x / L")
    axes.set_ylabel("axle load [kN]")
    axes.legend(frameon=False, fontsize=8)
    axes.set_title("Prestwood bridge, bound over the position", fontsize=9, loc="left")
