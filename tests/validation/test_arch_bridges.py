"""Arch bridges beside numbers of an independent linear programme: rigid voussoirs, fill as weight, spread, passive.

Bare rings are its numbers to all digits. Spread is integrated along the extrados here, voussoir by voussoir there,
which is what the thousandth is for.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from arch_programme import Arch
from validation_cases import arch_bridges
from validation_cases.row import check

import concio
from concio.analysis.limit import dead_and_live
from concio.model.crossing import Axle, Vehicle
from concio.model.fill import Fill
from concio.model.road.earth import with_fill, with_vehicle
from concio.model.road.surface import Surface
from concio.solvers.statics.associated_limit import associated_limit
from samples import first

NO_SLIDING = 1e3


def multiplier(model: concio.Model) -> float:
    """Return the associated multiplier of the live load, proved from both sides."""
    dead, live = dead_and_live(concio.assemble(model), "live")
    found = associated_limit(dead, live)
    assert found.checked
    return found.multiplier


def under_an_axle(model: concio.Model, x: float, fill: Fill, footprint: float) -> float:
    """Return the axle load at x that is carried at most [kN]."""
    axle = Vehicle("axle", (Axle(0.0, 1.0),), position=x, footprint=footprint)
    return multiplier(with_vehicle(with_fill(model, fill), axle))


def under_a_knife(model: concio.Model, x: float) -> float:
    """Return the force on the extrados at x that is carried at most [kN]."""
    from dataclasses import replace

    surface = Surface.of(model)
    piece = int(np.searchsorted(surface.start[:, 0], x, side="right") - 1)
    at = (x, float(surface.height(np.array([x]))[0]))
    load = concio.Load("point", (0.0, -1.0), bodies=(model.bodies[surface.body[piece]].name,), at=at, group="live")
    return multiplier(replace(model, loads=(*model.loads, load)))


def prestwood(n: int = 80, ring: float = 0.22, **law: Any) -> concio.Model:
    """Return the barrel of Prestwood bridge."""
    joint = concio.JointLaw(NO_SLIDING, **law)
    return concio.bridge(span=6.55, rise=1.428, ring=ring, voussoirs=n, block="rigid", friction=joint, unit_weight=20.0,
                         width=3.8)  # fmt: skip


@pytest.mark.parametrize(
    ("k", "n", "ring", "cover", "share", "spread", "load"),
    first(9, [
        (1.0, 80, 0.22, 0.165, 0.25, "uniform 1:2", 161.79),
        (3.0, 80, 0.22, 0.165, 0.25, "uniform 1:2", 211.24),
        (0.0, 80, 0.22, 0.165, 0.25, "none", 108.40),
        (1.0, 20, 0.22, 0.165, 0.25, "uniform 1:2", 165.65),
        (1.0, 40, 0.22, 0.165, 0.25, "uniform 1:2", 162.82),
        (1.0, 80, 0.22, 0.165, 0.50, "uniform 1:2", 416.3),
        (1.0, 80, 0.20, 0.165, 0.25, "uniform 1:2", 133.6),
        (1.0, 80, 0.24, 0.165, 0.25, "uniform 1:2", 191.5),
        (1.0, 80, 0.22, 0.100, 0.25, "uniform 1:2", 136.6),
        (0.0, 80, 0.22, 0.165, 0.25, "uniform 1:2", 121.99),
        (1.0, 80, 0.22, 0.165, 0.25, "none", 142.28),
        (3.0, 80, 0.22, 0.165, 0.25, "none", 182.58),
        (1.0, 160, 0.22, 0.165, 0.25, "uniform 1:2", 161.60),
        (1.0, 80, 0.22, 0.200, 0.25, "uniform 1:2", 175.2),
    ]),
)
def test_prestwood(k: float, n: int, ring: float, cover: float, share: float, spread: str, load: float) -> None:
    fill = Fill(cover=cover, unit_weight=20.0, passive=k, spread=spread)
    assert under_an_axle(prestwood(n, ring), share * 6.55, fill, 0.30) == pytest.approx(load, rel=1e-3)


@pytest.mark.parametrize(("k", "load"), [(0.0, 107.3), (1.0, 140.8), (3.0, 179.4)])
@pytest.mark.long
def test_prestwood_with_crushing(k: float, load: float) -> None:
    """Crushing joints meet the rectangular stress block to one per cent."""
    model = prestwood(compressive_strength=4500.0)
    fill = Fill(cover=0.165, unit_weight=20.0, passive=k)
    assert under_an_axle(model, 0.25 * 6.55, fill, 0.30) == pytest.approx(load, rel=1e-2)


def test_the_bare_ring_of_prestwood_under_a_knife_load() -> None:
    model = concio.bridge(span=6.55, rise=1.428, ring=0.22, voussoirs=80, block="rigid", friction=NO_SLIDING,
                          unit_weight=20.0)  # fmt: skip
    assert under_a_knife(model, 6.55 / 4) == pytest.approx(11.314083, rel=1e-6)


@pytest.mark.parametrize(("share", "load"), [(0.1, 139.808), (0.25, 85.122), (0.4, 93.633), (0.5, 157.945)])
def test_a_circular_arch_under_a_knife_load(share: float, load: float) -> None:
    model = concio.bridge(span=10.0, rise=3.0, ring=0.6, voussoirs=39, block="rigid", friction=0.6, unit_weight=22.0)
    assert under_a_knife(model, 10.0 * share) == pytest.approx(load, rel=1e-5)


def ringed(span: float, thickness: float, rings: int, n: int, mu: float | None, width: float = 1.0) -> concio.Model:
    """Return a barrel of so many rings, bonded where mu is None."""
    ring = thickness if mu is None else [thickness / rings] * rings
    return concio.bridge(span=span, rise=span / 4, ring=ring, voussoirs=n, block="rigid", friction=0.6,
                         ring_friction=mu, unit_weight=22.6, width=width)  # fmt: skip


@pytest.mark.parametrize(
    ("span", "thickness", "rings", "n", "mu", "load"),
    [
        (3.0, 0.215, 2, 46, None, 264.0),
        (3.0, 0.215, 2, 46, 0.6, 124.9),
        (3.0, 0.215, 2, 46, 0.5, 118.0),
        (3.0, 0.215, 2, 46, 0.3, 105.5),
        (3.0, 0.215, 2, 46, 0.0, 88.9),
        (5.0, 0.44, 4, 76, None, 904.2),
        (5.0, 0.44, 4, 76, 0.6, 204.3),
    ],
)
def test_rings(span: float, thickness: float, rings: int, n: int, mu: float | None, load: float) -> None:
    model = ringed(span, thickness, rings, n, mu, width=2.88)
    fill = Fill(cover=0.30, unit_weight=22.2, passive=1.0)
    assert under_an_axle(model, 0.25 * span, fill, 0.215) == pytest.approx(load, rel=1e-3)


@pytest.mark.parametrize(("mu", "load"), [(None, 16.4495), (0.6, 6.96394)])
def test_bare_rings_under_a_knife_load(mu: float | None, load: float) -> None:
    assert under_a_knife(ringed(3.0, 0.215, 2, 46, mu), 0.75) == pytest.approx(load, rel=1e-3)


def test_rings_tend_to_the_bonded_ring_with_friction() -> None:
    fill = Fill(cover=0.30, unit_weight=22.2, passive=1.0)
    found = [under_an_axle(ringed(3.0, 0.215, 2, 46, mu, 2.88), 0.75, fill, 0.215) for mu in (0.0, 0.6, 3.0, 1e4)]
    bonded = under_an_axle(ringed(3.0, 0.215, 2, 46, None, 2.88), 0.75, fill, 0.215)
    assert all(more >= less * (1 - 1e-9) for less, more in pairwise(found))
    assert found[-1] == pytest.approx(bonded, rel=5e-3)


def test_without_passive_pressure_the_fill_is_dead_load_alone() -> None:
    fill = [Fill(cover=0.165, unit_weight=20.0, passive=k) for k in (0.0, 1e-9)]
    x = 0.25 * 6.55
    none, little = (under_an_axle(prestwood(40), x, f, 0.30) for f in fill)
    assert little == pytest.approx(none, rel=1e-7)


@pytest.mark.long
def test_rows() -> None:
    check(arch_bridges.rows())


@pytest.mark.long
def test_the_worst_position_of_prestwood_is_found_to_ten_millimetres() -> None:
    """Beside a grid of 5 mm around it."""
    share, least = arch_bridges.worst_of_prestwood()
    sweep = arch_bridges.prestwood(1.0)
    around = [arch_bridges.load(sweep, share * 6.55 + d) for d in np.arange(-0.05, 0.051, 0.005)]
    assert least <= min(around) * (1 + 2e-5)


@pytest.mark.parametrize("k", [0.0, 3.0])
@pytest.mark.parametrize("share", [0.05, 0.15, 0.25, 0.5, 0.9])
def test_a_grid_of_positions_beside_a_programme_written_from_the_statement(k: float, share: float) -> None:
    """The edges of the bridge too, where abutments carry a part of the load; with joints that slide as well."""
    other = Arch(6.55, 1.428, 0.22, 40, 20.0, 20.0, 0.165, 0.30, 3.8, k, friction=0.6)
    model = concio.bridge(span=6.55, rise=1.428, ring=0.22, voussoirs=40, width=3.8, block="rigid", friction=0.6,
                          unit_weight=20.0)  # fmt: skip
    found = under_an_axle(model, share * 6.55, Fill(cover=0.165, unit_weight=20.0, passive=k), 0.30)
    assert found == pytest.approx(other.axle(share * 6.55), rel=1e-4)
