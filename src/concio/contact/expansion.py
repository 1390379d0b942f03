"""Changes of temperature: what bodies expand by, in the gaps of those that are rigid, as free strains of the others.

A change T(x) = T0 + g . r, with r from the point where it is T0, strains a body of expansion alpha by alpha T in every
direction. The strains are compatible, so that a body that is free makes no stress and moves by

    u = alpha (T0 r + (g . r) r - g |r|^2 / 2),                                            (1)

as differentiating shows: d u_i / d x_j = alpha (T delta_ij + g_j r_i - g_i r_j), whose symmetric part is alpha T I.
What is rigid moves by (1) besides its rigid motion, which changes gaps as a moved obstacle does; what is elastic has
the stress of its displacements less (1). B. A. Boley and J. H. Weiner, "Theory of Thermal Stresses", 1960, chapter 3.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from concio.arguments import closest
from concio.contact.pairs import Pairs
from concio.errors import InputError
from concio.fem.discretisation import RIGID, Discretisation
from concio.model.materials import Elastic
from concio.model.model import Model, Temperature, called

Array = np.ndarray


def expanded(model: Model, b: int, change: Temperature, points: Array) -> Array:
    """Return by how much points (n, d) of a body move where it expands freely, by equation (1) [m]."""
    body = model.bodies[b]
    material = model.materials[body.material]
    alpha = material.expansion
    if model.dim == 2 and model.plane == "strain" and isinstance(material, Elastic):
        alpha *= 1 + material.nu  # it cannot expand across the plane
    r = points - np.asarray(body.centroid if change.at is None else change.at, dtype=float)
    g = np.asarray(change.gradient or np.zeros(model.dim), dtype=float)
    moved: Array = alpha * ((change.change + r @ g)[:, None] * r - (r**2).sum(1)[:, None] * g / 2)
    return moved


def warmed(model: Model, change: Temperature) -> list[int]:
    """Return the numbers of the bodies whose temperature changes.

    Raises
    ------
    InputError
        It names no body that is not fixed.
    """
    free = [b for b, body in enumerate(model.bodies) if body.kind != "fixed"]
    if not change.bodies:
        return free
    chosen: set[int] = set()
    for word in change.bodies:
        found = {b for b in free if called(word, model.bodies[b])}
        if not found:
            known = dict.fromkeys(w for b in free for w in (model.bodies[b].role, model.bodies[b].name) if w)
            msg = f"a temperature changes in '{word}', but no free body has that name, role or layer"
            raise InputError(msg, where=f"load group '{change.group}'", hint=closest(word, known))
        chosen |= found
    return sorted(chosen)


def free_strains(disc: Discretisation) -> dict[str, Array]:
    """Return the displacements (N_all,) of elastic bodies that expand freely, of each group; zero in rigid ones [m].

    Raises
    ------
    InputError
        A temperature changes in bodies whose material does not expand, or in a rigid body that a support holds.
    """
    found: dict[str, Array] = {}
    for change, b in _changes(disc):
        u = found.setdefault(change.group, np.zeros(disc.unknowns))
        if disc.shape_of[b] != RIGID:
            u[disc.offsets[b] : disc.offsets[b + 1]] += expanded(disc.model, b, change, disc.nodes(b)).ravel()
    return found


def add_expansions(disc: Discretisation, pairs: Pairs, moved: dict[str, tuple[Array, Array]]) -> None:
    """Add what rigid bodies that expand do to the normal (m,) and tangential (m, d-1) displacement, by group [m]."""
    model = disc.model
    ties = np.flatnonzero(pairs.interface < 0)
    for change, b in _changes(disc):
        none = (np.zeros(len(pairs)), np.zeros((len(pairs), disc.dim - 1)))
        normal, tangential = moved.setdefault(change.group, none)
        if disc.shape_of[b] != RIGID:
            continue
        for own, sign, end in ((pairs.body_b == b, 1.0, "at_b"), (pairs.body_a == b, -1.0, "at_a")):
            points = pairs.point.copy()
            if len(ties):
                points[ties] = [getattr(t, end) for t in model.ties]
            motion = sign * own[:, None] * expanded(model, b, change, points)
            normal += (motion * pairs.normal).sum(1)
            tangential += (pairs.interface >= 0)[:, None] * np.einsum("md,mtd->mt", motion, pairs.tangents)


def refuse_temperatures(model: Model, what: str) -> None:
    """Refuse a model whose temperature changes, for what does not state it.

    Raises
    ------
    InputError
    """
    if model.temperatures:
        msg = f"the temperature changes (load group '{model.temperatures[0].group}'), which {what} leaves out"
        hint = "load steps, paths, settlements and diagnoses state it; leave the change out of the model here"
        raise InputError(msg, hint=hint)


def _changes(disc: Discretisation) -> Iterator[tuple[Temperature, int]]:
    """Yield every change of temperature with every body it acts on, checked."""
    model = disc.model
    held = {s.body for s in model.supports}
    for change in model.temperatures:
        where = f"load group '{change.group}'"
        if not np.isfinite([change.change, *change.gradient]).all():
            msg = "a change of temperature is not finite"
            raise InputError(msg, where=where)
        bodies = warmed(model, change)
        if not any(model.materials[model.bodies[b].material].expansion for b in bodies):
            msg = "a temperature changes in bodies that do not expand"
            raise InputError(msg, where=where, hint="give their material an expansion, for example 8e-6 a kelvin")
        for b in bodies:
            body = model.bodies[b]
            if disc.shape_of[b] == RIGID and body.name in held and model.materials[body.material].expansion:
                msg = f"the temperature changes in '{body.name}', which is rigid and held by a support"
                raise InputError(msg, where=where, hint="rest it on a fixed body, or make it elastic")
            yield change, b
