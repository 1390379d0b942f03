"""Beams on knife edges, a slab on three corners, a cube on a tilted foot: contacts without area.

A beam of 4.5 x 0.3 m weighs 27 kN and lies on the edges of two prisms, 1 and 4 m from its end: the lever gives its
reactions, and friction 0.6 what pushes it off. The reactions of a slab of 16 kN on three corners follow from three
equations. A cube whose foot rises by a small angle touches the ground along an edge and turns about it until its foot
lies flat: its middle sinks by half the rise of the foot, to first order in the tilt.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import concio
from concio import Body, JointLaw, Load, Model, Polyhedron, Rigid
from validation_cases.row import Row

SOURCE = "Statics of rigid bodies, by hand."

STONE, LAW = {"block": Rigid(unit_weight=20.0)}, {"joint": JointLaw(friction=0.6)}
CORNERS = np.array([(0.2, 0.2), (1.7, 0.3), (0.6, 1.5)])
TILTS = (1e-6, 1e-4, 1e-2, 0.1)


def beam(space: bool) -> Model:
    """A beam on two knife edges, pushed by a tenth of its weight."""
    knives = [Body(f"k{x:g}", [(x - 0.2, 0.5), (x + 0.2, 0.5), (x, 1.0)], kind="fixed") for x in (1.0, 4.0)]
    block = Body("beam", [(0, 1), (4.5, 1), (4.5, 1.3), (0, 1.3)], kind="rigid")
    loads = (Load("weight", (0.0, -1.0)), Load("weight", (0.1, 0.0), group="live"))
    model = Model((*knives, block), STONE, LAW, loads=loads)
    return concio.extrude(model, 1.0) if space else model


@cache
def slab() -> tuple[float, ...]:
    """Reactions of a slab on three corners [kN]."""
    square, sides = ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)), ((0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4))
    spikes = [
        Polyhedron(f"p{k}", [*((x + i, y + j, 0) for i, j in square), (x, y, 1)], ((3, 2, 1, 0), *sides), kind="fixed")
        for k, (x, y) in enumerate(CORNERS)
    ]
    block = Polyhedron.box("slab", (0, 0, 1), (2, 2, 1.2), kind="rigid")
    found = concio.solve(Model((*spikes, block), STONE, LAW, loads=(Load("weight", (0.0, 0.0, -1.0)),))).reactions
    return tuple(float(found[f"p{k}"][2]) for k in range(3))


def sunk(tilt: float) -> float:
    """How far the middle of a cube sinks that comes to rest on its tilted foot, over half the rise of the foot."""
    corners = np.array([(x, y, z + tilt * x * (z == 0)) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    bodies = (Polyhedron.box("g", (-5, -5, -1), (5, 5, 0), kind="fixed"), Polyhedron("b", corners, faces, kind="rigid"))
    result = concio.solve(Model(bodies, STONE, LAW, gap_tolerance=1e-9, loads=(Load("weight", (0.0, 0.0, -1.0)),)))
    return float(-result.node_displacement("b").mean(0)[2] / (tilt / 2))


def rows() -> list[Row]:
    found = []
    for space in (False, True):
        model, where = beam(space), "in space" if space else "in the plane"
        force = concio.solve(model, factors={"live": 0.0}).reactions
        for name, expected in (("k1", 15.75), ("k4", 11.25)):
            said, computed = f"beam on knife edges {where}: reaction of {name}", float(force[name][-1])
            found.append(Row(said, expected, computed, 1e-9, "rounding", "kN"))
        limit = concio.limit(model, path=False, steps=False, search=False).associated.multiplier
        found.append(Row(f"beam on knife edges {where}: multiplier that pushes it off", 6.0, limit, 1e-7, "programme"))
    expected = np.linalg.solve(np.vstack([np.ones(3), CORNERS.T]), np.full(3, 16.0))
    for k, (wanted, computed) in enumerate(zip(expected.tolist(), slab(), strict=True), 1):
        found.append(Row(f"slab on three corners: reaction of corner {k}", wanted, computed, 1e-7, "compliance", "kN"))
    for tilt in TILTS:
        reason = "second order in the tilt, and a nanometre by which joints yield"
        said, allowed = f"cube on a foot tilted by {tilt:g}: sinks by, of tilt/2", 1e-9 / tilt + tilt**2
        found.append(Row(said, 1.0, sunk(tilt), allowed, reason))
    return found
