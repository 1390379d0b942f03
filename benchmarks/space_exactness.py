"""Turning a structure in space must change nothing; what is swept from the plane must say what the plane says.

    python benchmarks/space_exactness.py

Two walls that meet, a dome, a cross vault and a barrel under their weight and a sideways load, rigid, rigid with joints
that give way, and elastic with every element, each solved as it stands and turned by 37 degrees about an axis that is
none of the structure's. Printed are the largest differences of displacements (turned back), normal forces and sizes of
friction forces, over their largest value. Then limit multipliers of walls, an arch and a buttress in the plane and
swept into space by their own thickness, and their difference.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

import concio
from concio import JointLaw, Model

AXIS, ANGLE = (1.0, 2.0, 3.0), 37.0

ELEMENTS = {"H8I": 0.6, "H27": 1.0, "T4": 0.6, "T10": 1.0}
"""Elements and their target sizes [m]."""


def turn() -> np.ndarray:
    """Return the rotation (3, 3)."""
    n, angle = np.array(AXIS) / np.linalg.norm(AXIS), np.radians(ANGLE)
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    matrix: np.ndarray = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return matrix


def structures(**common: object) -> dict[str, Callable[[], Model]]:
    """Return the structures by name."""
    push = {"horizontal": 0.05, "towards": (0.8, 0.6), **common}
    lines = [((0, 0), (1.5, 0)), ((0, 0), (0, 1.0))]
    return {
        "corner": lambda: concio.walls(lines=lines, height=0.5, block_size=(0.5, 0.25, 0.25), **push),
        "dome": lambda: concio.dome(span=4, ring=0.6, courses=3, blocks=6, **push),
        "barrel": lambda: concio.barrel(span=4, ring=0.7, length=1.5, voussoirs=7, blocks=2, **push),
        "cross vault": lambda: concio.cross_vault(span=4, ring=0.5, courses=3, block_length=2.0, springing=55, **push),
    }


def turned_with_loads(model: Model) -> Model:
    """Return a model turned with its loads, the weight among them, which otherwise stays vertical."""
    loads = tuple(replace(load, value=tuple(turn() @ np.array(load.value, dtype=float))) for load in model.loads)
    return replace(concio.place(model, turn=ANGLE, axis=AXIS), loads=loads)


def moved_by(model: Model, there: concio.Result, turned: concio.Result) -> float:
    """Return the largest difference of nodal displacements, turned back, over the largest; nodes matched by place."""
    matrix, worst = turn(), 0.0
    for k, body in enumerate(model.bodies):
        if body.kind != "fixed":
            x = there.nodes(k) @ matrix.T
            near = np.argmin(np.linalg.norm(turned.nodes(k)[:, None] - x, axis=2), axis=1)
            apart = turned.node_displacement(k) - there.node_displacement(k)[near] @ matrix.T
            worst = max(worst, float(np.abs(apart).max()))
    return worst / (float(np.abs(there.displacement).max()) or 1.0)


def same_pairs(there: concio.Result, turned: concio.Result) -> np.ndarray:
    """Return for each pair of the turned structure the one that stands for it, matched by bodies and place (m,)."""
    a, b = there.contacts.pairs, turned.contacts.pairs
    x = np.hstack([a.point, a.normal]) @ np.kron(np.eye(2), turn().T)
    found = np.empty(len(b.point), dtype=int)
    sides = np.column_stack([a.body_a, a.body_b])
    for k, point in enumerate(np.hstack([b.point, b.normal])):
        own = np.flatnonzero((sides == (b.body_a[k], b.body_b[k])).all(axis=1))
        found[k] = own[np.argmin(np.linalg.norm(x[own] - point, axis=1))]
    assert len(np.unique(found)) == len(found) == len(a.point)
    return found


def differences(model: Model) -> tuple[str, int, float, float, float]:
    """Return status, pairs, and how much displacements, normal and friction forces change by turning, relative."""
    there, turned = concio.solve(model), concio.solve(turned_with_loads(model))
    assert there.status is turned.status
    near = same_pairs(there, turned)
    a, b = there.contacts, turned.contacts
    force = float(np.abs(a.normal_force).max())
    size = [np.linalg.norm(c.friction_force, axis=1) for c in (a, b)]
    normal = float(np.abs(b.normal_force - a.normal_force[near]).max()) / force
    friction = float(np.abs(size[1] - size[0][near]).max()) / force
    return there.status.name, len(near), moved_by(model, there, turned), normal, friction


def swept() -> dict[str, Model]:
    """Return plane models by name."""
    return {
        "wall": concio.wall(length=1.5, height=1.0, block="rigid", horizontal=1.0),
        "flemish wall": concio.wall(length=2, height=1.25, bond="flemish", block="rigid", horizontal=1.0),
        "arch": concio.arch(span=4, ring=0.5, voussoirs=11, block="rigid", horizontal=1.0),
        "buttress": concio.buttress(
            base=1.2, top=0.5, height=2, courses=6, block_length=0.4, thrust=4.0, block="rigid"
        ),
        "column": concio.column(width=0.5, height=2.0, blocks=4, block="rigid", horizontal=1.0),
    }


def main() -> None:
    """Print both tables."""
    print("| structure | blocks | outcome | pairs | displacements | normal forces | friction |")
    print("|---|---|---|---|---|---|---|")
    soft = JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=4e5)
    kinds: dict[str, dict[str, object]] = {
        "rigid": {"block": "rigid"},
        "rigid, joints with stiffness": {"block": "rigid", "friction": soft},
    }
    kinds |= {element: {"element": element, "mesh_size": size} for element, size in ELEMENTS.items()}
    for name in structures():
        for kind, common in kinds.items():
            status, pairs, moved, normal, friction = differences(structures(**common)[name]())
            print(f"| {name} | {kind} | {status} | {pairs} | {moved:.0e} | {normal:.0e} | {friction:.0e} |", flush=True)
    print("\n| swept from the plane | plane | space | relative difference |\n|---|---|---|---|")
    for name, plane in swept().items():
        a, b = (
            concio.limit(m, path=False, steps=False, search=False).associated.multiplier
            for m in (plane, concio.extrude(plane))
        )
        print(f"| {name} | {a:.10f} | {b:.10f} | {abs(a - b) / abs(a):.0e} |", flush=True)


if __name__ == "__main__":
    main()
