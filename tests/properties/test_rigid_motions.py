"""K R = 0 and C of a motion of everything = 0, for any polygons, meshes, elements and places."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from concio.contact.assembly import assemble
from concio.fem.discretisation import FIXED, RIGID
from concio.fem.elements import FAMILIES
from concio.model.generate.arches import arch
from concio.model.generate.rubble import rubble
from concio.model.generate.walls import wall
from concio.model.materials import Elastic, Rigid
from models import turned
from samples import sample

few = settings(max_examples=sample(6, 15), deadline=None)


structures = st.fixed_dictionaries(
    {
        "kind": st.sampled_from(["rubble", "arch", "wall"]),
        "rigid": st.booleans(),
        "element": st.sampled_from(list(FAMILIES)),
        "seed": st.integers(0, 99),
        "angle": st.floats(0, 6.3),
        "move": st.tuples(st.floats(-50, 50), st.floats(-50, 50)),
    }
)


def build(choice):
    block = Rigid(20.0) if choice["rigid"] else Elastic(E=1e5, nu=0.2, unit_weight=20.0)
    common = {"block": block, "element": choice["element"]}
    seed = choice["seed"]
    if choice["kind"] == "rubble":
        model = rubble(length=1.5, height=1, stone=0.5, seed=seed, **common)
    elif choice["kind"] == "arch":
        model = arch(span=3.0, ring=0.4, voussoirs=3 + seed % 7, **common)
    else:
        model = wall(length=1.0, height=0.5, bond=("running", "english", "flemish")[seed % 3], **common)
    return turned(model, choice["angle"], choice["move"])


def motion_of_all(disc, translation, rotation, about):
    u = np.zeros(disc.unknowns)
    for b, s in enumerate(disc.shape_of):
        own = slice(disc.offsets[b], disc.offsets[b + 1])
        if s == FIXED:
            continue
        points = disc.centroids[b][None] if s == RIGID else disc.nodes(b)
        x, y = (points - about).T
        moved = np.column_stack([translation[0] - rotation * y, translation[1] + rotation * x]).ravel()
        u[own] = np.append(moved, rotation * disc.reach[b]) if s == RIGID else moved
    return u


@few
@given(structures, st.tuples(st.floats(-1, 1), st.floats(-1, 1)), st.floats(-1, 1))
def test_rigid_motions_cost_no_energy_and_open_no_joint(choice, translation, rotation):
    model = build(choice)
    assembly = assemble(model)
    disc, pairs = assembly.disc, assembly.pairs
    u = motion_of_all(disc, translation, rotation, disc.centroids.mean(0))
    size = np.abs(u).max() + 1e-300
    K = assembly.K
    if K.nnz:
        assert np.abs(K @ u).max() <= 1e-10 * abs(K).max() * size
        assert (K != K.T).nnz == 0
    between = (disc.shape_of[pairs.body_a] != FIXED) & (disc.shape_of[pairs.body_b] != FIXED)
    for C in (pairs.C_n, pairs.C_t):
        assert np.abs((C @ u)[between]).max(initial=0.0) <= 1e-6 * size  # edges within the tolerance are not one line
    problem = assembly.problem()
    R = problem.R
    np.testing.assert_allclose((R.T @ R).toarray(), np.eye(R.shape[1]), atol=1e-12)
    assert R.shape[1] == 3 * len(model.free_bodies)
    if K.nnz:
        assert abs(problem.K @ R).max() <= 1e-11 * abs(K).max()


@few
@given(structures, st.integers(0, 10**6))
def test_contact_forces_balance_each_other(choice, seed):
    """Any contact forces between free bodies have no resultant and (edges touching) no moment."""
    model = build(choice)
    assembly = assemble(model)
    disc, pairs = assembly.disc, assembly.pairs
    between = (disc.shape_of[pairs.body_a] != FIXED) & (disc.shape_of[pairs.body_b] != FIXED)
    rng = np.random.default_rng(seed)
    f = pairs.C_n.T @ (between * rng.uniform(0, 1, len(pairs))) + pairs.C_t.T @ (
        between * rng.uniform(-1, 1, len(pairs))
    )
    about = disc.centroids.mean(0)
    for k, motion in enumerate(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))):
        virtual = motion_of_all(disc, motion[:2], motion[2], about)
        assert abs(f @ virtual) <= (1e-10 if k < 2 else 1e-5) * max(np.abs(f).sum(), 1.0)
