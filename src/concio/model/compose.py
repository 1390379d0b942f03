"""A part of a structure: a model moved, turned, mirrored and thinned out.

Supports, ties, loads and the controls of stages move with their part, and their directions are turned and mirrored with
it: what pushed outwards pushes outwards still. Gravity stays with the world, whatever is turned: of a weight the
vertical part. ``loads = "world"`` keeps the directions of all forces: for an earthquake along x that acts on all parts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from typing import Literal

import numpy as np

from concio.arguments import closest, strict
from concio.errors import InputError
from concio.kinematics.rigid import plane_rotation, rotation_matrix
from concio.model.model import Body, Load, Model, Point, Support, Tie, called, require_model
from concio.model.polyhedron import Polyhedron
from concio.model.rules import fits
from concio.model.stages import Stage
from concio.units import degrees, quantity

Array = np.ndarray
AXES = "xyz"


@strict
def place(
    model: Model,
    at: Sequence[float | str] = (),
    *,
    turn: float | str = 0.0,
    axis: Sequence[float] = (),
    mirror: str = "",
    name: str = "",
    without: str | Sequence[str] = (),
    loads: Literal["body", "world"] = "body",
) -> Model:
    """Return a model mirrored, turned, moved, in this order, and without some of its bodies.

    Parameters
    ----------
    model : Model
    at : (x, y) or (x, y, z)
        Where the origin goes [m].
    turn : float or str
        Angle about the origin, in the plane counter-clockwise, in space about ``axis`` [degrees].
    axis : (x, y, z)
        In space; the vertical by default.
    mirror : str
        "x", "y" or "z": this coordinate changes its sign. Several letters are several mirrors.
    name : str
        Put with a hyphen before the names of bodies, supports and ties, so that parts can be distinguished.
    without : str or sequence of str
        Bodies to leave out, by name, role, layer or a pattern of names such as ``"b0*"``; with them go their supports
        and ties, and loads that name nothing else.
    loads : {"body", "world"}
        Whether the directions of forces are turned and mirrored with the bodies or stay those of the world. Places move
        in either case, pressures push against their faces, imposed displacements go with the body, and the vertical
        part of weights, which is gravity, stays with the world.

    Raises
    ------
    InputError
        A word of ``without`` names nothing, nothing would be left, or a number cannot be used.

    Examples
    --------
    A slab on an inclined plane slides where the tangent of the slope exceeds the friction of 0.6, at 30.96 degrees:

    >>> import concio
    >>> slab = concio.column(width=2.0, height=0.5, blocks=1, block="rigid", friction=0.6)
    >>> for angle in (30.0, 31.0):
    ...     print(angle, concio.solve(concio.place(slab, turn=angle), on_failure="return").status.name)
    30.0 SOLVED
    31.0 NO_EQUILIBRIUM
    """
    require_model(model)
    matrix, shift = _motion(model, at, turn, axis, mirror)
    if loads not in ("body", "world"):
        msg = f"loads = {loads!r} is not 'body' or 'world'"
        raise InputError(msg, where="place")
    ways = matrix if loads == "body" else np.eye(model.dim)
    words = [without] if isinstance(without, str) else list(without)
    gone = _named(model, words)
    label = f"{name}-" if name else ""
    moved = not np.array_equal(matrix, np.eye(model.dim)) or shift.any()
    bodies = tuple(
        replace(_moved_body(b, matrix, shift) if moved else b, name=label + b.name)
        for b in model.bodies
        if b.name not in gone
    )
    if not bodies:
        msg = f"nothing is left without {', '.join(repr(w) for w in words)}"
        raise InputError(msg, where="place")
    own = {b.name for b in model.bodies}

    def renamed(word: str) -> str:
        return label + word if word in own else word

    supports = [_moved_support(s, matrix, shift, label) for s in model.supports if s.body not in gone]
    kept_loads = []
    left = [b for b in model.bodies if b.name not in gone]
    for load in model.loads:
        if load.bodies and not any(called(word, b) for word in load.bodies for b in left):
            continue
        kept = tuple(word for w in load.bodies for word in _relabelled(w, label, left, called))
        kept_loads.append(replace(_moved_load(load, matrix, shift, ways), bodies=kept))
    changes = []
    for change in model.temperatures:
        kept = tuple(word for w in change.bodies for word in _relabelled(w, label, left, called))
        if kept or not change.bodies:
            place = None if change.at is None else _point(change.at, matrix, shift)
            along = _point(change.gradient, matrix) if change.gradient else ()
            changes.append(replace(change, bodies=kept, at=place, gradient=along))
    ties = [_moved_tie(t, matrix, shift, label, renamed) for t in model.ties if not {t.body_a, t.body_b} & gone]
    rules = [
        replace(rule, between=(p, q))
        for rule in model.rules
        for p, q in product(*(_relabelled(w, label, left, fits) for w in rule.between))
    ]
    stages = tuple(_moved_stage(s, matrix, shift, renamed) for s in model.stages)
    return replace(
        model, bodies=bodies, supports=tuple(supports), loads=tuple(kept_loads), ties=tuple(ties), rules=tuple(rules),
        stages=stages, temperatures=tuple(changes), fill=None, vehicle=None,
    )  # fmt: skip


def _relabelled(
    word: str, label: str, left: Sequence[Body | Polyhedron], names: Callable[[str, Body | Polyhedron], bool]
) -> tuple[str, ...]:
    """Return the words by which the bodies that are left, renamed, are found: names and patterns of names change.

    A word may be the name of one body and the role, the layer or the material of others.
    """
    fitting = [b for b in left if names(word, b)]
    if "*" in word and word != "*":
        return (label + word,) if fitting else ()
    found = [label + word] if any(b.name == word for b in fitting) else []
    others = not label or word == "*"
    found += [word] if any(others or b.name != word for b in fitting) else []
    return tuple(dict.fromkeys(found))


def _motion(
    model: Model, at: Sequence[float | str], turn: float | str, axis: Sequence[float], mirror: str
) -> tuple[Array, Array]:
    """Return the matrix (d, d) and the shift (d,) of a placement."""
    d, where = model.dim, "place"
    shift = np.array([quantity(v, "length", where="at") for v in at] or np.zeros(d), dtype=float)
    if shift.shape != (d,) or not np.isfinite(shift).all():
        msg = f"at = {list(at)} must be {d} finite lengths"
        raise InputError(msg, where=where, hint=f"the model is {'in the plane' if d == 2 else 'in space'}")
    if not set(mirror) <= set(AXES[:d]):
        msg = f"mirror = '{mirror}' is not made of {', '.join(AXES[:d])}"
        raise InputError(msg, where=where)
    angle = degrees(turn, where="turn")
    if not np.isfinite(angle):
        msg = f"turn = {angle} must be finite"
        raise InputError(msg, where=where)
    flip = np.diag([-1.0 if a in mirror else 1.0 for a in AXES[:d]])
    if d == 2:
        if len(axis):
            msg = "a plane model turns in its plane: leave axis out"
            raise InputError(msg, where=where)
        return exact(plane_rotation(np.deg2rad(angle))) @ flip, shift
    direction = np.array(axis if len(axis) else (0.0, 0.0, 1.0), dtype=float)
    if direction.shape != (3,) or not np.linalg.norm(direction) > 0:
        msg = f"axis = {list(axis)} must be three numbers, not all zero"
        raise InputError(msg, where=where)
    return exact(rotation_matrix(np.deg2rad(angle) * direction / np.linalg.norm(direction))) @ flip, shift


def exact(matrix: Array) -> Array:
    """Return a rotation by a right angle without rounding, any other as it is."""
    whole = np.round(matrix)
    return whole if np.abs(whole - matrix).max() < 1e-14 else matrix


def _named(model: Model, words: Sequence[str]) -> set[str]:
    gone: set[str] = set()
    for word in words:
        found = {b.name for b in model.bodies if called(word, b)}
        if not found:
            known = dict.fromkeys(w for b in model.bodies for w in (b.role, b.layer, b.name) if w)
            msg = f"there is no body, role or layer '{word}' to leave out"
            raise InputError(msg, where="place", hint=closest(word, known))
        gone |= found
    return gone


def _moved_body(body: Body | Polyhedron, matrix: Array, shift: Array) -> Body | Polyhedron:
    if isinstance(body, Body):
        outline, *inner = (ring @ matrix.T + shift for ring in body.rings)
        grid = None
        if body.grid is not None and np.array_equal(matrix, np.eye(2)):
            grid = (body.grid[0] + shift[0], body.grid[1] + shift[1])
        return replace(body, outline=outline, holes=tuple(inner), grid=grid)
    points = body.vertices @ matrix.T + shift
    cells = None if body.grid is None else body.grid @ matrix.T + shift
    if np.linalg.det(matrix) > 0:
        return replace(body, vertices=points, grid=cells)
    faces = tuple(face[::-1] for face in body.faces)
    holes = tuple((face, loop[::-1]) for face, loop in body.holes)
    return replace(body, vertices=points, faces=faces, holes=holes, grid=None if cells is None else cells[::-1])


def _point(p: Sequence[float], matrix: Array, shift: Array | float = 0.0) -> Point:
    return tuple((matrix @ np.array(p, dtype=float) + shift).tolist())


def _edge(edge: tuple[Point, Point] | None, matrix: Array, shift: Array) -> tuple[Point, Point] | None:
    return None if edge is None else (_point(edge[0], matrix, shift), _point(edge[1], matrix, shift))


def _moved_support(support: Support, matrix: Array, shift: Array, label: str) -> Support:
    turned = np.abs(matrix)
    axes = [AXES.index(a) for a in support.directions]
    held = np.flatnonzero(turned[:, axes].sum(1) > 1e-12)
    if len(held) != len(axes):
        msg = f"it holds '{support.directions}' alone, which is not a direction of the axes after turning"
        raise InputError(msg, where=f"support '{support.name}'", hint="turn by right angles, or hold all directions")
    sign = float(np.linalg.det(matrix))
    rotation = np.atleast_1d(np.asarray(support.rotation, dtype=float))
    spun = sign * rotation if len(rotation) == 1 else sign * matrix @ rotation
    return replace(
        support,
        name=label + support.name,
        body=label + support.body,
        edge=_edge(support.edge, matrix, shift),
        polygon=None if support.polygon is None else tuple(_point(p, matrix, shift) for p in support.polygon),
        directions="".join(AXES[k] for k in held),
        displacement=_point(support.displacement, matrix),
        rotation=float(spun[0]) if len(spun) == 1 else tuple(spun.tolist()),
    )


def _moved_load(load: Load, matrix: Array, shift: Array, ways: Array) -> Load:
    """Return a load moved with its body, its direction by a matrix of its own (d, d); gravity keeps it."""
    value = load.value
    if load.kind == "weight" and len(value) == len(ways):
        level = np.array([*value[:-1], 0.0])
        value = _point(level.tolist(), ways, np.array(value) - level) if level.any() else value
    elif load.kind in ("traction", "point", "body"):
        value = _point(value, ways)
    return replace(
        load,
        value=value,
        edge=_edge(load.edge, matrix, shift),
        polygon=None if load.polygon is None else tuple(_point(p, matrix, shift) for p in load.polygon),
        at=None if load.at is None else _point(load.at, matrix, shift),
    )


def _moved_tie(tie: Tie, matrix: Array, shift: Array, label: str, renamed: Callable[[str], str]) -> Tie:
    return replace(
        tie, name=label + tie.name, body_a=renamed(tie.body_a), body_b=renamed(tie.body_b),
        at_a=_point(tie.at_a, matrix, shift), at_b=_point(tie.at_b, matrix, shift),
    )  # fmt: skip


def _moved_stage(stage: Stage, matrix: Array, shift: Array, renamed: Callable[[str], str]) -> Stage:
    if stage.control is None:
        return stage
    control = stage.control
    return replace(stage, control=replace(
        control, body=renamed(control.body), at=_point(control.at, matrix, shift),
        direction=_point(control.direction, matrix),
    ))  # fmt: skip
