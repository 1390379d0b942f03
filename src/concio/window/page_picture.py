"""What the page draws of a model, and what its tables list: plain numbers and the words of the house.

Colours are those of the figures and reports (:mod:`concio.plot.style`); sentences are those of verdicts. The page
writes no sentence about a structure itself.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.model.body import Body
from concio.model.described import law_words, material_words, tie_words
from concio.model.file.build import NO_BLOCKS
from concio.model.model import Load, Model
from concio.model.polyhedron import Polyhedron
from concio.plot.model_figure import load_arrows
from concio.plot.space_loads import load_direction
from concio.window.read_models import DIGITS, own_loads, read
from concio.window.worker import Tell

UNKNOWN: dict[str, Any] = {
    "early": True, "joints": [], "attention": [], "attention_italian": [], "findings": [], "notes": [], "fault": None,
}  # fmt: skip
"""What a picture of the geometry alone does not know."""


UNTRACED: dict[str, Any] = {
    **UNKNOWN, "early": False, "untraced": True, "dim": 2, "title": "", "bodies": [], "materials": {}, "laws": {},
    "loads": [], "supports": [], "ties": [], "groups": [], "fixed": 0,
}  # fmt: skip
"""Picture of a model whose stones are still to be traced: that is not a fault."""


def picture(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return the picture of a model; ``tell`` gets its geometry before joints are sought and the model is assembled.

    Raises
    ------
    ConcioError
        The text is not a model.
    """
    try:
        data, model = read(request, fresh=True)
    except InputError as error:
        data = tomllib.loads(request["text"]) if error.what == NO_BLOCKS else {}
        if "picture" not in data.get("record", {}):
            raise
        return {**UNTRACED, "tables": sorted(data)}
    shown: dict[str, Any] = {
        "dim": model.dim, "title": model.title, "tables": sorted(data), "bodies": _bodies(model),
        "materials": {n: material_words(m, model.report) for n, m in model.materials.items()},
        "laws": {n: law_words(law, model.report) for n, law in model.laws.items()},
        "loads": _loads(model, data), "supports": _supports(model, data), "ties": _ties(model, data),
        "groups": sorted({load.group for load in model.loads} | {s.group for s in model.supports if s.moves}),
        "fixed": sum(b.kind == "fixed" for b in model.bodies),
    }  # fmt: skip
    tell("early", {**shown, **UNKNOWN})
    from concio.window.drawn_joints import contacts

    return {**shown, "early": False, **contacts(model)}


def _bodies(model: Model) -> list[dict[str, Any]]:
    return [
        {
            "name": b.name, "kind": b.kind, "role": b.role, "layer": b.layer, "material": b.material,
            "thickness": getattr(b, "thickness", None), "size": b.volume,
            "centre": np.round(b.centroid, DIGITS).tolist(),
            **_shape(b),
        }
        for b in model.bodies
    ]  # fmt: skip


def _shape(body: Body | Polyhedron) -> dict[str, Any]:
    """Return the outlines of a body; in space vertices, faces, edges, and triangles with the face each belongs to."""
    if isinstance(body, Body):
        return {"rings": [np.round(r, DIGITS).tolist() for r in body.rings]}
    triangles, face = body.triangles
    return {
        "rings": [], "vertices": np.round(body.vertices, DIGITS).tolist(), "faces": [list(f) for f in body.faces],
        "edges": body.topology.edges.tolist(), "triangles": np.column_stack([triangles, face]).tolist(),
    }  # fmt: skip


def _loads(model: Model, data: Mapping[str, Any]) -> list[dict[str, Any]]:
    numbers = {mine: k for k, mine in own_loads(data, model).items()}
    road = {part.group for part in (model.fill, model.vehicle) if part is not None}
    found = []
    for k, load in enumerate(model.loads):
        if load.group in road and load.kind == "point":
            continue
        entry = {"table": numbers.get(k), "kind": load.kind, "group": load.group, "value": list(load.value),
                 "bodies": list(load.bodies), "at": load.at, "edge": load.edge, "polygon": load.polygon}  # fmt: skip
        found.append(entry | _arrows(load, model))
    return found


def _arrows(load: Load, model: Model) -> dict[str, Any]:
    """Return where the arrows of a load end, their directions and its size in words; nothing of a self-weight."""
    if model.dim == 2:
        arrows = load_arrows(load, model.report)
        return {} if arrows is None else dict(zip(("tips", "ways", "words"), map(_listed, arrows), strict=True))
    place = load.polygon or load.edge or (() if load.at is None else (load.at,))
    size = float(np.linalg.norm(load.value))
    if not place or not size > 0:
        return {}
    words = model.report.text("force" if load.kind == "point" else "stress", size)
    tip = np.asarray(place, dtype=float).mean(axis=0)
    return {"tips": [tip.tolist()], "ways": [load_direction(load, model).tolist()], "words": words}


def _listed(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


def _supports(model: Model, data: Mapping[str, Any]) -> list[dict[str, Any]]:
    names = [t.get("name") for t in data.get("supports", [])]
    return [
        {"table": names.index(s.name) if s.name in names else None, "name": s.name, "body": s.body, "edge": s.edge,
         "directions": s.directions, "displacement": list(s.displacement), "group": s.group, "moves": s.moves,
         "polygon": s.polygon, "at": np.round(model.body(s.body).centroid, DIGITS).tolist()}
        for s in model.supports
    ]  # fmt: skip


def _ties(model: Model, data: Mapping[str, Any]) -> list[dict[str, Any]]:
    names = [t.get("name") for t in data.get("ties", [])]
    return [
        {"table": names.index(t.name) if t.name in names else None, "name": t.name, "body_a": t.body_a,
         "body_b": t.body_b, "at_a": t.at_a, "at_b": t.at_b, "words": tie_words(t, model.report)}
        for t in model.ties if t.kind == "bar"
    ]  # fmt: skip
