"""Several models made one: bodies, materials, laws, loads and rules of parts that were placed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import TypeVar

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.model.generate.own_words import everything_of, own_words, pattern_of, united_rules
from concio.model.interfaces.detect import Detection, detect_interfaces
from concio.model.interfaces.patches import detect_patches
from concio.model.materials import JointLaw
from concio.model.model import JointRule, Load, Model, Temperature, require_model

T = TypeVar("T")


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
        Law between bodies of different parts; a number is a Coulomb coefficient. By default that of all parts, where
        they agree on one.

    Raises
    ------
    InputError
        Names clash, or the parts differ in dimension, element, plane or refinement; or parts touch whose laws differ,
        and ``joint`` does not say which holds between them; or bodies of a part would touch that do not touch in it,
        because the ``gap_tolerance`` of another part is larger.

    Examples
    --------
    Two pillars, 2.5 m apart:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=4)
    >>> model = concio.merge(concio.place(pillar, name="left"), concio.place(pillar, at=(3.0, 0.0), name="right"))
    >>> len(model.free_bodies)
    8
    >>> model.body("right-b01").centroid.round(6).tolist()
    [3.0, 0.25]
    """
    whole = merged(models, title=title, joint=joint)
    if joint is None and len({_general_law(m) for m in models}) > 1:
        _agreed(models, whole)
    return whole


def merged(models: Sequence[Model], *, title: str = "", joint: JointLaw | float | None = None) -> Model:
    """Return several models as one, as :func:`merge`; where laws of parts differ that of the first holds between."""
    if not models:
        msg = "there is nothing to merge"
        raise InputError(msg, where="merge", hint="give two models or more")
    for model in models:
        require_model(model)
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
        [replace(b, material=names.get(b.material, b.material), mesh_size=b.mesh_size or m.mesh_size) for b in m.bodies]
        for m, names in zip(models, material_names, strict=True)
    ]
    rules = united_rules(models, law_names, material_names, bodies)
    if joint is not None:
        law = joint if isinstance(joint, JointLaw) else JointLaw(joint)
        laws["between parts"] = law
        rules += [
            JointRule("between parts", (everything_of(models, i), everything_of(models, j)))
            for i, j in combinations(range(len(models)), 2)
        ]
    tolerances = [m.gap_tolerance for m in models if m.gap_tolerance is not None]
    reaches = [m.gap_reach for m in models if m.gap_reach is not None]
    whole = replace(
        first,
        bodies=tuple(b for own in bodies for b in own),
        materials=materials,
        laws=laws,
        rules=tuple(rules),
        supports=tuple(s for m in models for s in m.supports),
        loads=_loads(models),
        ties=tuple(t for m in models for t in m.ties),
        temperatures=_temperatures(models),
        stages=tuple(s for m in models for s in m.stages),
        mesh_size=None,
        gap_tolerance=max(tolerances) if tolerances else None,
        gap_reach=max(reaches) if reaches else None,
        title=title or first.title,
        fill=None,
        vehicle=None,
        generator={"kind": "merged", "parts": tuple(str(m.generator.get("kind", "blocks")) for m in models)},
    )
    if len({m.gap_tolerance for m in models}) > 1:
        _as_before(models, whole)
    return whole


def _temperatures(models: Sequence[Model]) -> tuple[Temperature, ...]:
    """Return the changes of temperature of all parts, each in the bodies of its own part."""
    found = []
    for k, model in enumerate(models):
        free = tuple(b.name for b in model.bodies if b.kind != "fixed")
        found += [replace(t, bodies=own_words(models, k, t.bodies) or free) for t in model.temperatures]
    return tuple(found)


def _general_law(model: Model) -> JointLaw | None:
    """Return the law of a part on everything, None where it has none."""
    rules = [rule for rule in model.rules if rule.between == ("*", "*")]
    return model.laws[rules[-1].law] if rules else None


def _agreed(models: Sequence[Model], whole: Model) -> None:
    """Refuse parts that touch where no rule but that of the first part on everything says which law holds.

    Raises
    ------
    InputError
    """
    found = _detected(whole, whole.gap_reach)
    part = np.repeat(np.arange(len(models)), [len(m.bodies) for m in models])
    for i, j in [*((face.a, face.b) for face in found.interfaces), *(miss.bodies for miss in found.not_made)]:
        p, q = int(part[i]), int(part[j])
        if p == q or _general_law(models[p]) == _general_law(models[q]):
            continue
        a, b = whole.bodies[i], whole.bodies[j]
        rule = whole.rule_between(a, b)
        if rule.between == ("*", "*"):
            told = [law.friction if (law := _general_law(models[k])) else "none" for k in (p, q)]
            msg = (
                f"'{a.name}' of part {p + 1} and '{b.name}' of part {q + 1} touch, and nothing says which law holds "
                f"between them: the friction of part {p + 1} is {told[0]}, of part {q + 1} {told[1]}"
            )
            hint = "say it with joint = 0.6 or a JointLaw, in a file with [[rules]]"
            raise InputError(msg, where="merge", hint=hint)


def _as_before(models: Sequence[Model], whole: Model) -> None:
    """Refuse a tolerance of one part that closes gaps of another.

    Raises
    ------
    InputError
    """
    pairs, first = _closed(whole), 0
    for number, model in enumerate(models, 1):
        last = first + len(model.bodies)
        own = {(first + a, first + b) for a, b in _closed(model)}
        new = sorted((a, b) for a, b in pairs - own if first <= a < last and first <= b < last)
        if new:
            a, b = (whole.bodies[k].name for k in new[0])
            more = f", and {len(new) - 1} more pairs" if len(new) > 1 else ""
            msg = (
                f"'{a}' and '{b}' of part {number} do not touch in it and would in the whole{more}: another part has a "
                f"gap_tolerance of {whole.gap_tolerance:g} m"
            )
            hint = "give all parts the same gap_tolerance, no larger than the inaccuracy of the drawing"
            raise InputError(msg, where="merge", hint=hint)
        first = last


def _closed(model: Model) -> set[tuple[int, int]]:
    """Return the pairs of bodies that touch at a face without an initial gap."""
    return {(face.a, face.b) for face in _detected(model).interfaces if not np.any(face.gap)}


def _detected(model: Model, reach: float | None = None) -> Detection:
    """Return the faces at which bodies of a model touch, within its tolerance."""
    tolerance = model.gap_tolerance if model.gap_tolerance is not None else 1e-6 * model.size
    if model.dim == 2:
        return detect_interfaces(model.outlines, tolerance=tolerance, reach=reach)
    return detect_patches(model.polyhedra, tolerance=tolerance, reach=reach)


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


def _loads(models: Sequence[Model]) -> tuple[Load, ...]:
    """Return the loads of all parts; those on everything name the bodies of their part unless all parts have them."""
    found: list[Load] = []
    for k, model in enumerate(models):
        for load in model.loads:
            if load.bodies:
                found.append(replace(load, bodies=own_words(models, k, load.bodies)))
            elif all(load in other.loads for other in models):
                found += [load] if k == 0 else []
            else:
                pattern = pattern_of(models, k)
                names = (pattern,) if pattern else tuple(b.name for b in model.free_bodies)
                found.append(replace(load, bodies=names))
    return tuple(found)
