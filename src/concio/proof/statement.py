"""The numbers of a structure of blocks as an exact certificate states them: as texts that no reader rounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from concio.contact.assembly import Assembly
from concio.contact.edge_loads import loaded_bodies
from concio.contact.loads import load_vectors
from concio.contact.supports import points_held
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID
from concio.kinematics.frames import cross
from concio.model.body import Body
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron

Numbers = Literal["binary", "decimal"]

FIXED_POINTS = "fixed points"
"""Name of the body to which ties and supports are fastened that end at no body."""

REFUSED = "this is not proved exactly yet"

LONG = 10_000
"""Bits from which whole numbers are written in hexadecimal, which Python reads and writes at any length."""


def statement(assembly: Assembly, numbers: Numbers = "binary", *, gaps: bool = False) -> dict[str, Any]:
    """Return blocks, contact points and loads of an assembly, every number a text.

    Parameters
    ----------
    assembly : Assembly
    numbers : {"binary", "decimal"}
        Binary numbers as the computer holds them, such as "0x1.8p-1"; or each rounded to twelve decimal digits, which
        turns 0.1 back into a tenth.
    gaps : bool
        Whether joints may have an initial gap.

    Raises
    ------
    InputError
        The model has something that exact certificates do not state: moved supports, initial gaps, periods.
    """
    refuse(assembly, gaps=gaps)

    def text(value: float) -> str:
        return text_of(value, numbers)

    def texts(values: np.ndarray) -> list[str]:
        return [text(v) for v in np.asarray(values, dtype=float).ravel()]

    model = assembly.model
    bodies = [
        {
            "name": body.name,
            "fixed": body.kind == "fixed",
            "unit_weight": "0" if body.kind == "fixed" else text(model.materials[body.material].unit_weight),
            "thickness": text(body.thickness) if isinstance(body, Body) else "1",
            "pieces": [[texts(corner) for corner in piece] for piece in _pieces(body)],
        }
        for body in model.bodies
    ]
    points = joint_points(assembly)
    if any(min(point.a, point.b) < 0 for point in points):
        nowhere = [["0"] * model.dim] * model.dim
        bodies.append({"name": FIXED_POINTS, "fixed": True, "unit_weight": "0", "thickness": "1", "pieces": [nowhere]})
    joints = [
        {
            "a": point.a % len(bodies), "b": point.b % len(bodies), "at": texts(point.at),
            "normal": texts(point.normal), "friction": text(point.friction),
            **{name: text(value) for name, value in point.more.items()},
        }
        for point in points
    ]  # fmt: skip
    loads = [
        {"kind": "weight", "group": load.group, "body": b, "value": texts(np.array(load.value))}
        for load in model.loads
        if load.kind == "weight"
        for b in loaded_bodies(model, load)
    ]
    loads += [
        {
            "kind": "resultant",
            "group": group,
            "body": b,
            "at": texts(at),
            "force": texts(force),
            "moment": texts(moment),
        }
        for group, b, at, force, moment in _resultants(assembly)
    ]
    return {"title": model.title, "bodies": bodies, "joints": joints, "loads": loads}


@dataclass(frozen=True)
class JointPoint:
    """A point of a joint, a tie, or a point that a support holds.

    Parameters
    ----------
    a, b : int
        Bodies; -1 is a fixed point.
    at, normal : (d,) arrays
        [m]; from a to b.
    friction : float
    more : mapping
        Cohesion, tension and cap where they are not 0, 0 and inf [kN].
    node : int or None
        Node of an elastic block b that a support holds.
    """

    a: int
    b: int
    at: np.ndarray
    normal: np.ndarray
    friction: float
    more: Mapping[str, float] = field(default_factory=dict)
    node: int | None = None


HELD = {"tension": math.inf, "cap": math.inf}


def joint_points(assembly: Assembly) -> list[JointPoint]:
    """Return the contact pairs, ties among them, in their order, then what supports hold of blocks."""
    pairs, law = assembly.pairs, assembly.laws
    at = pairs.point.copy()
    at[assembly.ties] = [tie.at_a for tie in assembly.model.ties] or at[assembly.ties]
    usual = {"cohesion": 0.0, "tension": 0.0, "cap": math.inf}
    found = []
    for k in range(len(pairs)):
        values = {name: float(getattr(law, name)[k]) for name in usual}
        more = {name: value for name, value in values.items() if value != usual[name]}
        found.append(
            JointPoint(int(pairs.body_a[k]), int(pairs.body_b[k]), at[k], pairs.normal[k], float(law.friction[k]), more)
        )
    return found + held_points(assembly)


def held_points(assembly: Assembly) -> list[JointPoint]:
    """Return what supports hold of blocks: a point for each direction in which a place is held."""
    disc, found = assembly.disc, []
    for b, conditions in assembly.supported.held.items():
        for number in dict.fromkeys(c.support for c in conditions):
            chosen, points, _, axes = points_held(disc, b, number)
            nodes = chosen.tolist() if disc.shape_of[b] >= 0 else [None] * len(points)
            found += [
                JointPoint(-1, b, place, np.eye(disc.dim)[axis], 0.0, HELD, node)
                for node, place in zip(nodes, points, strict=True)
                for axis in axes
            ]
    return found


def fraction_text(value: Fraction) -> str:
    """Return a fraction as a certificate has it: "3/4", or "0x3/0x4" where it is long."""
    if max(value.numerator.bit_length(), value.denominator.bit_length()) < LONG:
        return str(value)
    return f"{value.numerator:#x}/{value.denominator:#x}"


def text_of(value: float, numbers: Numbers) -> str:
    """Return a number as a text, see :func:`statement`."""
    return float(value).hex() if numbers == "binary" else f"{float(value):.12g}"


def refuse(assembly: Assembly, *, gaps: bool = False) -> None:
    """Refuse what exact certificates do not state; initial gaps too, unless displacements are stated.

    Raises
    ------
    InputError
        With the first thing that stands in the way.
    """
    model = assembly.model
    reasons: Mapping[str, bool] = {
        "a periodic cell": model.periods is not None,
        "a support that is moved": any(s.moves for s in model.supports),
        "a change of temperature": bool(model.temperatures),
        "a joint with an initial gap": not gaps and bool((assembly.pairs.gap[assembly.pairs.interface >= 0] > 0).any()),
        "no joint": not joint_points(assembly),
    }
    found = next((words for words, holds in reasons.items() if holds), None)
    if found is not None:
        msg = f"the model has {found}: {REFUSED}"
        raise InputError(msg, hint="the certificate of 'concio run' holds for it, in floating point")


def _pieces(body: Body | Polyhedron) -> list[np.ndarray]:
    """Return triangles (3 corners of which the origin is one, left out) or, in space, the triangles of the surface."""
    if isinstance(body, Polyhedron):
        return [body.vertices[corners] for corners in body.triangles[0]]
    return [np.array([p, q]) for ring in body.rings for p, q in zip(ring, np.roll(ring, -1, axis=0), strict=True)]


def _resultants(assembly: Assembly) -> list[tuple[str, int, np.ndarray, np.ndarray, np.ndarray]]:
    """Return group, body, point, force and moment of all loads but self-weight, body by body."""
    disc = assembly.disc
    others = tuple(load for load in assembly.model.loads if load.kind != "weight")
    if not others:
        return []
    found = []
    for group, f in load_vectors(replace(disc, model=_with_loads(assembly.model, others))).items():
        for b in np.flatnonzero(disc.shape_of != FIXED).tolist():
            own = f[disc.offsets[b] : disc.offsets[b + 1]]
            if not own.any():
                continue
            at, d = disc.centroids[b], disc.dim
            if disc.shape_of[b] == RIGID:
                force, moment = own[:d], own[d:] * disc.reach[b]
            else:
                each, arm = own.reshape(-1, d), disc.nodes(b) - at
                force = each.sum(0)
                moment = np.atleast_1d(cross(arm, each).sum(0))
            found.append((group, b, at, force, moment))
    return found


def _with_loads(model: Model, loads: tuple[Any, ...]) -> Model:
    return replace(model, loads=loads)
