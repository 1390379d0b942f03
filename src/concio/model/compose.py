"""Structures put together from parts: a model moved, turned, mirrored, thinned out, and several made one.

Loads and supports move with their part. Weights do not turn: gravity stays where it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import TypeVar

import numpy as np

from concio.arguments import closest, strict
from concio.errors import InputError
from concio.kinematics.rigid import plane_rotation, rotation_matrix
from concio.model.materials import JointLaw
from concio.model.model import Body, JointRule, Load, Model, Point, Support, Tie, called
from concio.model.polyhedron import Polyhedron
from concio.model.stages import Stage
from concio.units import degrees, quantity

Array = np.ndarray
T = TypeVar("T")
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
        Put with a hyphen before the names of bodies, supports and ties, so that parts can be told apart.
    without : str or sequence of str
        Bodies to leave out, by name, role, layer or a pattern of names such as ``"b0*"``; with them go their supports
        and ties, and loads that name nothing else.

    Raises
    ------
    InputError
        A word of ``without`` names nothing, nothing would be left, or a number cannot be used.
    """
    matrix, shift = _motion(model, at, turn, axis, mirror)
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
    loads = []
    left = [b for b in model.bodies if b.name not in gone]
    for load in model.loads:
        if load.bodies and not any(called(word, b) for word in load.bodies for b in left):
            continue
        kept = tuple(renamed(w) for w in load.bodies if any(called(w, b) for b in left))
        loads.append(replace(_moved_load(load, matrix, shift), bodies=kept))
    ties = [_moved_tie(t, matrix, shift, label, renamed) for t in model.ties if not {t.body_a, t.body_b} & gone]
    rules = [
        replace(rule, between=(renamed(rule.between[0]), renamed(rule.between[1])))
        for rule in model.rules
        if all(any(called(w, b) for b in left) for w in rule.between)
    ]
    stages = tuple(_moved_stage(s, matrix, shift, renamed) for s in model.stages)
    return replace(
        model, bodies=bodies, supports=tuple(supports), loads=tuple(loads), ties=tuple(ties), rules=tuple(rules),
        stages=stages,
    )  # fmt: skip


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
        msg = f"it holds '{support.directions}' alone, which is no direction of the axes after turning"
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


def _moved_load(load: Load, matrix: Array, shift: Array) -> Load:
    value = load.value
    if load.kind in ("traction", "point"):
        value = _point(load.value, matrix)
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


@strict
def merge(*models: Model, title: str = "", joint: JointLaw | float | None = None) -> Model:
    """Return several models as one.

    Bodies that touch are joined like any others. Materials and joint laws of one name but different content are kept
    apart: the later one gets the number of its part. A load on all bodies stays a load on all where every part has it,
    else it names the bodies of its part.

    Parameters
    ----------
    *models : Model
        Their bodies, supports and ties must have different names: see ``name`` of :func:`place`.
    title : str
        That of the first by default.
    joint : JointLaw, float, optional
        Law between bodies of different parts; a number is a Coulomb coefficient. By default that of the first part.

    Raises
    ------
    InputError
        Names clash, or the parts differ in dimension, element, plane or refinement.
    """
    if not models:
        msg = "there is nothing to merge"
        raise InputError(msg, where="merge", hint="give two models or more")
    first = models[0]
    for k, model in enumerate(models[1:], 2):
        if model.dim != first.dim:
            msg = f"part 1 is {'in the plane' if first.dim == 2 else 'in space'}, part {k} is not"
            raise InputError(msg, where="merge", hint="concio.extrude makes a model in space of a plane one")
        for key in ("element", "plane", "refinement", "periods", "contact_points"):
            if getattr(model, key) != getattr(first, key):
                msg = f"part 1 has {key} = {getattr(first, key)!r}, part {k} {getattr(model, key)!r}"
                raise InputError(msg, where="merge", hint="one model has one of it")
    _different([b.name for m in models for b in m.bodies], "bodies")
    _different([s.name for m in models for s in m.supports], "supports")
    _different([t.name for m in models for t in m.ties], "ties")
    materials, material_names = _united([m.materials for m in models])
    laws, law_names = _united([m.laws for m in models])
    bodies = [
        replace(b, material=material_names[k].get(b.material, b.material), mesh_size=b.mesh_size or m.mesh_size)
        for k, m in enumerate(models)
        for b in m.bodies
    ]
    rules = _rules(models, law_names)
    if joint is not None:
        law = joint if isinstance(joint, JointLaw) else JointLaw(joint)
        laws["between parts"] = law
        rules += [
            JointRule("between parts", (_everything(models, i), _everything(models, j)))
            for i, j in combinations(range(len(models)), 2)
        ]
    tolerances = [m.gap_tolerance for m in models if m.gap_tolerance is not None]
    return replace(
        first,
        bodies=tuple(bodies),
        materials=materials,
        laws=laws,
        rules=tuple(rules),
        supports=tuple(s for m in models for s in m.supports),
        loads=_loads(models),
        ties=tuple(t for m in models for t in m.ties),
        stages=tuple(s for m in models for s in m.stages),
        mesh_size=None,
        gap_tolerance=max(tolerances) if tolerances else None,
        gap_reach=max(m.gap_reach for m in models),
        title=title or first.title,
        generator={"kind": "merged", "parts": tuple(str(m.generator.get("kind", "blocks")) for m in models)},
    )


def _different(names: list[str], what: str) -> None:
    if len(set(names)) < len(names):
        twice = next(n for n in names if names.count(n) > 1)
        msg = f"two {what} of the parts are called '{twice}'"
        raise InputError(msg, where="merge", hint="give each part a name of its own: concio.place(part, name='left')")


def _united(tables: Sequence[Mapping[str, T]]) -> tuple[dict[str, T], list[dict[str, str]]]:
    """Return one table of all, and for each part the names that had to change."""
    every: dict[str, T] = {}
    changed: list[dict[str, str]] = []
    for number, table in enumerate(tables, 1):
        own: dict[str, str] = {}
        for name, thing in table.items():
            new = name
            while new in every and every[new] != thing:
                new = f"{name} {number}" if new == name else new + "'"
            every[new] = thing
            if new != name:
                own[name] = new
        changed.append(own)
    return every, changed


def pattern_of(models: Sequence[Model], number: int) -> str | None:
    """Return the pattern of names that all bodies of a part have and no others, None where there is none."""
    names = [b.name for b in models[number].bodies]
    prefix = names[0].partition("-")[0] + "-"
    others = [b.name for k, m in enumerate(models) for b in m.bodies if k != number]
    alone = all(name.startswith(prefix) for name in names) and not any(name.startswith(prefix) for name in others)
    return prefix + "*" if alone else None


def _everything(models: Sequence[Model], number: int) -> str:
    """Return a word that names all bodies of a part and no others."""
    pattern = pattern_of(models, number)
    if pattern is None:
        msg = f"part {number + 1} has joint laws of its own, but its blocks have no name in common"
        raise InputError(msg, where="merge", hint="give each part a name: concio.place(part, name='left')")
    return pattern


def _rules(models: Sequence[Model], laws: Sequence[Mapping[str, str]]) -> list[JointRule]:
    """Return the rules of all parts, those on everything kept to their part where parts differ in them."""
    own = [
        [replace(r, law=names.get(r.law, r.law)) for r in m.rules] for m, names in zip(models, laws, strict=True)
    ]
    general = [[r for r in rules if r.between == ("*", "*")][-1:] for rules in own]
    if all(g == general[0] for g in general):
        return list(dict.fromkeys(r for rules in own for r in rules))
    found = general[0][:1]
    for k, rules in enumerate(own):
        word = _everything(models, k)
        for rule in rules:
            p, q = (word if w == "*" else w for w in rule.between)
            found.append(replace(rule, between=(p, q)))
    return list(dict.fromkeys(found))


def _loads(models: Sequence[Model]) -> tuple[Load, ...]:
    """Return the loads of all parts; those on everything name the bodies of their part unless all parts have them."""
    found: list[Load] = []
    for k, model in enumerate(models):
        for load in model.loads:
            if load.bodies:
                found.append(load)
            elif all(load in other.loads for other in models):
                found += [load] if k == 0 else []
            else:
                pattern = pattern_of(models, k)
                names = (pattern,) if pattern else tuple(b.name for b in model.free_bodies)
                found.append(replace(load, bodies=names))
    return tuple(found)
