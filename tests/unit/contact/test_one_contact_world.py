"""Rest is a configuration like any other: pairs of statics are those of motion where bodies were described."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.contact.assembly import assemble
from concio.contact.edge_search import EdgeSearch
from concio.contact.face_points import Standing
from concio.contact.operators import nodal_entries, operators, rigid_entries
from concio.contact.reference import Reference
from concio.kinematics.frames import components, frames
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import motions, rigid_row, rotation_matrix, swept
from concio.kinematics.turns import Turns
from models import box, model_of, weight
from samples import first

LAWS = (
    0.6,
    concio.JointLaw(0.5, normal_stiffness=1e6, tangential_stiffness=5e5),
    concio.JointLaw(0.5, compressive_strength=1e3, cohesion=10.0, tensile_strength=5.0),
)


def wall(kinds, law, angle):
    """Return a bond of three courses on a floor, turned by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    bodies = [box("floor", -3.0, 6.0, -0.5, 0.0, kind="fixed")]
    for row in range(3):
        for k in range(3):
            kind = kinds[(row + k) % len(kinds)]
            left = 0.25 * (row % 2) + 0.5 * k
            options = {"material": "stone"} if kind == "rigid" else {}
            bodies.append(box(f"b{row}{k}", left, left + 0.5, 0.25 * row, 0.25 * (row + 1), kind=kind, **options))
    turned = [replace(b, outline=b.outline @ np.array([[c, s], [-s, c]]), grid=None) for b in bodies]
    return model_of(*turned, law=law, loads=(weight(),))


def dense(columns, values, unknowns):
    """Return rows (m, d, N) of entries kept as columns (m, w) and values (m, d, w)."""
    m, d, _ = values.shape
    found = np.zeros((m, d, unknowns + 1))
    for k in range(m):
        np.add.at(found[k].T, columns[k], values[k].T)
    return found[:, :, :unknowns]


@pytest.mark.parametrize("kinds", [("rigid",), ("elastic",), ("rigid", "elastic")])
@pytest.mark.parametrize("law", range(len(LAWS)))
@pytest.mark.parametrize("angle", first(1, [0.7, 0.0]))
def test_statics_is_the_configuration_at_rest(kinds, law, angle):
    """Every pair of statics is a slot of the search at rest, with the same point, normal, gap, area, law and rows."""
    model = wall(kinds, LAWS[law], angle)
    assembly, reference = assemble(model), Reference.of(model)
    pairs, search, here = assembly.pairs, EdgeSearch(reference), reference.at_rest()
    search.update(here.placement)
    still = np.zeros_like(here.placement.centre), np.zeros(len(model.bodies))
    rows, slots = search.rows(here.placement, *still, here.strain), search.layout.slots
    own = np.flatnonzero(slots.bonded)
    assert len(own) == len(pairs)
    place = np.column_stack([slots.body_a[own], slots.body_b[own], rows.point[own].round(9)])
    wanted = np.column_stack([pairs.body_a, pairs.body_b, pairs.point.round(9)])
    own = own[np.lexsort(place.T)]
    pick = np.lexsort(wanted.T)
    for name in ("point", "normal", "area", "gap"):
        assert getattr(rows, name)[own] == pytest.approx(getattr(pairs, name)[pick], abs=1e-12), name
    assert (slots.law[own] == pairs.law[pick]).all()
    found = dense(rows.columns[own], rows.values[own], reference.disc.unknowns)
    assert np.abs(found).max() > 0.5
    assert found[:, 0] == pytest.approx(pairs.C_n.toarray()[pick], abs=1e-12)
    assert found[:, 1] == pytest.approx(pairs.C_t.toarray()[pick], abs=1e-12)


@pytest.mark.parametrize("d", [2, 3])
def test_operators_are_differences_of_displacements(d):
    """Of two bodies that move at random, one rigid and one of nodes: the same as their points moved by hand."""
    rng = np.random.default_rng(d)
    m, k = 7, motions(d)
    normal = rng.normal(size=(m, d))
    frame = frames(normal / np.linalg.norm(normal, axis=1)[:, None])
    assert np.einsum("mij,mkj->mik", frame, frame) == pytest.approx(np.tile(np.eye(d), (m, 1, 1)), abs=1e-14)
    arm, weight_of, reach = rng.normal(size=(m, d)), rng.random(m), 0.7
    pair = np.arange(m)
    entries = [
        rigid_entries(pair, frame, arm, reach, np.zeros(m, dtype=int), -1.0),
        nodal_entries(pair, frame, weight_of, k + d * pair, 1.0),
    ]
    u = rng.normal(size=k + d * m)
    C_n, C_t = operators(entries, m, len(u), d)
    rotation = u[d:k] / reach
    rigid = u[:d] + swept(np.full(m, rotation[0]) if d == 2 else np.tile(rotation, (m, 1)), arm)
    wanted = components(weight_of[:, None] * u[k:].reshape(m, d) - rigid, frame)
    assert C_n @ u == pytest.approx(wanted[:, 0], abs=1e-13)
    assert (C_t @ u).reshape(m, d - 1) == pytest.approx(wanted[:, 1:], abs=1e-13)
    assert rigid_row(frame, arm[:, None], reach).shape == (m, d, k)


@pytest.mark.parametrize("d", [2, 3])
def test_screws_are_many_small_motions(d):
    """A motion of constant velocity in the body's own frame: ten thousand small steps lead to the same place."""
    rng = np.random.default_rng(d)
    shift = rng.normal(size=(3, d))
    turn = rng.normal(size=3) if d == 2 else rng.normal(size=(3, 3))
    start = Placement.at_rest(rng.normal(size=(3, d)))
    end, n = start.screwed(shift, turn), 4000
    step, here = Turns.of(turn / n if d == 2 else rotation_matrix(turn / n)), start.centre
    half = Turns.of(0.5 * turn / n if d == 2 else rotation_matrix(0.5 * turn / n))
    velocity = half.apply(shift / n)
    for _ in range(n):
        here = here + velocity
        velocity = step.apply(velocity)
    assert end.centre == pytest.approx(here, abs=1e-6)
    assert end.rotation == pytest.approx(turn if d == 2 else rotation_matrix(turn), abs=1e-12)
    still = start.screwed(shift, 0.0 * turn)
    assert still.centre == pytest.approx(start.centre + shift, abs=1e-15)


@pytest.mark.parametrize("d", [2, 3])
def test_turns_are_matrices(d):
    """Vectors of any number of axes are turned, and turned back, as matrices turn them; what does not move stays."""
    rng = np.random.default_rng(d)
    rotation = rng.normal(size=4) if d == 2 else rotation_matrix(rng.normal(size=(4, 3)))
    placement = Placement(rng.normal(size=(4, d)), rotation)
    for shape in ((4, d), (4, 3, d), (4, 2, 3, d)):
        v = rng.normal(size=shape)
        turned = placement.turns.apply(v)
        assert turned == pytest.approx(np.einsum("kij,k...j->k...i", placement.matrix, v), abs=1e-14)
        assert placement.turns.undo(turned) == pytest.approx(v, abs=1e-14)
    standing, point = Standing(np.zeros((4, d)), placement), rng.normal(size=(2, d))
    carried = standing.carry(np.array([-1, 2]), point)
    assert carried[0] == pytest.approx(point[0], abs=0.0)
    assert carried[1] == pytest.approx(placement.centre[2] + placement.matrix[2] @ point[1], abs=1e-14)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_ties_of_statics_stretch_as_their_ends_move(d, kind):
    """Closing of the pair of a tie is what its two ends come nearer, to a fixed point and to a block that deforms."""
    if d == 2:
        material = {"material": "stone"} if kind == "rigid" else {}
        block = box("block", 0.0, 1.0, 0.0, 0.5, kind=kind, **material)
        ground, law, loads = box("ground", -1.0, 2.0, -1.0, 0.0, kind="fixed"), 0.6, (weight(),)
        model = model_of(ground, block, law=law, loads=loads)
    else:
        stone = concio.Rigid(20.0) if kind == "rigid" else concio.Elastic(1e6, 0.2, unit_weight=20.0)
        block = concio.Polyhedron.box("block", (0, 0, 0), (1, 1, 0.5), kind=kind)
        ground = concio.Polyhedron.box("ground", (-1, -1, -1), (2, 2, 0), kind="fixed")
        joint = {"joint": concio.JointLaw(0.6)}
        model = concio.Model((ground, block), {"block": stone}, joint, loads=(concio.Load("weight", (0, 0, -1)),))
    at, far = ((0.9, 0.4), (2.0, 1.5)) if d == 2 else ((0.9, 0.8, 0.4), (2.0, 0.5, 1.5))
    ties = (
        concio.Tie("out", "block", at, "", far, stiffness=1e3, prestress=2.0),
        concio.Tie("down", "ground", (*far[:-1], -0.5), "block", at, stiffness=1e3),
    )
    assembly = assemble(replace(model, ties=ties))
    u = 1e-3 * np.random.default_rng(d).normal(size=assembly.disc.unknowns)
    unknowns, operator = assembly.disc.point_operator(1, np.array(at))
    moved = operator @ u[unknowns]
    for tie, row in zip(ties, assembly.pairs.C_n[assembly.ties] @ u, strict=True):
        other = np.array(tie.at_b if tie.body_a == "block" else tie.at_a)
        away = (np.array(at) - other) / np.linalg.norm(np.array(at) - other)
        assert row == pytest.approx(-away @ moved, rel=1e-12)
