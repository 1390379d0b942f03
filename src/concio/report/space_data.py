"""What the view in space shows, as typed arrays in base64; the same forms as :mod:`concio.report.view_data`.

Numbers of a pair are written once, whatever the number of triangles it is drawn with, and faces of joints are moved
with their bodies by the view: a file of 2,000 blocks stays below 10 MB.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.post.body_motion import body_motions
from concio.post.joint_faces import JointFaces, joint_faces
from concio.post.mechanism_states import mechanism_states
from concio.post.outlines import display_scale
from concio.post.solids import Solids, solids, tie_bodies, tie_ends
from concio.report.view_data import LOOK, kind_of, pack, steps_within, units_of

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

BUDGET = 60_000_000
"""Bytes of arrays above which steps of a load path are left out of the view, evenly."""


def space_view_data(results: Sequence[Result], labels: Sequence[str]) -> dict[str, Any]:
    """Return the data of the view of one result in space, or of the steps of a load path on one assembly.

    Parameters
    ----------
    results : sequence of Result
        All of the same assembly.
    labels : sequence of str
        What each step is called.

    Returns
    -------
    dict
        JSON-able.
    """
    first = results[0]
    model, pairs = first.model, first.assembly.pairs
    shown, faces = _shown(first)
    low, high = shown.points.min(axis=0), shown.points.max(axis=0)
    origin = 0.5 * (low + high)
    each = 12 * len(shown.points) + 25 * len(pairs) + 100 * len(model.bodies)
    kept = steps_within(BUDGET, len(results), each)
    packed = [_step(results[k], labels[k]) for k in kept]
    largest = max(step.pop("largest") for step in packed)
    resultants, last = first.joints_in_space, results[kept[-1]]
    return {
        "origin": origin.tolist(),
        "low": (low - origin).tolist(),
        "high": (high - origin).tolist(),
        "size": shown.size,
        "scale": display_scale(largest, shown.size),
        "mechanism": first.mechanism is not None,
        "left_out": len(results) - len(kept),
        "units": units_of(last, largest, last.stress.principal_in_space[:1] if last.solved else ()),
        "look": {**LOOK, "fixed": "#C9C4BA", "stick": "#7A7A7A"},
        "bodies": {
            "name": [b.name for b in model.bodies],
            "kind": [kind_of(b) for b in model.bodies],
            "point": pack(shown.points - origin, "f4"),
            "triangle": pack(shown.triangles, "i4"),
            "owner": pack(shown.body, "i4"),
            "edge": pack(shown.edges, "i4"),
            "edge_owner": pack(shown.edge_body, "i4"),
            "centre": pack(first.assembly.disc.centroids - origin, "f8"),
            "volume": pack(np.array([b.volume for b in model.bodies]), "f8"),
        },
        "pieces": {
            "corner": pack(faces.corners - origin, "f4"),
            "pair": pack(faces.pair, "i4"),
        },
        "pairs": {"face": pack(pairs.interface, "i4")},
        "joints": {
            "a": pack(resultants.body_a, "i4"),
            "b": pack(resultants.body_b, "i4"),
            "area": pack(resultants.area, "f8"),
            "normal": pack(resultants.normal, "f4"),
        },
        "ties": {
            "name": [tie.name for tie in model.ties],
            "end": pack(tie_ends(model) - origin, "f4"),
            "body": pack(tie_bodies(model), "i4"),
        },
        "steps": packed,
    }


def _velocity(result: Result) -> Array | None:
    return None if result.solved or result.mechanism is None else result.mechanism_velocity


def _shown(result: Result) -> tuple[Solids, JointFaces]:
    u = _velocity(result)
    if u is None and not result.solved:
        u = np.zeros_like(result.displacement)
    return solids(result, u), joint_faces(result, u)


def _step(result: Result, label: str) -> dict[str, Any]:
    shown, faces = _shown(result)
    velocity = _velocity(result)
    still = not result.solved and velocity is None
    u = np.zeros_like(result.displacement) if still else velocity
    step: dict[str, Any] = {
        "label": label,
        "status": result.status.name.lower(),
        "largest": float(np.linalg.norm(shown.displacement, axis=1).max(initial=0.0)),
        "move": pack(shown.displacement, "f4"),
        "motion": pack(body_motions(result, u), "f8"),
    }
    if not result.solved:
        if velocity is not None:
            step["state"] = pack(mechanism_states(result, faces), "u1")
        return step
    contacts, joints = result.contacts, result.joints_in_space
    values, directions = result.stress.principal_in_space
    return {
        **step,
        "stress": pack(values, "f8"),
        "axes": pack(directions, "f4"),
        "state": pack(contacts.state, "u1"),
        "gap": pack(contacts.gap, "f8"),
        "slip": pack(np.linalg.norm(contacts.slip, axis=1), "f8"),
        "pressure": pack(contacts.pressure, "f8"),
        "N": pack(joints.N, "f8"),
        "V": pack(np.linalg.norm(joints.V, axis=1), "f8"),
        "force": pack(joints.force, "f4"),
        "at": pack(joints.point - _origin(shown), "f4"),
        "open_share": pack(joints.open_share, "f8"),
    }


def _origin(shown: Solids) -> Array:
    middle: Array = 0.5 * (shown.points.min(axis=0) + shown.points.max(axis=0))
    return middle
