"""Forces of a load body by body, with the points where they act: what follows a body that moves far."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.contact.edge_loads import loaded_bodies, loaded_faces
from concio.contact.face_loads import loaded_parts, plane_of
from concio.contact.factors import load_factor
from concio.errors import InputError
from concio.model.model import Load, Model

Array = np.ndarray

EARTHQUAKE = "earthquake"
"""Load group of the horizontal forces that are made of the weights."""


@dataclass(frozen=True, eq=False)
class Applied:
    """A force on a body.

    Parameters
    ----------
    load : int
        Number of the load in the model.
    body : int
        Number of the body.
    force : (d,) array
        [kN].
    point : (d,) array
        Where it acts [m].
    """

    load: int
    body: int
    force: Array
    point: Array


def applied_forces(model: Model, numbers: Sequence[int]) -> list[Applied]:
    """Return the forces of some loads of a model; loads on fixed bodies have none.

    Parameters
    ----------
    model : Model
    numbers : sequence of int
        Which of its loads.
    """
    found = []
    for k in numbers:
        load = model.loads[k]
        value = np.array(load.value, dtype=float)
        if load.kind in ("weight", "body"):
            for b in loaded_bodies(model, load):
                body = model.bodies[b]
                density = model.materials[body.material].unit_weight if load.kind == "weight" else 1.0
                if density:
                    found.append(Applied(k, b, density * body.volume * value, body.centroid))
        elif load.kind == "point":
            assert load.at is not None  # the assembly has checked it
            found += [Applied(k, b, value, np.array(load.at)) for b in loaded_bodies(model, load)]
        elif model.dim == 3 and load.edge is not None:
            ends = np.array(load.edge, dtype=float)
            force = value * float(np.linalg.norm(ends[1] - ends[0]))
            found += [Applied(k, b, force, ends.mean(0)) for b in loaded_bodies(model, load)]
        elif model.dim == 3:
            found += [Applied(k, p.body, p.force, p.centre) for p in loaded_parts(model, load)
                      if model.bodies[p.body].kind != "fixed"]  # fmt: skip
        else:
            for face in loaded_faces(model, load):
                outline = model.outlines[face.body].outline
                p, q = outline[face.edge], outline[(face.edge + 1) % len(outline)]
                along = (q - p) / float(np.linalg.norm(q - p))
                vector = value[0] * face.inward if load.kind == "pressure" else value
                thickness = model.outlines[face.body].thickness
                for low, high in face.parts:
                    force = vector * thickness * (high - low)
                    found.append(Applied(k, face.body, force, p + along * (low + high) / 2))
    return found


def free_group(model: Model) -> str:
    """Return a name for the load group of the weights turned sideways that no group of a model has."""
    group, taken = EARTHQUAKE, {load.group for load in model.loads} | {s.group for s in model.supports}
    while group in taken:
        group += " of the weights"
    return group


def pushed(
    model: Model, direction: Sequence[float], group: str = EARTHQUAKE, factors: Mapping[str, float] | None = None
) -> Model:
    """Return a model with one more load group: every weight it carries once more, sideways.

    Parameters
    ----------
    model : Model
    direction : sequence of float
        Unit vector: (1,) or (-1,) in the plane, horizontal (x, y) in space; (d,) of any direction.
    group : str
        Name of that load group.
    factors : mapping of str to float, optional
        With which the load groups act; groups not named have 1.

    Raises
    ------
    InputError
        Nothing in it has weight.
    """
    made, numbers = sideways(model, direction, group)
    factor = [load_factor(factors or {}, model.loads[k].group) for k in numbers]
    loads = [replace(load, value=tuple(f * v for v in load.value)) for load, f in zip(made, factor, strict=True)]
    return replace(model, loads=(*model.loads, *loads))


def sideways(model: Model, direction: Sequence[float], group: str = EARTHQUAKE) -> tuple[list[Load], list[int]]:
    """Return every weight that a model carries as a horizontal load, with the numbers of the loads they are made of.

    A load is a weight as far as it acts downwards: what pushes up, or to the side, is none. So floors and roofs that
    load a structure from above are masses.

    Parameters
    ----------
    model : Model
    direction : sequence of float
        Unit vector, horizontal (d - 1,) or of any direction (d,).
    group : str
        Name of their load group.

    Raises
    ------
    InputError
        Nothing in the model has weight.
    """
    way = np.append(np.array(direction, dtype=float), 0.0)[: model.dim]
    made, numbers = [], []
    for k, load in enumerate(model.loads):
        turned = None
        if load.kind == "pressure":
            if load.edge is not None or load.polygon is not None:
                falls = sum(float(f.force[-1]) for f in applied_forces(model, [k])) < 0
                turned = _sideways(load, way, group) if falls else None
        elif load.value[-1] < 0:
            turned = replace(load, value=tuple((-way * load.value[-1]).tolist()), group=group)
        if turned is not None and any(turned.value):
            made.append(turned)
            numbers.append(k)
    if not made:
        msg = "the model has no weight that could push it sideways"
        raise InputError(msg, hint='give it Load("weight", (0, -1)) and a material with a unit_weight')
    return made, numbers


def resultants(
    model: Model, numbers: Sequence[int], groups: Sequence[str] | None = None
) -> dict[str, tuple[Array, float]]:
    """Return by load group the resultant (d,) and the sum of sizes of the forces on free bodies [kN].

    Parameters
    ----------
    model : Model
    numbers : sequence of int
        Which of its loads.
    groups : sequence of str, optional
        Group of each load of the model, where they are summed by others than their own.
    """
    found: dict[str, tuple[Array, float]] = {}
    for f in applied_forces(model, numbers):
        group = model.loads[f.load].group if groups is None else groups[f.load]
        total, size = found.get(group, (np.zeros(model.dim), 0.0))
        found[group] = total + f.force, size + float(np.linalg.norm(f.force))
    return found


def _sideways(load: Load, way: Array, group: str) -> Load:
    """Return a pressure from above as a traction along a direction (d,), of the size of its vertical part."""
    if load.polygon is not None:
        share = abs(float(plane_of(np.array(load.polygon, dtype=float))[1][2]))
    else:
        assert load.edge is not None
        p, q = (np.array(end, dtype=float) for end in load.edge)
        share = abs(q[0] - p[0]) / float(np.linalg.norm(q - p))
    value = tuple((way * max(load.value[0], 0.0) * share).tolist())
    return replace(load, kind="traction", value=value, group=group)
