r"""Rigid blocks in space, pushed in any direction.

A box a x b x h on a plane under a horizontal force in proportion to its weight, in plan direction phi from side a,
slides at mu or topples over the nearer edge,

.. math:: \min(\mu,\ (a/h)/|\cos\varphi|,\ (b/h)/|\sin\varphi|),

whichever comes first; friction is the same in all directions. A tripod topples over the line through two of its feet.
A tilted plane holds a box while the steepest slope, :math:`\sqrt{\tan^2\alpha + \tan^2\beta}` of two tilts, is at most
mu. A stack of n books overhangs by half the harmonic sum; at the share s of that, books h thick, a force
along the overhang topples all five at (1 - s)/(n h). A square joint under central load carries the torsion
0.382598 mu N a with points over the whole face, as under uniform pressure, and 0.707107 mu N a with its corners alone:
the choice of contact points matters there, and every result names it. A rectangle a x b has the mean distance from its
centre in the place of 0.382598 a.

Walls of the plane made 0.3 m thick have its multiplier along their plane; out of it they topple at t / H whatever the
bond. Barrel vaults of any length and bond, pushed across, have the multiplier of the arch.

Elastic walls held between smooth planes move as in plane strain, slips and open joints included; blocks of quadratic
elements, whose facets meet through quadratic dual functions, do so too.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

import concio
from concio.model.surfaces import prism
from concio.problem.contact_problem import ContactProblem
from concio.solvers.statics.associated_limit import associated_limit
from validation_cases import ferris_tin_loi
from validation_cases.row import Row

SOURCE = "closed forms; uniform pressure under a square: mean distance from its centre."

STONE = {"stone": concio.Rigid(unit_weight=1.0)}
BLOCK = {"kind": "rigid", "material": "stone"}
ROUNDING = "closed form, exact for rigid blocks"


def pushed(bodies: tuple[concio.Polyhedron, ...], direction: tuple[float, ...], mu: float, **options: object) -> float:
    """Multiplier of a force in proportion to the weights."""
    loads = (concio.Load("weight", (0.0, 0.0, -1.0)), concio.Load("weight", direction, group="live"))
    model = concio.Model(bodies, STONE, {"joint": concio.JointLaw(friction=mu)}, loads=loads, **options)
    found = concio.limit(model, path=False, steps=False, search=False).associated
    return found.multiplier if found.checked else np.nan


def ground(size: float = 6.0) -> concio.Polyhedron:
    return concio.Polyhedron.box("ground", (-size, -size, -1.0), (size, size, 0.0), kind="fixed")


def on_plane(phi: float, mu: float) -> float:
    """Box 2 x 1 x 3 on a plane pushed in plan direction phi [degrees]."""
    box = concio.Polyhedron.box("box", (-1.0, -0.5, 0.0), (1.0, 0.5, 3.0), **BLOCK)
    angle = np.radians(phi)
    return pushed((ground(), box), (float(np.cos(angle)), float(np.sin(angle)), 0.0), mu)


def tripod(phi: float) -> float:
    """Prism over the triangle of feet at 0, 120, 240 degrees from the centre, its centroid one above the plane."""
    feet = np.array([[np.cos(a), np.sin(a), 0.0] for a in np.radians([0.0, 120.0, 240.0])])
    body = prism("tripod", [feet], np.array([0.0, 0.0, 2.0]), **BLOCK)
    angle = np.radians(phi)
    return pushed((ground(), body), (float(np.cos(angle)), float(np.sin(angle)), 0.0), 2.0)


def tilted(alpha: float, beta: float, mu: float) -> bool:
    """Whether a flat box rests where gravity is inclined as on a plane of two tilts [degrees]."""
    box = concio.Polyhedron.box("box", (-1.0, -0.7, 0.0), (1.0, 0.7, 0.2), **BLOCK)
    pull = (float(np.tan(np.radians(alpha))), float(np.tan(np.radians(beta))), -1.0)
    laws = {"joint": concio.JointLaw(friction=mu)}
    model = concio.Model((ground(), box), STONE, laws, loads=(concio.Load("weight", pull),))
    return bool(concio.solve(model, on_failure="return").solved)


def books(share: float, count: int = 5) -> float:
    """Multiplier of a force along the overhang of a stack at a share of its greatest overhang."""
    gaps = [share * 0.5 / k for k in range(count, 0, -1)]  # from the bottom book, which overhangs the table
    bodies = [concio.Polyhedron.box("table", (-4.0, -1.0, -1.0), (0.0, 1.0, 0.0), kind="fixed")]
    x = 0.0
    for k, gap in enumerate(gaps):
        x += gap
        bodies.append(concio.Polyhedron.box(f"book {k}", (x - 1.0, -0.4, 0.1 * k), (x, 0.4, 0.1 * (k + 1)), **BLOCK))
    return pushed(tuple(bodies), (1.0, 0.0, 0.0), 0.9)


def mean_radius(a: float, b: float) -> float:
    """Mean distance of the points of a rectangle from its centre [m]."""
    d = float(np.hypot(a, b))
    return d / 6 + a**2 / (12 * b) * np.log((b + d) / a) + b**2 / (12 * a) * np.log((a + d) / b)


def torsion(points: int | str, length: float = 1.0) -> float:
    """Torsion of a block ``length`` x 1 pressed on the ground over mu N, points by a choice of the model."""
    cube = concio.Polyhedron.box("cube", (-0.5 * length, -0.5, 0.0), (0.5 * length, 0.5, 1.0), **BLOCK)
    loads = (concio.Load("weight", (0.0, 0.0, -1.0)),)
    laws = {"joint": concio.JointLaw(friction=0.5)}
    assembly = concio.assemble(concio.Model((ground(), cube), STONE, laws, loads=loads, contact_points=points))
    problem = assembly.problem()
    twist = np.zeros(problem.unknowns)
    twist[5] = 1.0 / assembly.disc.reach[1]  # a moment of one about the vertical axis
    found = associated_limit(pressed_by_weight(problem), twist)
    return found.multiplier / 0.5 if found.checked else np.nan  # friction 0.5, N = 1 of the law held


def pressed_by_weight(problem: ContactProblem) -> ContactProblem:
    """The joint with the uniform pressure that weight gives it held: a strength mu p at each point."""
    share = problem.area / problem.area.sum()
    law = problem.laws
    held = replace(law, friction=np.zeros(problem.pairs), cohesion=law.friction * share)
    return replace(problem, laws=held)


@cache
def wall_limit(direction: tuple[float, ...]) -> float:
    """Wall 1 of Ferris and Tin-Loi, 0.3 m thick: multiplier of a share of the weight in a direction."""
    space = concio.extrude(plane_wall(), 0.3)
    dead = tuple(load for load in space.loads if load.group == "dead")
    loads = (*dead, concio.Load("weight", direction, group="live"))
    found = concio.limit(replace(space, loads=loads), path=False, steps=False, search=False).associated
    return found.multiplier if found.checked else np.nan


@cache
def plane_wall() -> concio.Model:
    return ferris_tin_loi.model("wall 1")


@cache
def plane_limit() -> float:
    return concio.limit(plane_wall(), path=False, steps=False, search=False).associated.multiplier


def barrel_and_arch(blocks: int, length: float, bond: str) -> tuple[float, float]:
    """Multiplier of a horizontal share of the weight of a barrel vault, and of the arch it is made of."""
    common = {"span": 4.0, "ring": 0.5, "voussoirs": 11, "block": "rigid", "friction": 0.6}
    solid = concio.barrel(length=length, blocks=blocks, bond=bond, horizontal=1.0, **common)
    plane = concio.arch(edges="straight", horizontal=1.0, **common)
    multipliers = []
    for model in (solid, plane):
        found = concio.limit(model, path=False, steps=False, search=False).associated
        multipliers.append(found.multiplier if found.checked else np.nan)
    return multipliers[0], multipliers[1]


@cache
def plane_strain(share: float) -> tuple[float, int]:
    """Largest difference of the displacements of an elastic wall held in plane strain, and the number of slips."""
    return held_in_plane(concio.wall(length=1.5, height=0.75, plane="strain", horizontal=share, friction=0.3))


@cache
def quadratic(share: float, friction: float) -> tuple[float, int]:
    """The same for a column of quadratic elements."""
    size = {"width": 0.4, "height": 0.6, "blocks": 2, "mesh_size": 0.25}
    column = concio.column(plane="strain", horizontal=share, friction=friction, element="Q9", **size)
    return held_in_plane(column)


def held_in_plane(plane: concio.Model) -> tuple[float, int]:
    """Solve a plane model, and the same in space held in plane strain."""
    flat, solid = concio.solve(plane), concio.solve(concio.extrude(plane, 0.3, held=True))
    worst = 0.0
    for b, body in enumerate(plane.bodies):
        if body.kind == "fixed":
            continue
        at, u = flat.nodes(b), flat.node_displacement(b)
        for x, v in zip(solid.nodes(b), solid.node_displacement(b), strict=True):
            k = int(np.hypot(at[:, 0] - x[0], at[:, 1] - x[2]).argmin())
            worst = max(worst, float(np.abs(u[k] - v[[0, 2]]).max()))
    slips = int((np.asarray(solid.contacts.state) == 2).sum())
    return worst / float(np.abs(flat.displacement).max()), slips


def rows() -> list[Row]:
    corner = float(np.degrees(np.arctan(0.5)))
    exact = {0.0: 2 / 3, 15.0: 2 / 3 / float(np.cos(np.radians(15))), corner: 5**0.5 / 3, 45.0: 2**0.5 / 3, 90.0: 1 / 3}
    found = [
        Row(f"box 2 x 1 x 3, friction 0.9, pushed at {phi:.4g} degrees", value, on_plane(phi, 0.9), 1e-9, ROUNDING)
        for phi, value in exact.items()
    ]
    found += [
        Row(f"box, friction 0.3, pushed at {phi} degrees: it slides", 0.3, on_plane(phi, 0.3), 1e-9, ROUNDING)
        for phi in (0, 37, 90)
    ]
    found += [
        Row(f"tripod pushed at {phi} degrees", value, tripod(phi), 1e-9, ROUNDING)
        for phi, value in ((0, 1.0), (30, 1 / np.sqrt(3)), (60, 0.5))
    ]
    steep = float(np.hypot(np.tan(np.radians(12)), np.tan(np.radians(20))))
    for factor, holds in ((1.001, 1.0), (0.999, 0.0)):
        rests = float(tilted(12, 20, factor * steep))
        found.append(Row(f"box on two tilts, friction {factor} of the slope: rests", holds, rests, 0.0, "yes or no"))
    least = books(0.999)
    stack = float(sum(0.5 / k for k in range(1, 6)))
    found.append(Row("overhang of five books", 1.1416667, stack, 1e-7, "harmonic sum"))
    found.append(Row("five books at 0.999 of it: multiplier along the overhang", 0.002, least, 1e-8, ROUNDING))
    found += [
        Row("torsion of a square joint, corner points", np.sqrt(0.5), torsion("corners"), 1e-9, ROUNDING),
        Row("torsion of a square joint, 12 x 12 points", 0.382598, torsion(12), 2e-3, "12 x 12 points for the square"),
        Row("torsion of a joint 2 x 1, 12 x 12 points", mean_radius(2, 1), torsion(12, 2.0), 3e-3, "12 x 12 points"),
    ]
    found += [
        Row("wall extruded, pushed along: as in the plane", plane_limit(), wall_limit((1.0, 0.0, 0.0)), 1e-9, ROUNDING,
            check="second method"),
        Row("wall extruded, pushed out of its plane: t / H", 0.3 / 1.05, wall_limit((0.0, 1.0, 0.0)), 1e-9, ROUNDING),
        Row("wall extruded, pushed at 45 degrees in plan", 0.404061, wall_limit((0.5**0.5, 0.5**0.5, 0.0)), 2e-6,
            "six digits were kept", check="second method"),
    ]  # fmt: skip
    for blocks, length, bond in ((1, 1.0, "stack"), (3, 4.5, "stack"), (2, 3.0, "running")):
        solid, plane = barrel_and_arch(blocks, length, bond)
        found.append(
            Row(f"barrel {length:g} long, {bond} bond: the arch", plane, solid, 1e-9, ROUNDING, check="second method")
        )
    worst, slips = plane_strain(0.25)
    slipping, slips_of_column = quadratic(0.25, 0.3)
    found += [
        Row("elastic wall in plane strain: displacements as in the plane", 0.0, worst, 1e-8, "rounding",
            check="second method"),
        Row("elastic wall in plane strain: some pairs slip", 1.0, float(slips > 0), 0.0, "yes or no"),
        Row("column of H27 in plane strain, joints stick: displacements as in the plane", 0.0,
            quadratic(0.1, 0.9)[0], 1e-8, "rounding", check="second method"),
        Row("column of H27 in plane strain, joints slip: displacements as in the plane", 0.0, slipping, 1e-8,
            "rounding", check="second method"),
        Row("column of H27 in plane strain: some pairs slip", 1.0, float(slips_of_column > 0), 0.0, "yes or no"),
    ]  # fmt: skip
    return found
