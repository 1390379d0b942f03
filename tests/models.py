"""Small models for several test files, and what can be done to a whole model: move, mirror, renumber, change units."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import concio
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Body, JointRule, Load, Model, Support

SOFT = Elastic(E=1e4, nu=0.2, unit_weight=20.0)


def box(name, x0, x1, y0, y1, **options):
    """A rectangular body; ``kind="fixed"`` makes an obstacle."""
    return Body(name, np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float), **options)


def model_of(*bodies, law=0.5, materials=None, **options):
    """Model with one joint law for all interfaces; materials "block" (elastic) and "stone" (rigid) exist."""
    law = law if isinstance(law, JointLaw) else JointLaw(law)
    table = {"block": SOFT, "stone": Rigid(20.0), **(materials or {})}
    return Model(bodies, table, {"joint": law}, **options)


def on_ground(*bodies, **options):
    """Like :func:`model_of`, with a wide ground below y = 0."""
    return model_of(box("ground", -5, 5, -1, 0, kind="fixed", role="ground"), *bodies, **options)


def weight(x=0.0, y=-1.0, group="dead"):
    return Load("weight", (x, y), group=group)


def bearing_panel():
    """A mortared panel between walls that spans two bearings under pressure: it stands as a flat arch."""
    return concio.running_bond_panel(courses=2, blocks=3, joint=0.02, friction=0.6, base="bearings", top_pressure=10.0)


def sliding_panel():
    """A dry panel pushed sideways by more than friction holds: a mechanism."""
    return concio.running_bond_panel(
        courses=2, blocks=2, friction=0.3, base="full", side_walls=False, unit_weight=20.0, horizontal=0.6
    )


def mapped(model, point, vector, turn=1.0):
    """The model with every coordinate, direction and orientation changed; ``turn`` is -1 for a mirror."""

    def ends(edge):
        return None if edge is None else tuple(tuple(point(np.array(p, dtype=float))) for p in edge)

    def directed(load):
        value = load.value if load.kind == "pressure" else tuple(vector(np.array(load.value)))
        at = None if load.at is None else tuple(point(np.array(load.at)))
        return replace(load, value=value, edge=ends(load.edge), at=at)

    return replace(
        model,
        bodies=tuple(
            replace(b, outline=point(b.outline), grid=None, holes=tuple(point(h) for h in b.holes))
            for b in model.bodies
        ),
        loads=tuple(directed(load) for load in model.loads),
        supports=tuple(
            replace(
                s, edge=ends(s.edge), displacement=tuple(vector(np.array(s.displacement))), rotation=turn * s.rotation
            )
            for s in model.supports
        ),
        ties=tuple(
            replace(t, at_a=tuple(point(np.array(t.at_a))), at_b=tuple(point(np.array(t.at_b)))) for t in model.ties
        ),
    )  # fmt: skip


def turned(model, angle, move=(0.0, 0.0)):
    """The model rotated about the origin, then moved."""
    c, s = np.cos(angle), np.sin(angle)
    Q = np.array([[c, -s], [s, c]])
    return mapped(model, lambda x: x @ Q.T + np.array(move), lambda v: Q @ v)


def mirrored(model):
    """The model seen from behind: x becomes -x."""
    flip = np.array([-1.0, 1.0])
    return mapped(model, lambda x: x * flip, lambda v: v * flip, -1.0)


def renumbered(model, order):
    """The model with its bodies in another order."""
    return replace(model, bodies=tuple(model.bodies[k] for k in order))


def in_units(model, force, length):
    """The model in units in which 1 kN is ``force`` and 1 m is ``length``."""
    stress, volume = force / length**2, force / length**3

    def material(m):
        weight_ = m.unit_weight * volume
        return Rigid(weight_) if isinstance(m, Rigid) else Elastic(m.E * stress, m.nu, weight_)

    def law(j):
        def times(v, f):
            return None if v is None else v * f

        return JointLaw(
            j.friction, j.cohesion * stress, j.tensile_strength * stress, j.dilatancy,
            times(j.normal_stiffness, volume), times(j.tangential_stiffness, volume),
            times(j.compressive_strength, stress),
        )  # fmt: skip

    factor = {"weight": 1.0, "pressure": stress, "traction": stress, "point": force, "body": volume}

    def points(value):
        return None if value is None else tuple(tuple(np.array(p) * length) for p in value)

    def lines(grid):
        return None if grid is None else tuple(np.asarray(g) * length for g in grid)

    return replace(
        model,
        bodies=tuple(
            replace(
                b, outline=b.outline * length, holes=tuple(h * length for h in b.holes),
                thickness=b.thickness * length, grid=lines(b.grid),
                mesh_size=None if b.mesh_size is None else b.mesh_size * length,
            )
            for b in model.bodies
        ),
        materials={k: material(m) for k, m in model.materials.items()},
        laws={k: law(j) for k, j in model.laws.items()},
        rules=tuple(JointRule(r.law, r.between, r.gap * length) for r in model.rules),
        loads=tuple(
            replace(
                q, value=tuple(v * factor[q.kind] for v in q.value), edge=points(q.edge),
                at=None if q.at is None else tuple(np.array(q.at) * length),
            )
            for q in model.loads
        ),
        supports=tuple(
            Support(
                s.name, s.body, points(s.edge), s.directions, tuple(np.array(s.displacement) * length), s.rotation,
                s.group,
            )
            for s in model.supports
        ),
        ties=tuple(
            replace(
                t, at_a=tuple(np.array(t.at_a) * length), at_b=tuple(np.array(t.at_b) * length),
                stiffness=t.stiffness * force / length, prestress=t.prestress * force,
            )
            for t in model.ties
        ),
        mesh_size=None if model.mesh_size is None else model.mesh_size * length,
        gap_tolerance=None if model.gap_tolerance is None else model.gap_tolerance * length,
        gap_reach=None if model.gap_reach is None else model.gap_reach * length,
    )  # fmt: skip


def corner_displacements(result):
    """Displacements (., 2) of the outline vertices of every free body, keyed by body name; vertices in model order."""
    found = {}
    for b in result.model.free_bodies:
        nodes, u = result.nodes(b.name), result.node_displacement(b.name)
        found[b.name] = np.array([u[np.argmin(np.hypot(*(nodes - v).T))] for v in b.outline])
    return found
