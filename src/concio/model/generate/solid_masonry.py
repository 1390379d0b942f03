"""Options that generators in space have in common, blocks before they are bodies, and what all generators do last."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

import numpy as np

from concio.arguments import closest
from concio.errors import InputError
from concio.model.generate.generator_arguments import Checked, checked, two
from concio.model.generate.masonry import joints_on, own_weight
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Load, Model
from concio.model.polyhedron import BOX, Polyhedron
from concio.model.surfaces import Surface, grid_surface, merged_faces, prism_surface
from concio.model.topology import Loop

Array = np.ndarray


class CommonSpace(TypedDict, total=False):
    """Options that every generator in space takes.

    Keys
    ----
    block : Elastic, Rigid, "elastic" or "rigid"
        Material of the blocks. Default "elastic": 5 GPa, 20 kN/m3.
    friction : float, str or JointLaw
        Law of all joints; a number is a Coulomb coefficient, a text its angle: ``"31 deg"``. Default 0.6.
    base_friction : float, str or None
        Another coefficient against the ground or the abutments.
    unit_weight : float or str or None
        Weight per volume [kN/m3]; None takes the material's.
    horizontal : float
        Horizontal force as a share of the self-weight, load group "live". Default 0.
    towards : (x, y)
        Its direction in plan; (1, 0) by default.
    element : str
        Element family, "H8I" by default.
    mesh_size : float, str or None
        Target element size [m].
    refinement : int
        Every element is split this many times more.
    contact_points : "auto", "corners" or int
        See :class:`concio.Model`.
    title : str
        Title of the model; by default what was made.
    """

    block: Elastic | Rigid | Literal["elastic", "rigid"]
    friction: float | str | JointLaw
    base_friction: float | str | None
    unit_weight: float | str | None
    horizontal: float
    towards: Sequence[float]
    element: str
    mesh_size: float | str | None
    refinement: int
    contact_points: str | int
    title: str


@dataclass(frozen=True)
class CheckedSpace:
    """The common options after checking: those of the plane, and what space adds."""

    base: Checked
    towards: tuple[float, float]
    element: str
    contact_points: str | int


def checked_space(where: str, options: Mapping[str, Any]) -> CheckedSpace:
    """Return the common options with defaults filled in.

    Raises
    ------
    InputError
        A key that is not known, or a value out of range.
    """
    for key in options:
        if key not in CommonSpace.__annotations__:
            msg = f"unknown option '{key}'"
            raise InputError(msg, where=where, hint=closest(key, CommonSpace.__annotations__, names="common options"))
    own = {k: v for k, v in options.items() if k not in ("towards", "element", "contact_points")}
    base = checked(where, own)
    x, y = (float(v) for v in two(where, "towards", options.get("towards") or (1.0, 0.0)))
    length = float(np.hypot(x, y))
    if not 0 < length < np.inf:
        msg = f"towards = ({x:g}, {y:g}) is not a direction"
        raise InputError(msg, where=where, hint="for example (1, 0), or (1, 1) for 45 degrees")
    return CheckedSpace(
        base, (x / length, y / length), str(options.get("element") or ""), options.get("contact_points") or "auto"
    )


@dataclass(frozen=True, eq=False)
class SolidPiece:
    """A block before it is a body.

    Parameters
    ----------
    name : str
    surface : (vertices, faces, holes)
    role, layer, material : str
    grid : array or None
        Hexahedra that fill it.
    """

    name: str
    surface: Surface
    role: str = "block"
    layer: str = ""
    material: str = "block"
    grid: Array | None = None

    def body(self, kind: Literal["elastic", "rigid", "fixed"]) -> Polyhedron:
        """Return the body of the block."""
        points, faces, holes = self.surface
        material = "" if kind == "fixed" else self.material
        return Polyhedron(self.name, points, faces, material, kind, self.role, self.layer, holes, self.grid)


def box_piece(name: str, low: Sequence[float], high: Sequence[float], **words: Any) -> SolidPiece:
    """Return a block with faces along the axes."""
    x, y, z = (np.array([p, q]) for p, q in zip(low, high, strict=True))
    k = np.arange(8)
    points = np.column_stack([x[k % 2], y[k // 2 % 2], z[k // 4]])
    return SolidPiece(name, (points, BOX, ()), **words)


def grid_piece(name: str, grid: Array, **words: Any) -> SolidPiece:
    """Return a block that a grid of hexahedra fills, (nx + 1, ny + 1, nz + 1, 3)."""
    if grid.shape[:3] == (2, 2, 2):
        points = grid.transpose(2, 1, 0, 3).reshape(8, 3)
        return SolidPiece(name, (points, BOX, ()), grid=grid, **words)
    return SolidPiece(name, grid_surface(grid), grid=grid, **words)


def prism_piece(name: str, rings: Sequence[Array], direction: Sequence[float], **words: Any) -> SolidPiece:
    """Return a block that a planar polygon sweeps: rings (n, 3) counter-clockwise about the direction."""
    return SolidPiece(name, prism_surface(rings, np.asarray(direction, dtype=float)), **words)


def assemble_space(
    options: CheckedSpace,
    pieces: Sequence[SolidPiece],
    obstacles: Sequence[SolidPiece],
    *,
    loads: Sequence[Load] = (),
    materials: Mapping[str, Elastic | Rigid] | None = None,
    title: str,
    generator: Mapping[str, object],
) -> Model:
    """Return the model of ``pieces`` on ``obstacles``: self-weight in group "dead", its horizontal share in "live".

    Parameters
    ----------
    options : CheckedSpace
    pieces, obstacles : sequence of SolidPiece
        Blocks, and fixed bodies to which ``base_friction`` applies by their roles.
    loads : sequence of Load
        Further loads.
    materials : mapping
        Materials beside "block".
    title, generator
        For the record.
    """
    base = options.base
    table: dict[str, Elastic | Rigid] = {"block": base.block, **(materials or {})}
    bodies = [o.body("fixed") for o in obstacles]
    bodies += [p.body("rigid" if isinstance(table[p.material], Rigid) else "elastic") for p in pieces]
    laws, rules = joints_on(base, [o.role for o in obstacles])
    share = [float(base.horizontal * c) for c in options.towards]
    own = own_weight(table.values(), (0.0, 0.0, -1.0), (share[0], share[1], 0.0))
    used = {p.material for p in pieces}
    return Model(
        bodies=tuple(bodies),
        materials={name: material for name, material in table.items() if name in used},
        laws=laws,
        rules=rules,
        loads=(*own, *loads),
        element=options.element,
        mesh_size=base.mesh_size,
        refinement=base.refinement,
        contact_points=options.contact_points,
        title=base.title or title,
        generator=dict(generator),
    )


def joined(first: SolidPiece, second: SolidPiece) -> SolidPiece:
    """Return two blocks that share a whole face as one; the name and the words are those of the first.

    Raises
    ------
    InputError
        They share no face.
    """
    (p, faces_p, holes_p), (q, faces_q, holes_q) = first.surface, second.surface
    size = float(np.ptp(np.vstack([p, q]), axis=0).max())
    near = np.linalg.norm(q[:, None] - p, axis=2)
    partner = np.where(near.min(1) <= 1e-9 * size, near.argmin(1), -1)
    number = np.where(partner >= 0, partner, len(p) + np.cumsum(partner < 0) - 1).tolist()
    points = np.vstack([p, q[partner < 0]])

    def renumbered(loop: Loop) -> Loop:
        return tuple(number[v] for v in loop)

    own, other = list(faces_p), [renumbered(f) for f in faces_q]
    sets = {frozenset(f): k for k, f in enumerate(own)}
    common = [(sets[frozenset(f)], k) for k, f in enumerate(other) if frozenset(f) in sets]
    if len(common) != 1 or holes_p or holes_q:
        msg = f"blocks '{first.name}' and '{second.name}' share no whole face"
        raise InputError(msg)
    i, k = common[0]
    return SolidPiece(
        first.name, merged_faces(points, [*own[:i], *own[i + 1 :], *other[:k], *other[k + 1 :]]), first.role,
        first.layer, first.material,
    )  # fmt: skip
