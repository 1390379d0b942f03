r"""Elastic blocks in space: uniform states on distorted meshes and through unlike ones, and bending.

A uniform state of stress must come out whatever the shape of the elements (patch test): a block of 3 x 3 x 3 hexahedra
with its inner nodes moved about, an L-shaped block of tetrahedra. It must also pass a joint between meshes that do not
match. A cantilever of length L under an end force has the deflection of beam theory,

.. math:: \frac{P L^3}{3 E I} + \frac{P L}{5/6\, G A},

at nu = 0, where its clamped end may not warp but the rest of it bends as beams do. Eight-node hexahedra with
incompatible modes (H8I) bend with one element through the depth; without these modes (H8) they lock, which is why they
are not the default. Hexahedra that lean over lose some of it.

Turning a structure in space turns its answer: meshes, displacements, resultants of joints, and even the forces of
redundant pairs, which are not unique and of which the least are reported.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import concio
from concio.kinematics.rigid import rotation_matrix
from concio.model.surfaces import from_grid, prism
from validation_cases.row import Row

SOURCE = (
    "Timoshenko and Goodier, Theory of Elasticity; patch test: B. M. Irons and A. Razzaque (1972); modes: E. L. Wilson "
    "et al. (1973), R. L. Taylor, P. J. Beresford and E. L. Wilson (1976)."
)

Polygon = tuple[tuple[float, float, float], ...]
ROUND = "linear displacements are in the element's space: only rounding is left"
PRESSURE = 120.0


def polygons(body: concio.Polyhedron, axis: int, sign: int) -> list[Polygon]:
    """Polygons of the faces whose outward normal is along an axis."""
    found = [k for k, n in enumerate(body.normals) if sign * n[axis] > 1 - 1e-9]
    return [tuple((float(x), float(y), float(z)) for x, y, z in body.vertices[list(body.faces[k])]) for k in found]


def on_rollers(*bodies: concio.Polyhedron, top: str, low: str, **fields: Any) -> concio.Model:
    """Blocks under uniform pressure on the upper faces of one, rollers on two sides and below another."""
    named = {b.name: b for b in bodies}
    loads = tuple(concio.Load("pressure", (PRESSURE,), polygon=p) for p in polygons(named[top], 2, 1))
    supports = []
    for body in bodies:
        for axis, name in enumerate("xyz"):
            if name == "z" and body.name != low:
                continue
            supports += [
                concio.Support(f"{body.name} {name}", body.name, polygon=p, directions=name)
                for p in polygons(body, axis, -1)
            ]
    return concio.Model(
        bodies, {"block": concio.Elastic(1e5, 0.3)}, {"joint": concio.JointLaw(0.5)}, loads=loads,
        supports=tuple(supports), **fields,
    )  # fmt: skip


def distorted() -> concio.Polyhedron:
    """A block 1.5 x 1 x 1.2 of 3 x 3 x 3 hexahedra with inner nodes moved by up to a fifth of their size."""
    rng = np.random.default_rng(3)
    x = np.linspace(0.0, 1.0, 4)
    grid = np.stack(np.meshgrid(1.5 * x, x, 1.2 * x, indexing="ij"), -1)
    grid[1:3, 1:3, 1:3] += rng.uniform(-0.07, 0.07, (2, 2, 2, 3))
    return from_grid("a", grid)


def l_shape() -> concio.Polyhedron:
    """An L in plan, 0.9 high; only tetrahedra and wedges fill it."""
    ring = np.array([[0, 0, 0], [1.4, 0, 0], [1.4, 0.5, 0], [0.6, 0.5, 0], [0.6, 1.1, 0], [0, 1.1, 0]], dtype=float)
    return prism("a", [ring], np.array([0.0, 0.0, 0.9]))


def worst_stress(result: concio.Result) -> float:
    """Largest difference of any nodal stress from uniaxial compression, over the pressure."""
    wanted = np.array([0.0, 0.0, -PRESSURE, 0.0, 0.0, 0.0])
    parts = [result.stress.at_nodes(b) - wanted for b in range(len(result.model.bodies))]
    return max(float(np.abs(p).max()) for p in parts) / PRESSURE


@cache
def patch(element: str) -> float:
    body = l_shape() if element in ("T4", "T10") else distorted()
    model = on_rollers(body, top="a", low="a", element=element, mesh_size=0.5 if element in ("T4", "T10") else 2.0)
    return worst_stress(concio.solve(model))


@cache
def through_joint(element: str) -> float:
    low = concio.Polyhedron.box("low", (0, 0, 0), (1, 0.8, 0.6), mesh_size=0.5)
    high = concio.Polyhedron.box("high", (0, 0, 0.6), (1, 0.8, 1.1), mesh_size=0.35)
    return worst_stress(concio.solve(on_rollers(low, high, top="high", low="low", element=element)))


LENGTH, DEPTH, WIDTH, FORCE, MODULUS = 8.0, 1.0, 0.6, 3.0, 2e6


def beam_theory() -> float:
    inertia = WIDTH * DEPTH**3 / 12
    shear = FORCE * LENGTH / (5 / 6 * MODULUS / 2 * WIDTH * DEPTH)
    return FORCE * LENGTH**3 / (3 * MODULUS * inertia) + shear


@cache
def deflection(element: str, along: int, deep: int = 1, lean: float = 0.0) -> float:
    """Deflection of the end of a clamped beam of so many elements; ``lean`` moves every second cross-section."""
    x, y, z = np.linspace(0, LENGTH, along + 1), np.array([0.0, WIDTH]), np.linspace(0, DEPTH, deep + 1)
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), -1)
    grid[1:-1:2, :, :, 0] += lean * (grid[1:-1:2, :, :, 2] - 0.5 * DEPTH)
    grid[2:-1:2, :, :, 0] -= lean * (grid[2:-1:2, :, :, 2] - 0.5 * DEPTH)
    beam = from_grid("beam", grid)
    end = polygons(beam, 0, 1)[0]
    model = concio.Model(
        (beam,), {"block": concio.Elastic(MODULUS, 0.0)}, {"joint": concio.JointLaw(0.5)}, element=element,
        loads=(concio.Load("traction", (0.0, 0.0, -FORCE / (WIDTH * DEPTH)), polygon=end),),
        supports=(concio.Support("clamp", "beam", polygon=polygons(beam, 0, -1)[0]),), mesh_size=2 * LENGTH,
    )  # fmt: skip
    result = concio.solve(model)
    tip = np.abs(result.nodes(0)[:, 0] - LENGTH) < 1e-9
    return -float(result.node_displacement(0)[tip, 2].mean())


@cache
def turned(element: str = "H8I", *, corner: bool = False) -> tuple[float, float, float]:
    """Largest relative differences of displacements, joint resultants and corner forces of a bond turned in space."""
    turn = rotation_matrix(np.array([0.4, -0.7, 0.9]))
    plane = concio.wall(length=1.0, height=0.5, block_size=(0.5, 0.25), horizontal=0.2, friction=0.4)
    model = replace(concio.extrude(plane, 0.3), element=element)
    if corner:
        lines = (((0.0, 0.0), (0.0, 1.0)), ((0.0, 0.0), (1.0, 0.0)))
        model = concio.walls(
            lines=lines, height=0.5, block_size=(0.5, 0.25, 0.25), friction=0.5, horizontal=0.2, towards=(-1, 0),
            element=element,
        )  # fmt: skip
    blocks = tuple(
        replace(b, vertices=b.vertices @ turn.T, grid=None if b.grid is None else b.grid @ turn.T)
        for b in model.polyhedra
    )
    loads = tuple(replace(load, value=tuple((turn @ load.value).tolist())) for load in model.loads)
    one, other = concio.solve(model), concio.solve(replace(model, bodies=blocks, loads=loads))
    size = float(np.abs(one.displacement).max())
    worst = 0.0
    for b, block in enumerate(model.bodies):
        if block.kind == "fixed":
            continue
        at, u = one.nodes(b) @ turn.T, one.node_displacement(b) @ turn.T
        for x, v in zip(other.nodes(b), other.node_displacement(b), strict=True):
            worst = max(worst, float(np.abs(u[np.argmin(np.linalg.norm(at - x, axis=1))] - v).max()))
    force = float(np.abs(one.total_load).max())
    joints, others = one.joints_in_space, other.joints_in_space
    resultants = max(
        float(np.abs(joints.force @ turn.T - others.force).max()), float(np.abs(joints.M @ turn.T - others.M).max())
    )
    found = {}
    for result, back in ((one, np.eye(3)), (other, turn)):
        pairs = result.contacts.pairs
        at = np.round(np.column_stack([pairs.body_a, pairs.body_b, pairs.point @ back]), 6) + 0.0
        found[id(result)] = (result.contacts.force_on_b @ back)[np.lexsort(at.T)]
    corners = float(np.abs(found[id(one)] - found[id(other)]).max())
    return worst / size, resultants / force, corners / force


def rows() -> list[Row]:
    found = [
        Row(f"uniform stress, distorted mesh, {element}", 0.0, patch(element), 1e-9, ROUND)
        for element in ("H8", "H8I", "H27", "T4", "T10")
    ]
    found += [
        Row(f"uniform stress through unlike meshes, {element}", 0.0, through_joint(element), 1e-8, ROUND)
        for element in ("H8I", "H27", "T4", "T10")
    ]
    exact = beam_theory()
    found += [
        Row("cantilever, 8 H8I", exact, deflection("H8I", 8), 0.01, "one element through the depth", "m"),
        Row("cantilever, 16 x 2 H8I", exact, deflection("H8I", 16, 2), 4e-3, "twice as fine", "m"),
        Row("cantilever, 8 H8I that lean by 11 degrees", exact, deflection("H8I", 8, 1, 0.2), 0.1,
            "leaning elements stiffen", "m"),
        Row("cantilever, 4 H27", exact, deflection("H27", 4), 0.01, "two nodes through each half", "m"),
        Row("cantilever, 8 T10 cells", exact, deflection("T10", 8), 0.01, "six T10 in each cell", "m"),
    ]  # fmt: skip
    found.append(
        Row("cantilever, 8 H8 without modes locks", 1.0, float(deflection("H8", 8) < 0.75 * exact), 0.0, "yes or no")
    )
    cases = {
        "a wall": turned(), "a corner of two walls": turned(corner=True), "the same of T4": turned("T4", corner=True)
    }  # fmt: skip
    what = ("displacements", "resultants of joints", "corner forces")
    for name, differences in cases.items():
        found += [
            Row(f"{name} turned in space: {of}", 0.0, difference, 1e-9, "rounding", check="second method")
            for of, difference in zip(what, differences, strict=True)
        ]
    return found
