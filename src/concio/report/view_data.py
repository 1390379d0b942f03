"""What the interactive view shows, as typed arrays in base64: small, quick to read, and exact where numbers are read.

Drawing needs single precision (``f4``); every number the view can print is stored in double precision (``f8``).
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.plot import style
from concio.post.body_motion import body_motions
from concio.post.force_lines import force_chains
from concio.post.joint_lines import joint_lines
from concio.post.mechanism_states import mechanism_states
from concio.post.outlines import Outlines, display_scale, outlines

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.model.body import Body
    from concio.model.polyhedron import Polyhedron

Array = np.ndarray

MOST_CHAINED = 3000
"""Lines of force are found for so many joints of all steps; of more they would take as long as the answer."""
BUDGET = 40_000_000
"""Bytes of arrays above which steps of a load path are left out of the view, evenly."""


LOOK = {
    "block": style.BLOCK,
    "mortar": style.FILM,
    "rigid": style.RIGID,
    "edge": style.EDGE,
    "compression": style.COMPRESSION.colour,
    "tension": style.TENSION.colour,
    "slip": style.SLIP.colour,
    "crushed": style.CRUSHED.colour,
    "open": style.OPEN.colour,
}
"""Colours of both views."""


def pack(array: Array, kind: str) -> dict[str, Any]:
    """Return an array as ``{"type", "data"}``: little-endian bytes of type f4, f8, i4 or u1 in base64."""
    plain = np.ascontiguousarray(array, dtype=f"<{kind}" if kind != "u1" else "u1")
    return {"type": kind, "data": base64.b64encode(plain.tobytes()).decode("ascii")}


def unpack(packed: dict[str, Any]) -> Array:
    """Return the flat array of :func:`pack`."""
    kind = packed["type"]
    return np.frombuffer(base64.b64decode(packed["data"]), dtype=f"<{kind}" if kind != "u1" else "u1")


def view_data(results: Sequence[Result], labels: Sequence[str]) -> dict[str, Any]:
    """Return the data of the view of one result, or of the steps of a load path on one assembly.

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
    model, disc = first.model, first.assembly.disc
    shown = _shown(first)
    origin = shown.points.mean(0)
    pieces = joint_lines(first, shown)
    pairs = first.assembly.pairs
    each = 8 * len(shown.points) + (32 + 4 + 1 + 32) * len(pieces.pair)
    steps = steps_within(BUDGET, len(results), each)
    few = len(steps) * len(first.joints.N) <= MOST_CHAINED
    packed = [_step(results[k], labels[k]) | (_chains(results[k], origin) if few else {}) for k in steps]
    largest = max(step.pop("largest") for step in packed)
    interfaces = first.joints
    return {
        "origin": origin.tolist(),
        "scale": display_scale(largest, shown.size),
        "size": shown.size,
        "mechanism": first.mechanism is not None,
        "units": units_of(results[steps[-1]], largest, results[steps[-1]].stress.principal[:2]),
        "left_out": len(results) - len(steps),
        "look": {**LOOK, "stick": style.STICK.colour, "hatch": style.HATCH, "gap": style.FILL_OPEN},
        "bodies": {
            "name": [b.name for b in model.bodies],
            "kind": [kind_of(b) for b in model.bodies],
            "start": pack(shown.starts, "i4"),
            "ring": pack(shown.rings, "i4"),
            "point": pack(shown.points - origin, "f4"),
            "centre": pack(disc.centroids - origin, "f8"),
        },
        "pieces": {
            "face": pack(pairs.interface[pieces.pair], "i4"),
            "pair": pack(pieces.pair, "i4"),
            "ends": pack(pieces.ends - origin, "f4"),
        },
        "joints": {
            "a": pack(interfaces.body_a, "i4"),
            "b": pack(interfaces.body_b, "i4"),
            "length": pack(interfaces.length, "f8"),
        },
        "steps": packed,
    }


def units_of(result: Result, motion: float, stresses: Sequence[Array]) -> dict[str, tuple[float, str]]:
    """Return what values in kN and m are multiplied by, and the unit they then have, for each kind of quantity.

    Parameters
    ----------
    result : Result
    motion : float
        Largest displacement [m].
    stresses : sequence of arrays
        Principal stresses [kN/m2].
    """
    units = result.model.report
    stress = max((float(np.nanmax(np.abs(s), initial=0.0)) for s in stresses), default=0.0)
    sizes = {"force": 0.0, "length": 0.0, "motion": motion, "stress": stress, "rotation": 0.0}
    return {kind: units.factor(kind, size) for kind, size in sizes.items()}


def kind_of(body: Body | Polyhedron) -> str:
    """Return by which colour of the view a body is drawn."""
    if body.kind == "elastic":
        return "mortar" if body.role == "mortar" else "block"
    return str(body.kind)


def _shown(result: Result) -> Outlines:
    if result.mechanism_velocity is not None:
        return outlines(result, result.mechanism_velocity)
    return outlines(result)


def steps_within(budget: int, count: int, each: int) -> list[int]:
    """Return which of ``count`` steps of ``each`` bytes fit a budget: the first, the last, and evenly between."""
    room = int(max(2, min(count, budget // max(each, 1))))
    return sorted({round(k) for k in np.linspace(0, count - 1, room)})


def _chains(result: Result, origin: Array) -> dict[str, Any]:
    """Return the lines along which forces run through the blocks, where there is an answer."""
    if not result.solved:
        return {}
    found = force_chains(result)
    return {"chain": pack(found.lines - origin, "f4"), "carried": pack(found.force, "f4")}


def _step(result: Result, label: str) -> dict[str, Any]:
    shown = _shown(result)
    pieces = joint_lines(result, shown)
    solved = result.solved
    velocity = None if solved or result.mechanism is None else result.mechanism_velocity
    motion = body_motions(result, velocity)
    if not solved and velocity is None:  # no answer: nothing moves
        shown = replace(shown, displacement=np.zeros_like(shown.displacement))
        pieces = joint_lines(result, shown)
        motion = np.zeros_like(motion)
    step: dict[str, Any] = {
        "label": label,
        "status": result.status.name.lower(),
        "largest": float(np.hypot(*shown.displacement.T).max(initial=0.0)),
        "move": pack(shown.displacement, "f4"),
        "moved_a": pack(pieces.moved_a, "f4"),
        "moved_b": pack(pieces.moved_b, "f4"),
        "motion": pack(motion, "f8"),
    }
    if not solved:
        if velocity is not None:
            step["state"] = pack(mechanism_states(result, pieces), "u1")
        return step
    s1, s2, angle = result.stress.principal
    contacts, joints = result.contacts, result.joints
    pair = pieces.pair
    return {
        **step,
        "s1": pack(s1, "f8"),
        "s2": pack(s2, "f8"),
        "angle": pack(angle, "f4"),
        "state": pack(contacts.state[pair], "u1"),
        "t_n": pack(contacts.normal_force[pair], "f8"),
        "t_t": pack(contacts.friction_force[pair, 0], "f8"),
        "gap": pack(contacts.gap[pair], "f8"),
        "slip": pack(contacts.slip[pair, 0], "f8"),
        "pressure": pack(contacts.pressure[pair], "f8"),
        "N": pack(joints.N, "f8"),
        "V": pack(joints.V, "f8"),
        "eccentricity": pack(joints.eccentricity, "f8"),
        "open_share": pack(joints.open_share, "f8"),
    }
