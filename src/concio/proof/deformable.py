"""What an equilibrium certificate states beside a static one: stiffness, nodal loads, compliances, gaps.

The stiffness of an elastic block is stated with three components of its nodes held, from which that of all others
follows: rigid motions deform nothing, exactly. It is an input, as the outline is: the matrix that finite elements made.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from concio.contact.assembly import Assembly
from concio.errors import InputError
from concio.fem.discretisation import FIXED, Discretisation
from concio.proof.statement import Numbers, held_points, text_of

Array = np.ndarray


def deformable_statement(assembly: Assembly, data: dict[str, Any], numbers: Numbers = "binary") -> dict[str, Any]:
    """Return the statement of a plane assembly with all that displacements need.

    Parameters
    ----------
    assembly : Assembly
    data : dict
        What :func:`concio.proof.statement.statement` returned.
    numbers : {"binary", "decimal"}

    Raises
    ------
    InputError
        The model is in space, or has joints that dilate.
    """
    refuse(assembly)
    disc = assembly.disc
    free = [free_components(disc, s) for s in range(len(disc.shapes))]
    bodies = [dict(body) for body in data["bodies"]]
    for b, s in enumerate(disc.shape_of.tolist()):
        if s >= 0:
            bodies[b]["shape"] = s
            bodies[b]["nodes"] = [[text_of(x, numbers) for x in node] for node in disc.nodes(b)]
    loads = list(data["loads"])
    for group, f in assembly.loads.items():
        for b in np.flatnonzero(disc.shape_of >= 0).tolist():
            own = f[disc.offsets[b] : disc.offsets[b + 1]][free[disc.shape_of[b]]]
            if own.any():
                force = [text_of(x, numbers) for x in own]
                loads.append({"kind": "nodal", "group": group, "body": b, "force": force})
    shapes = [
        {"free": chosen.tolist(), "k": _stiffness(disc, s, chosen, numbers)} for s, chosen in enumerate(free)
    ]
    return {**data, "bodies": bodies, "shapes": shapes, "loads": loads, "joints": _joints(assembly, data, numbers)}


def refuse(assembly: Assembly) -> None:
    """Refuse what equilibrium certificates do not state, beside what no certificate does.

    Raises
    ------
    InputError
        With the first thing that stands in the way.
    """
    reasons = {
        "is in space, where joints slip in any direction": assembly.model.dim != 2,
        "has a joint that dilates": bool((assembly.laws.dilatancy > 0).any()),
        "has joints whose points change": assembly.first_laws is not None,
    }
    found = next((words for words, holds in reasons.items() if holds), None)
    if found is not None:
        msg = f"the model {found}: its equilibrium is not proved exactly yet"
        raise InputError(msg, hint="the certificate of 'concio run' holds for it, in floating point")


def free_components(disc: Discretisation, s: int) -> Array:
    """Return the components of the nodes of a shape but for three, which hold it as a rigid body."""
    nodes = disc.shapes[s].elements.nodes
    across = nodes - nodes[0]
    far = int(np.argmax((across**2).sum(1)))
    axis = int(np.argmin(np.abs(across[far])))
    return np.setdiff1d(np.arange(nodes.size), [0, 1, 2 * far + axis])


def _stiffness(disc: Discretisation, s: int, chosen: Array, numbers: Numbers) -> list[list[Any]]:
    """Return the upper triangle of the stiffness of a shape on some components: row, column, text."""
    K = disc.shapes[s].K[chosen][:, chosen].tocoo()
    row, column = K.coords
    entries = zip(row.tolist(), column.tolist(), K.data.tolist(), strict=True)
    return [[i, j, text_of(v, numbers)] for i, j, v in entries if i <= j and v]


def _joints(assembly: Assembly, data: dict[str, Any], numbers: Numbers) -> list[dict[str, Any]]:
    """Return joints with gaps, compliances, and the nodes of elastic blocks at which each joint point is."""
    pairs, law, disc = assembly.pairs, assembly.laws, assembly.disc
    joints = [dict(joint) for joint in data["joints"]]
    for k, joint in enumerate(joints[: len(pairs)]):
        values = {
            "gap": pairs.gap[k], "normal_compliance": law.normal_compliance[k],
            "tangential_compliance": law.tangential_compliance[k],
        }  # fmt: skip
        joint |= {name: text_of(value, numbers) for name, value in values.items() if value}
        row = pairs.C_n[[k]]
        axis = int(np.argmax(np.abs(pairs.normal[k])))
        for side, b, sign in (("a", int(pairs.body_a[k]), -1.0), ("b", int(pairs.body_b[k]), 1.0)):
            if b < 0 or disc.shape_of[b] == FIXED or disc.shape_of[b] < 0:
                continue
            own = np.arange(disc.offsets[b] + axis, disc.offsets[b + 1], 2)
            shares = sign * row[:, own].toarray().ravel() / pairs.normal[k, axis]
            at = np.flatnonzero(shares).tolist()
            joint[f"nodes_{side}"] = [[node, text_of(shares[node], numbers)] for node in at]
    for joint, point in zip(joints[len(pairs) :], held_points(assembly), strict=True):
        if point.node is not None:
            joint["nodes_b"] = [[point.node, "1"]]
    return joints
