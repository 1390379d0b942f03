"""Forces of a load body by body, with the points where they act: what follows a body that moves far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.contact.load_faces import loaded_bodies, loaded_faces
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
    force : (2,) array
        [kN].
    point : (2,) array
        Where it acts [m].
    """

    load: int
    body: int
    force: Array
    point: Array


def applied_forces(model: Model, numbers: Sequence[int]) -> list[Applied]:
    """Return the forces of some loads of a plane model; loads on fixed bodies have none.

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
                body = model.outlines[b]
                density = model.materials[body.material].unit_weight if load.kind == "weight" else 1.0
                if density:
                    found.append(Applied(k, b, density * body.volume * value, body.centroid))
        elif load.kind == "point":
            assert load.at is not None  # the assembly has checked it
            found += [Applied(k, b, value, np.array(load.at)) for b in loaded_bodies(model, load)]
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


def pushes_sideways(model: Model, group: str) -> bool:
    """Return whether a load group is there and acts along x rather than along y."""
    numbers = [k for k, load in enumerate(model.loads) if load.group == group]
    total = sum((np.abs(f.force) for f in applied_forces(model, numbers)), np.zeros(2))
    return bool(total[0] > total[1])


def pushed(model: Model, direction: float) -> Model:
    """Return a model with one more load group: every weight it carries once more, sideways.

    Parameters
    ----------
    model : Model
        Plane.
    direction : {1, -1}
        Along x.

    Raises
    ------
    InputError
        Nothing in it has weight.
    """
    pushes = []
    for load in model.loads:
        if load.kind == "pressure":
            pushes += [] if load.edge is None else [_sideways(load, direction)]
        elif load.value[-1] < 0:
            pushes.append(replace(load, value=(-direction * load.value[-1], 0.0), group=EARTHQUAKE))
    pushes = [p for p in pushes if any(p.value)]
    if not pushes:
        msg = "the model carries no weight that an earthquake could push with"
        raise InputError(msg, hint='give it Load("weight", (0, -1)) and a material with a unit_weight')
    return replace(model, loads=(*model.loads, *pushes))


def _sideways(load: Load, direction: float) -> Load:
    """Return a pressure from above as a traction along x of the size of its vertical part."""
    assert load.edge is not None
    p, q = (np.array(end, dtype=float) for end in load.edge)
    share = abs(q[0] - p[0]) / float(np.linalg.norm(q - p))
    return replace(load, kind="traction", value=(direction * max(load.value[0], 0.0) * share, 0.0), group=EARTHQUAKE)
