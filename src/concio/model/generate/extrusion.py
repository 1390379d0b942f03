"""A model in space from a plane one: every outline swept along its thickness, with all that holds and loads it.

The plane's x stays x, its y becomes the vertical z, and the thickness runs along y, half on each side of y = 0, so that
a point (x, y) of the plane is (x, 0, y) in space.

* A held or loaded edge becomes the face it sweeps. A point force becomes a line load across the thickness, so that
  blocks feel it as in the plane.
* A support in both directions of the plane holds all three; rotations turn about the y axis, positive from x to z
  becoming -y.
* In space nothing holds the blocks in y but friction. ``held`` puts a support in y on the two faces of each block:
  plane strain.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.model.generate.generator_arguments import positive
from concio.model.model import Body, Load, Model, Point, Support, Temperature, Tie, called, require_model
from concio.model.polyhedron import Polyhedron
from concio.model.stages import Stage
from concio.model.surfaces import from_grid, prism

Array = np.ndarray

ELEMENTS = {"Q4": "H8", "Q4I": "H8I", "Q8": "H27", "Q9": "H27", "T3": "T4", "T6": "T10"}
"""Element of space for each of the plane; the same interpolation in the plane where there is one."""


@strict
def extrude(model: Model, thickness: float | str | None = None, *, held: bool = False) -> Model:
    """Return a model in space of a plane one, swept along its thickness.

    Parameters
    ----------
    model : Model
        In the plane.
    thickness : float or str, optional
        Of all blocks [m]; without it each block has its own.
    held : bool
        Whether supports hold the two faces of every block in y: plane strain.

    Returns
    -------
    Model
        Names, materials, joints, groups and stages are those of ``model``. Forces are too, if it had this thickness.

    Raises
    ------
    InputError
        The model is in space already, or is a periodic cell.

    Examples
    --------
    >>> import concio
    >>> plane = concio.column(width=0.5, height=2.0, blocks=2, thickness=0.3)
    >>> model = concio.extrude(plane)
    >>> model.dim, round(model.body("b01").volume, 6)
    (3, 0.15)
    """
    require_model(model)
    outlines = model.outlines
    if model.periods is not None:
        msg = "a periodic cell is plane"
        raise InputError(msg, where="extrude", hint="extrude a wall of the same bond")
    depth = None if thickness is None else positive("extrude", "thickness", thickness)
    deep = {b.name: depth or b.thickness for b in outlines}
    widest = max(deep.values())
    bodies = tuple(_body(b, deep[b.name], model) for b in outlines)
    supports = [_support(s, deep.get(s.body, widest)) for s in model.supports]
    if held:
        supports += [s for b in bodies if b.kind != "fixed" for s in _sides(b, deep[b.name])]
    return replace(
        model,
        bodies=bodies,
        supports=tuple(supports),
        loads=tuple(_load(load, model, deep, widest) for load in model.loads),
        ties=tuple(_tie(t) for t in model.ties),
        temperatures=tuple(_temperature(t) for t in model.temperatures),
        stages=tuple(_stage(s) for s in model.stages),
        element=ELEMENTS[model.element],
        fill=None,
        vehicle=None,
        generator={"kind": "extrusion", "of": dict(model.generator), "thickness": depth or "own"},
    )


def _point(p: Point, y: float = 0.0) -> Point:
    return (float(p[0]), y, float(p[1]))


def _temperature(change: Temperature) -> Temperature:
    at = None if change.at is None else _point(change.at)
    return replace(change, at=at, gradient=_point(change.gradient) if change.gradient else ())


def _body(body: Body, t: float, model: Model) -> Polyhedron:
    size = body.mesh_size or model.mesh_size or float(np.ptp(body.outline, axis=0).max()) / 4
    common = {
        "material": body.material, "kind": body.kind, "role": body.role, "layer": body.layer,
        "mesh_size": size if body.kind == "elastic" else None,
    }  # fmt: skip
    if body.grid is not None and body.kind == "elastic":
        x, y, z = np.meshgrid(body.grid[0], [-0.5 * t, 0.5 * t], body.grid[1], indexing="ij")
        return from_grid(body.name, np.stack([x, y, z], -1), **common)
    rings = [body.outline, *body.holes]
    swept = [np.column_stack([ring[:, 0], np.full(len(ring), 0.5 * t), ring[:, 1]]) for ring in rings]
    return prism(body.name, swept, np.array([0.0, -t, 0.0]), **common)


def _swept(edge: tuple[Point, Point], t: float) -> tuple[Point, ...]:
    p, q = edge
    return (_point(p, -0.5 * t), _point(q, -0.5 * t), _point(q, 0.5 * t), _point(p, 0.5 * t))


def _support(support: Support, t: float) -> Support:
    edge, region = None, None
    if support.edge is not None:
        p, q = support.edge
        if tuple(p) == tuple(q):
            edge = (_point(p, -0.5 * t), _point(p, 0.5 * t))
        else:
            region = _swept(support.edge, t)
    return replace(
        support,
        edge=edge,
        polygon=region,
        directions={"x": "x", "y": "z", "xy": "xyz"}[support.directions],
        displacement=_point(support.displacement),
        rotation=(0.0, -float(np.asarray(support.rotation)), 0.0),
    )


def _sides(body: Polyhedron, t: float) -> list[Support]:
    """Return supports in y of the two faces of a block."""
    found = []
    for word, y in (("front", -0.5 * t), ("back", 0.5 * t)):
        face = int(np.argmax(body.normals[:, 1] * np.sign(y)))
        corners = tuple(tuple(p) for p in body.vertices[list(body.faces[face])].tolist())
        found.append(Support(f"{body.name} {word}", body.name, polygon=corners, directions="y", group="dead"))
    return found


def _load(load: Load, model: Model, deep: dict[str, float], widest: float) -> Load:
    if load.kind == "pressure":
        value = load.value
    else:
        value = _point(load.value)
    t = max((deep[b.name] for b in model.outlines if _takes(load, b)), default=widest)
    if load.at is not None:
        ends = (_point(load.at, -0.5 * t), _point(load.at, 0.5 * t))
        return replace(load, kind="traction", value=tuple(v / t for v in value), at=None, edge=ends)
    region = None if load.edge is None else _swept(load.edge, t)
    return replace(load, value=value, edge=None, polygon=region)


def _takes(load: Load, body: Body) -> bool:
    return body.kind != "fixed" and (not load.bodies or any(called(word, body) for word in load.bodies))


def _tie(tie: Tie) -> Tie:
    return replace(tie, at_a=_point(tie.at_a), at_b=_point(tie.at_b))


def _stage(stage: Stage) -> Stage:
    control = stage.control
    if control is None:
        return stage
    moved = replace(control, at=_point(control.at), direction=_point(control.direction))
    return replace(stage, control=moved)
