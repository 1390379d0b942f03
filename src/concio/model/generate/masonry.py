"""From outlines of blocks and obstacles to a model: what all generators do last."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from concio.model.generate.generator_arguments import Checked
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Array, Body, JointRule, Load, Model


@dataclass(frozen=True, eq=False)
class Piece:
    """A block before it is a body: name, outline (n, 2), role, layer, material, thickness (None: common), holes."""

    name: str
    outline: Array
    role: str = "block"
    layer: str = ""
    material: str = "block"
    thickness: float | None = None
    holes: tuple[Array, ...] = ()


def rectangle(x0: float, x1: float, y0: float, y1: float) -> Array:
    """Return the outline (4, 2) of a rectangle, counter-clockwise."""
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def numbered(letter: str, number: int, total: int) -> str:
    """Return a name such as ``c03``: letter and number from 1, with as many digits as the total needs, at least two."""
    return f"{letter}{number:0{max(2, len(str(total)))}d}"


def assemble(
    options: Checked,
    pieces: Sequence[Piece],
    obstacles: Sequence[Piece],
    *,
    loads: Sequence[Load] = (),
    materials: Mapping[str, Elastic | Rigid] | None = None,
    title: str,
    generator: Mapping[str, object],
) -> Model:
    """Return the model of ``pieces`` on ``obstacles``: self-weight in group "dead", its horizontal share in "live".

    Parameters
    ----------
    options : Checked
    pieces : sequence of Piece
        Blocks; their material is "block" or a key of ``materials``.
    obstacles : sequence of Piece
        Fixed bodies; ``base_friction`` applies to them by their roles.
    loads : sequence of Load
        Further loads.
    materials : mapping
        Materials beside "block".
    title, generator
        For the record.
    """
    table: dict[str, Elastic | Rigid] = {"block": options.block, **(materials or {})}
    bodies = [
        Body(o.name, o.outline, "", "fixed", o.role, o.layer, o.thickness or options.thickness, holes=o.holes)
        for o in obstacles
    ]
    for p in pieces:
        kind: Literal["elastic", "rigid"] = "rigid" if isinstance(table[p.material], Rigid) else "elastic"
        depth = p.thickness or options.thickness
        bodies.append(Body(p.name, p.outline, p.material, kind, p.role, p.layer, depth, holes=p.holes))
    laws, rules = joints_on(options, [o.role for o in obstacles])
    own = own_weight(table.values(), (0.0, -1.0), (options.horizontal, 0.0))
    return Model(
        bodies=tuple(bodies),
        materials=table,
        laws=laws,
        rules=rules,
        loads=(*own, *loads),
        plane=options.plane,
        element=options.element,
        mesh_size=options.mesh_size,
        refinement=options.refinement,
        title=options.title or title,
        generator=dict(generator),
    )


def joints_on(options: Checked, roles: Iterable[str]) -> tuple[dict[str, JointLaw], tuple[JointRule, ...]]:
    """Return joint laws and rules: one law for all joints, and ``base_friction`` on obstacles of the roles given."""
    if options.base_law is None:
        return {"joint": options.law}, (JointRule("joint"),)
    on_base = (JointRule("base", (role, "*")) for role in dict.fromkeys(roles))
    return {"joint": options.law, "base": options.base_law}, (JointRule("joint"), *on_base)


def own_weight(
    materials: Iterable[Elastic | Rigid], down: tuple[float, ...], sideways: tuple[float, ...]
) -> tuple[Load, ...]:
    """Return self-weight in group "dead" and its share ``sideways`` in "live", where anything has a weight."""
    if not any(material.unit_weight for material in materials):
        return ()
    dead = Load("weight", down, group="dead")
    return (dead, Load("weight", sideways, group="live")) if any(sideways) else (dead,)
