"""Blocks that touch nothing, groups of blocks that do not touch, and blocks that hang: how a model holds together."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.model.interfaces.detect import Detection
from concio.model.model import Model

BEARS = 1e-3
"""A face that looks up by less carries nothing without friction."""


def apart(model: Model, detection: Detection) -> list[str]:
    """Return sentences on blocks not connected to any support, on groups that do not touch, and on what hangs."""
    number = {body.name: k for k, body in enumerate(model.bodies)}
    ground = len(model.bodies)
    links = [(i.a, i.b) for i in detection.interfaces]
    links += [(number.get(tie.body_a, ground), number.get(tie.body_b, ground)) for tie in model.ties]
    links += [(number[support.body], ground) for support in model.supports]
    links += [(k, ground) for k, body in enumerate(model.bodies) if body.kind == "fixed"]
    if model.periods is not None or not detection.interfaces:
        return []
    part = connected_bodies(links, ground + 1)
    loose = [body.name for k, body in enumerate(model.bodies) if part[k] != part[ground]]
    found = []
    if loose:
        one, many = "is not connected to any support: it falls", "are not connected to any support: they fall"
        words = many if len(loose) > 1 else one
        found.append(f"{_first(loose)} {words}; check that all of them are in the right place")
    if model.dim == 2:
        return found
    free = [k for k, body in enumerate(model.bodies) if body.kind != "fixed" and part[k] == part[ground]]
    among = connected_bodies([(p, q) for p, q in links if {p, q} <= set(free)], ground + 1)
    groups: dict[int, list[str]] = defaultdict(list)
    for k in free:
        groups[int(among[k])].append(model.bodies[k].name)
    if len(groups) > 1:
        shown = sorted(groups.values(), key=len, reverse=True)
        words = ", ".join(_first(names, 1) for names in shown[:3]) + (", ..." if len(shown) > 3 else "")
        found.append(f"the blocks are in {len(shown):,} groups that do not touch: {words}; is this intended?")
    return found + _hanging(model, detection)


def connected_bodies(links: list[tuple[int, int]], count: int) -> np.ndarray:
    """Return the number of the group (count,) of each body, of those that links hold together."""
    a, b = np.array(links, dtype=int).reshape(-1, 2).T
    graph = sp.coo_array((np.ones(len(a)), (a, b)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _first(names: list[str], most: int = 3) -> str:
    more = f" and {len(names) - most:,} more" if len(names) > most else ""
    return ", ".join(f"'{name}'" for name in names[:most]) + more


def held_bodies(model: Model) -> set[str]:
    """Return the names of the bodies at which a tie or a support acts."""
    return {name for tie in model.ties for name in (tie.body_a, tie.body_b)} | {s.body for s in model.supports}


def _hanging(model: Model, detection: Detection) -> list[str]:
    """Return a sentence on the blocks in space that touch others, none of which is under them to any degree."""
    held = held_bodies(model)
    joints = detection.interfaces
    touched = {k for joint in joints for k in (joint.a, joint.b)}
    borne = {p.b for p in joints if p.normal[2] > BEARS}
    borne |= {p.a for p in joints if p.normal[2] < -BEARS}
    bodies = [model.bodies[k] for k in sorted(touched - borne)]
    names = [b.name for b in bodies if b.kind != "fixed" and b.name not in held]
    if not names or not any(load.kind == "weight" for load in model.loads):
        return []
    words = ("has no block or support below", "have no block or support below")[len(names) > 1]
    return [f"{_first(names)} {words}: only friction at the sides can hold that; is a lintel or a pier missing?"]
