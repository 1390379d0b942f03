"""Domes of revolution: hemispherical and segmental, closed by a key or open in an oculus.

Courses are rings between joints that point to the centre. In running bond every second ring is turned by half a block;
each block then is two cells wide, with a fold in the middle of its faces where the joint of its neighbours stands, so
that all faces are planar and fit each other. In stack bond the head joints run up the meridians.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.kinematics.frames import cross
from concio.model.generate.generator_arguments import choice, count, finite, not_negative, positive
from concio.model.generate.masonry import numbered
from concio.model.generate.solid_masonry import (
    CommonSpace,
    SolidPiece,
    assemble_space,
    checked_space,
    grid_piece,
    prism_piece,
)
from concio.model.model import Load, Model, Support

Array = np.ndarray


@strict_with(CommonSpace.__annotations__)
def dome(
    *,
    span: float | str,
    ring: float | str,
    courses: int,
    blocks: int,
    rise: float | str | None = None,
    oculus: float | str = 0.0,
    bond: Literal["running", "stack"] = "running",
    lantern: float | str = 0.0,
    spread: float | str = 0.0,
    **common: Unpack[CommonSpace],
) -> Model:
    """Return a dome on fixed springers.

    Parameters
    ----------
    span : float or str
        Clear diameter at the springing [m].
    ring : float or str
        Thickness [m].
    courses : int
        Rings of blocks, the key not counted.
    blocks : int
        Blocks in a ring, at least 4.
    rise : float or str, optional
        Rise of the intrados; half the span, a hemisphere, by default [m].
    oculus : float or str
        Clear diameter of the opening at the top; 0 closes the dome with a key [m].
    bond : {"running", "stack"}
        Whether every second ring is turned by half a block.
    lantern : float or str
        Weight on the upper faces of the last ring, load group "lantern" [kN]; needs an oculus.
    spread : float or str
        Outward movement of all springers, load group "settlement" [m].
    **common
        See :class:`concio.model.generate.solid_masonry.CommonSpace`.

    Notes
    -----
    Blocks are called ``c01-b01``: ring from below, block from the x axis on; the key "key", the fixed bodies
    "springer 01"... The springing of the intrados lies at z = 0, the axis at x = y = 0.

    Examples
    --------
    Three rings of 8 blocks and a key:

    >>> import concio
    >>> model = concio.dome(span=4.0, ring=0.4, courses=3, blocks=8, block="rigid")
    >>> len(model.free_bodies)
    25
    >>> concio.solve(model).status.name
    'SOLVED'
    """
    where = "dome"
    options = checked_space(where, common)
    s, t = positive(where, "span", span), positive(where, "ring", ring)
    n, m = count(where, "courses", courses), count(where, "blocks", blocks, 4)
    choice(where, "bond", bond, ("running", "stack"))
    eye = not_negative(where, "oculus", oculus)
    weight, apart = finite(where, "lantern", lantern, "force"), finite(where, "spread", spread)
    high = 0.5 * s if rise is None else positive(where, "rise", rise)
    if high > 0.5 * s * (1 + 1e-9):
        msg = f"a dome of span {s:g} m rises at most {s / 2:g} m, not {high:g} m"
        raise InputError(msg, where=where)
    if eye >= 0.95 * s:
        msg = f"oculus = {eye:g} m leaves no dome of span {s:g} m"
        raise InputError(msg, where=where)
    if weight and not eye:
        msg = "a lantern stands on an oculus, but there is none"
        raise InputError(msg, where=where, hint="give oculus a diameter")
    radius = (0.25 * s * s + high * high) / (2 * high)
    low = np.pi / 2 if rise is None else float(np.arcsin(min(0.5 * s / radius, 1.0)))
    top = float(np.arcsin(0.5 * eye / radius))
    step = (low - top) / (n if eye else n + 0.5)
    angles = low - step * np.arange(n + 1)  # from the vertical
    cells = 2 if bond == "running" else 1
    shape = _Revolved(radius, t, cells * m, radius * float(np.cos(low)))
    pieces = []
    for c in range(n):
        shift = c % 2 if cells == 2 else 0
        for b in range(m):
            first = cells * b + shift
            grid = shape.points(np.arange(first, first + cells + 1), angles[[c, c + 1]])
            name = f"{numbered('c', c + 1, n)}-{numbered('b', b + 1, m)}"
            pieces.append(grid_piece(name, grid, layer=f"ring {c + 1}"))
    if not eye:
        pieces.append(_key(shape, float(angles[-1])))
    facets = [shape.joint(k, low) for k in range(cells * m)]
    obstacles = [_springer(numbered("springer ", k + 1, len(facets)), f, t) for k, f in enumerate(facets)]
    supports = []
    if apart:
        for o, facet in zip(obstacles, facets, strict=True):
            out = facet.mean(0) * [1, 1, 0]
            out *= apart / np.linalg.norm(out)
            supports.append(Support(f"spread {o.name}", o.name, displacement=tuple(out.tolist())))
    loads = []
    if weight:
        upper = [shape.joint(k, float(angles[-1])) for k in range(cells * m)]
        area = sum(0.5 * float(np.linalg.norm(cross(f[2] - f[0], f[3] - f[1]))) for f in upper)
        loads = [
            Load("traction", (0.0, 0.0, -weight / area), polygon=tuple(map(tuple, f.tolist())), group="lantern")
            for f in upper
        ]
    kind = "hemispherical" if rise is None else "segmental"
    title = f"{kind} dome, span {s:g} m, ring {t:g} m, {n} x {m} blocks"
    record = {"kind": "dome", "span": s, "ring": t, "courses": n, "blocks": m, "oculus": eye, "bond": bond}
    made = assemble_space(options, pieces, obstacles, loads=loads, title=title, generator=record)
    return replace(made, supports=tuple(supports)) if supports else made


class _Revolved:
    """Points of a shell of revolution whose parallels are polygons of so many sides."""

    def __init__(self, radius: float, thick: float, sides: int, down: float) -> None:
        self.radius, self.thick, self.sides, self.down = radius, thick, sides, down

    def at(self, r: Array, side: Array, angle: Array) -> Array:
        turn = 2 * np.pi * np.asarray(side) / self.sides
        x, y, z = r * np.sin(angle) * np.cos(turn), r * np.sin(angle) * np.sin(turn), r * np.cos(angle) - self.down
        return np.stack([x, y, z], -1)

    def points(self, sides: Array, angles: Array) -> Array:
        """Return the grid (2, sides, angles, 3) from intrados to extrados."""
        r, side, angle = np.meshgrid([self.radius, self.radius + self.thick], sides % self.sides, angles, indexing="ij")
        return self.at(r, side, angle)

    def joint(self, side: int, angle: float) -> Array:
        """Return the corners (4, 3) of a joint between rings: intrados, extrados, and back one side on."""
        r = self.radius + np.array([0.0, self.thick, self.thick, 0.0])
        return self.at(r, np.array([side, side, side + 1, side + 1]) % self.sides, np.full(4, angle))


def _key(shape: _Revolved, angle: float) -> SolidPiece:
    """Return the stone that closes a dome: a truncated pyramid."""
    sides = np.arange(shape.sides)
    low, high = (shape.at(np.full(shape.sides, r), sides, np.full(shape.sides, angle))
                 for r in (shape.radius, shape.radius + shape.thick))  # fmt: skip
    n = shape.sides
    faces = [tuple(range(n))[::-1], tuple(range(n, 2 * n))]
    faces += [(k, (k + 1) % n, (k + 1) % n + n, k + n) for k in range(n)]
    return SolidPiece("key", (np.vstack([low, high]), tuple(faces), ()), layer="key")


def _springer(name: str, facet: Array, thick: float) -> SolidPiece:
    """Return a fixed block behind a planar joint (4, 3), on its lower side."""
    normal = cross(facet[1] - facet[0], facet[3] - facet[0])
    normal *= -np.sign(normal[2]) / np.linalg.norm(normal)
    return prism_piece(name, [facet], (0.5 * thick * normal).tolist(), role="springer")
