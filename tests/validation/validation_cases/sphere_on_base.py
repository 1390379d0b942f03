r"""Elastic sphere on a rigid plane, pressed (Hertz) and pushed along it (Cattaneo, Mindlin); a cube that is pushed.

Hertz: contact radius :math:`a = (3 P R / 4 E^*)^{1/3}`, largest pressure :math:`p_0 = 3 P / (2 \pi a^2)`, with
:math:`E^* = E / (1 - \nu^2)`. Both are read from moments of the contact forces, which converge smoothly:
:math:`\sum t_n r^2 = 2 P a^2 / 5`. A force Q along the plane makes a ring of slip round a disc of radius c that sticks,

.. math:: c / a = (1 - Q / \mu P)^{1/3}, \qquad \sum t_x r^2 = \mu \sum t_n r^2 \,(1 - (c / a)^5),

where the first is the theory and the second reads c from the friction forces computed. The theory has pressure and
friction that do not act on each other, which they do not between a rigid plane and a body of Poisson's ratio one half;
0.45 is taken here. Of the body only the part around the contact is modelled: a block eight contact radii deep, a half
or a quarter of it by symmetry, whose top is moved, with the gap r^2 / 2 R of the sphere below; and for the pressed one
once more with the shape itself, a paraboloid whose facets over a rectangular grid are plane.

A cube on a plane, lower than it is wide, carries a push along the plane up to mu times its weight whatever its
stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

import concio
from concio.model.surfaces import from_grid
from validation_cases.row import Row

SOURCE = (
    "H. Hertz, J. reine angew. Math. 92 (1882); C. Cattaneo, Rend. Accad. Lincei 27 (1938); R. D. Mindlin, J. Appl. "
    "Mech. 16 (1949); K. L. Johnson, Contact Mechanics (1985), ch. 4 and 7."
)

RADIUS, MODULUS, HALF_WIDTH, SIDE = 10.0, 1e6, 0.05, 0.4
FINE, COVERED = 4, 1.25
"""Elements on the contact radius, and how far beyond it they reach."""


def lines(elements: int, growth: float) -> np.ndarray:
    """Positions of mesh lines: even under the contact, then growing towards the side of the block."""
    x = list(np.linspace(0.0, COVERED * HALF_WIDTH, round(COVERED * elements) + 1))
    step = x[1]
    while x[-1] + growth * step < 0.9 * SIDE:
        step *= growth
        x.append(x[-1] + step)
    return np.array([*x, SIDE])


def faces(body: concio.Polyhedron, axis: int, sign: int) -> list[tuple[tuple[float, float, float], ...]]:
    """Polygons of the faces whose outward normal is along an axis."""
    found = [k for k, n in enumerate(body.normals) if sign * n[axis] > 1 - 1e-9]
    return [tuple((float(x), float(y), float(z)) for x, y, z in body.vertices[list(body.faces[k])]) for k in found]


@dataclass(frozen=True, eq=False)
class Pressed:
    """A solved contact; forces of the part of it that is modelled, which is ``1 / parts`` of the whole."""

    result: concio.Result
    nu: float
    parts: int

    @property
    def radius(self) -> np.ndarray:
        """Distance of each point of contact from the axis [m]."""
        return np.hypot(*self.result.contacts.point[:, :2].T)

    @property
    def force(self) -> float:
        """P [kN]."""
        return self.parts * float(self.result.contacts.normal_force.sum())

    @property
    def hertz(self) -> tuple[float, float]:
        """Radius [m] and largest pressure [kN/m2] that theory gives for the force."""
        a = (3 * self.force * RADIUS * (1 - self.nu**2) / (4 * MODULUS)) ** (1 / 3)
        return a, 3 * self.force / (2 * np.pi * a**2)

    @property
    def contact_radius(self) -> float:
        """a from the second moment of the pressure [m]."""
        t = self.result.contacts.normal_force
        return float(np.sqrt(2.5 * (t * self.radius**2).sum() / t.sum()))

    @property
    def pressure(self) -> float:
        """Pressure in the middle [kN/m2]."""
        middle = int(np.argmin(self.radius))
        return float(self.result.contacts.normal_force[middle] / self.result.assembly.pairs.area[middle])


@cache
def pressed(nu: float, friction: float = 0.0, share: float = 0.0, depth: float = 1.0) -> Pressed:
    """A flat block with the gap of a sphere below it, its top moved down and, with friction, along x."""
    x = lines(FINE, 2.2)
    around = np.concatenate([-x[:0:-1], x]) if friction else x
    grid = np.stack(np.meshgrid(around, x, x, indexing="ij"), -1)
    body = from_grid("sphere", grid)
    reach = COVERED * HALF_WIDTH - 1e-4
    low = (-reach if friction else 0.0, 0.0, -0.2)
    shear, alone = MODULUS / 2 / (1 + nu), 1 - (1 - share) ** (2 / 3)
    force = 4 * MODULUS / (1 - nu**2) * HALF_WIDTH**3 / (3 * RADIUS)
    along = 1.1 * 3 * friction * force * (2 - nu) / (16 * shear * HALF_WIDTH) * alone
    down = depth * HALF_WIDTH**2 / RADIUS
    supports = [
        concio.Support("top", "sphere", polygon=faces(body, 2, 1)[0], displacement=(along, 0.0, -down)),
        concio.Support("middle plane", "sphere", polygon=faces(body, 1, -1)[0], directions="y"),
    ]
    if not friction:
        supports.append(concio.Support("other plane", "sphere", polygon=faces(body, 0, -1)[0], directions="x"))
    model = concio.Model(
        (concio.Polyhedron.box("base", low, (reach, reach, 0.0), kind="fixed"), body),
        {"block": concio.Elastic(E=MODULUS, nu=nu)}, {"joint": concio.JointLaw(friction=friction)},
        supports=tuple(supports), mesh_size=1.0,
    )  # fmt: skip
    assembly = concio.assemble(model)
    gap = (assembly.pairs.point[:, :2] ** 2).sum(1) / (2 * RADIUS)
    assembly = replace(assembly, pairs=replace(assembly.pairs, gap=gap))
    return Pressed(concio.solve(assembly), nu, 2 if friction else 4)


@cache
def shaped(elements: int = 3) -> Pressed:
    """A quarter of a paraboloid pressed by the force of the half-width, nothing but the model as a user writes it."""
    nu, x = 0.2, lines(elements, 2.0)
    height = (x[:, None] ** 2 + x**2) / (2 * RADIUS)
    grid = np.stack([*np.meshgrid(x, x, x, indexing="ij")], -1)
    grid[..., 2] = height[:, :, None] + (SIDE - height[:, :, None]) * x / SIDE
    body = from_grid("sphere", grid)
    top = faces(body, 2, 1)[0]
    force = 4 * MODULUS / (1 - nu**2) * HALF_WIDTH**3 / (3 * RADIUS)
    model = concio.Model(
        (concio.Polyhedron.box("base", (-1.0, -1.0, -0.2), (1.0, 1.0, 0.0), kind="fixed"), body),
        {"block": concio.Elastic(E=MODULUS, nu=nu)}, {"joint": concio.JointLaw(friction=0.0)},
        loads=(concio.Load("pressure", (force / 4 / SIDE**2,), polygon=top),),
        supports=tuple(
            concio.Support(name, "sphere", polygon=faces(body, axis, -1)[0], directions=name)
            for axis, name in enumerate("xy")
        ),
        gap_reach=(1.4 * HALF_WIDTH) ** 2 / (2 * RADIUS), mesh_size=1.0,
    )  # fmt: skip
    return Pressed(concio.solve(model), nu, 4)


def slip_ring(found: Pressed, friction: float) -> tuple[float, float]:
    """Radius that sticks over the contact radius: of theory for the forces found, and from moments of the friction."""
    contacts = found.result.contacts
    t, f = contacts.normal_force, contacts.force_on_b[:, 0]
    theory = (1 - abs(f.sum()) / (friction * t.sum())) ** (1 / 3)
    share = abs((f * found.radius**2).sum()) / (friction * (t * found.radius**2).sum())
    return float(theory), float((1 - share) ** (1 / 5))


def cube(push: float) -> concio.Model:
    """An elastic cube on a plane, friction 0.3, pushed by a share of its weight."""
    return concio.Model(
        (
            concio.Polyhedron.box("ground", (-3.0, -3.0, -1.0), (3.0, 3.0, 0.0), kind="fixed"),
            concio.Polyhedron.box("cube", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        ),
        {"block": concio.Elastic(E=1e4, nu=0.3, unit_weight=20.0)}, {"joint": concio.JointLaw(friction=0.3)},
        loads=(
            concio.Load("weight", (0.0, 0.0, -1.0)),
            concio.Load("weight", (push * 0.6, push * 0.8, 0.0), group="live"),
        ),
        mesh_size=0.5,
    )  # fmt: skip


def rows() -> list[Row]:
    found = []
    coarse = "four elements on the contact radius, a block of eight radii"
    for depth in (1.0, 0.5):
        state = pressed(0.2, depth=depth)
        radius, pressure = state.hertz
        words = f"top moved by {depth:g} a^2 / R"
        found += [
            Row(f"contact radius, {words}", radius, state.contact_radius, 0.02, coarse, "m"),
            Row(f"largest pressure, {words}", pressure, state.pressure, 0.01, coarse, "kN/m2"),
        ]
    state = shaped()
    radius, pressure = state.hertz
    found += [
        Row("paraboloid of facets: contact radius", radius, state.contact_radius, 0.03, "three facets on it", "m"),
        Row("paraboloid of facets: force on the base",
            4 / 3 * MODULUS / (1 - 0.2**2) * HALF_WIDTH**3 / RADIUS, state.force, 1e-5,
            "equilibrium, facets inclined by up to their slope", "kN"),
    ]  # fmt: skip
    for share in (0.5, 0.8):
        theory, read = slip_ring(pressed(0.45, 0.5, share), 0.5)
        found.append(
            Row(f"disc that sticks over contact radius, Q about {share:g} mu P", theory, read, 0.015,
                "four elements on the contact radius, Poisson's ratio 0.45")
        )  # fmt: skip
    for share, holds in ((0.999, 1.0), (1.001, 0.0)):
        state = concio.solve(cube(share * 0.3), on_failure="return")
        found.append(
            Row(f"elastic cube pushed by {share:g} mu of its weight: held", holds, float(state.solved), 0.0,
                "yes or no")
        )  # fmt: skip
    limit = concio.limit(cube(1.0), path=False, steps=False, search=False).associated
    pushed = limit.multiplier if limit.checked else np.nan
    found.append(Row("elastic cube: multiplier of the push", 0.3, pushed, 1e-9, "closed form"))
    return found


def figure(axes: Any) -> None:
    """Friction under the sphere beside the theory."""
    state = pressed(0.45, 0.5, 0.5)
    a, p0 = state.hertz
    c, _ = slip_ring(state, 0.5)
    s = np.linspace(0.0, 1.0, 400)
    normal = np.sqrt(1 - s**2)
    axes.plot(s, normal, "k--", lw=1, label="pressure (Hertz)")
    axes.plot(s, normal - c * np.sqrt(np.maximum(1 - (s / c) ** 2, 0.0)), "k-", lw=1, label="friction / mu (Cattaneo)")
    contacts, area = state.result.contacts, state.result.assembly.pairs.area
    r = state.radius / a
    axes.plot(r, contacts.normal_force / area / p0, "o", ms=3, mfc="none", label="pressure, concio")
    axes.plot(r, np.abs(contacts.force_on_b[:, 0]) / area / (0.5 * p0), "s", ms=3, label="friction / mu, concio")
    axes.set(xlim=(0, 1.3), ylim=(0, 1.1), xlabel="r / a", ylabel="traction / p0")
    axes.legend(fontsize=7)
