"""Joints that carry tension: all pairs stick, one linear problem, whose answer other methods find as well."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

import concio
from concio import Body, Elastic, JointLaw, Load, Model
from concio.kinematics.rigid import rotation_matrix
from concio.problem.contact_problem import ContactProblem
from concio.solvers.auto import chain
from samples import sample

Array = np.ndarray
STONE = Elastic(E=1e6, nu=0.2, unit_weight=20.0)


def bonded(strength: float, friction: float = 1.0) -> JointLaw:
    return JointLaw(friction=friction, cohesion=friction * strength, tensile_strength=strength)


def dome(strength: float, mesh_size: float = 0.5, stiffness: float | None = None) -> Model:
    law = replace(bonded(strength), normal_stiffness=stiffness, tangential_stiffness=stiffness)
    return concio.dome(
        span=1.98, ring=0.02, courses=2, blocks=6, bond="stack", friction=law,
        block=Elastic(E=1e6, nu=0.0, unit_weight=20.0), mesh_size=mesh_size,
    )  # fmt: skip


def pushed(problem: ContactProblem, share: Array) -> ContactProblem:
    """Return the problem with a share (2,) of the weights acting along x and y."""
    f = problem.f.reshape(-1, 3).copy()
    f[:, :2] += f[:, 2:] * share
    return problem.with_loads(f.ravel())


def distance(a: Array, b: Array) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


def tied(problem: ContactProblem, least: float = 1e-10) -> Array:
    """Return the displacements of bodies whose pairs are tied: least energy on the null space of C.

    Combinations of rows whose singular value is below ``least`` are left out.
    """
    _, sizes, rows = np.linalg.svd(problem.C.toarray())
    free = rows[(sizes > least).sum() :].T
    return np.asarray(free @ np.linalg.solve(free.T @ (problem.K @ free), free.T @ problem.f))


def stiff(problem: ContactProblem, stiffness: float) -> Array:
    """Return the displacements of bodies in joints of a stiffness [kN/m3] that never open or slip."""
    springs = stiffness * np.concatenate([problem.area, np.repeat(problem.area, problem.dim - 1)])
    C = problem.C
    return np.asarray(spsolve(sp.csc_array(problem.K + C.T @ sp.diags_array(springs) @ C), problem.f))


@pytest.mark.parametrize("strength", [1e6, 1e8])
def test_elastic_blocks_in_joints_far_stronger_than_their_loads_are_decided(strength: float) -> None:
    problem = concio.assemble(dome(strength)).problem()
    found = chain.solve(problem)
    assert found.info["strategy"] == "all pairs stick"
    assert found.certificate.worst < 1e-12
    assert distance(found.displacement, tied(problem)) < 1e-9


@pytest.mark.long  # the random walls
def test_stiff_joints_tend_to_hard_ones_late_where_couplings_nearly_say_the_same_twice() -> None:
    """At the crown three bodies meet whose meshes do not match: rows of C are nearly dependent, and bind late."""
    problem = concio.assemble(dome(1e6)).problem()
    hard = chain.solve(problem).displacement
    sizes = np.linalg.svd(problem.C.toarray(), compute_uv=False)
    assert ((sizes > 1e-10) & (sizes < 2e-3)).sum() == 18
    without = tied(problem, least=2e-3)
    assert distance(hard, tied(problem)) < 1e-9
    assert distance(without, hard) > 0.05
    assert distance(stiff(problem, 1e12), without) < 0.1 * distance(without, hard)
    far = [distance(stiff(problem, k), hard) for k in (1e12, 1e13, 1e14, 1e15, 1e16)]
    assert far == sorted(far, reverse=True)
    assert far[-1] < 0.1 * distance(without, hard)


@pytest.mark.long
def test_the_further_constraint_vanishes_as_meshes_are_refined() -> None:
    apart, traction = [], []
    for size in (0.5, 0.1):
        hard, soft = (concio.solve(dome(1e7, size, stiffness)) for stiffness in (None, 1e11))
        assert hard.solution.info["strategy"] == "all pairs stick"
        most = [float(np.abs(r.displacement).max()) for r in (hard, soft)]
        apart.append(abs(most[0] / most[1] - 1.0))
        traction.append(float(np.abs(hard.contacts.pressure).max()))
    assert apart[0] > 0.02
    assert apart[1] < 1e-3
    assert traction[1] < 0.01 * traction[0]


def wall(law: JointLaw, rng: np.random.Generator) -> Model:
    """A wall of random size whose joints carry tension."""
    plane = concio.wall(
        length=rng.uniform(0.4, 0.6), height=0.25, friction=law, block=replace(STONE, nu=rng.uniform(0.0, 0.3))
    )
    return concio.extrude(plane, rng.uniform(0.1, 0.3))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 4, 12)))
def test_random_bonded_walls_are_the_limit_of_stiff_joints(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = pushed(concio.assemble(wall(bonded(1e5), rng)).problem(), rng.uniform(-0.5, 0.5, 2))
    found = chain.solve(problem)
    assert found.info["strategy"] == "all pairs stick"
    assert distance(found.displacement, tied(problem)) < 1e-9
    near, nearer = (distance(stiff(problem, k), found.displacement) for k in (1e13, 1e14))  # weak rows bind, too
    assert nearer < 1e-4
    assert nearer == pytest.approx(0.1 * near, rel=0.2)  # what is left falls in proportion to the compliance


@pytest.mark.parametrize("seed", range(sample(1, 4, 12)))
def test_cracked_or_not_the_answer_is_that_of_the_interior_point(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng([7, seed])
    law = bonded(10.0 ** rng.uniform(0.3, 2.0), rng.uniform(0.5, 1.0))
    problem = pushed(concio.assemble(wall(law, rng)).problem(), rng.uniform(-0.5, 0.5, 2))
    found = chain.solve(problem)
    monkeypatch.setattr(chain, "STRATEGIES", chain.STRATEGIES[1:])
    other = chain.solve(problem)
    assert other.info["strategy"] != "all pairs stick"
    assert found.status is other.status
    if found.solved:
        assert distance(found.displacement, other.displacement) < 1e-9
        assert distance(found.normal_force, other.normal_force) < 1e-9


def column(cuts: Array, dim: int) -> concio.Result:
    """A column of one metre on the ground, cut into blocks at heights ``cuts``, its meshes the same wherever it is."""
    ends = [0.0, *cuts.tolist(), 1.0]
    blocks = [
        Body(f"b{k}", [(0, a), (0.5, a), (0.5, b), (0, b)], mesh_size=0.125, grid=grid(a, b))
        for k, (a, b) in enumerate(pairwise(ends))
    ]
    ground = Body("g", [(-1, -1), (2, -1), (2, 0), (-1, 0)], kind="fixed")
    loads = (Load("weight", (0.4, -1.0)), Load("point", (3.0, 1.0), bodies=(blocks[-1].name,), at=(0.0, 1.0)))
    model = Model((ground, *blocks), {"block": STONE}, {"joint": bonded(1e6)}, loads=loads)
    return concio.solve(concio.extrude(model, 0.25) if dim == 3 else model)


def grid(low: float, high: float) -> tuple[Array, Array]:
    return np.linspace(0, 0.5, 5), np.linspace(low, high, round((high - low) * 8) + 1)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("cuts", [[0.5], [0.25, 0.625, 0.75]])
def test_bonded_blocks_of_matching_meshes_are_one_block(dim: int, cuts: list[float]) -> None:
    whole, parts = column(np.array([]), dim), column(np.array(cuts), dim)
    nodes, moved = whole.assembly.disc.nodes(1), whole.node_displacement(1)
    count = 0
    for b in range(1, len(parts.model.bodies)):
        for at, u in zip(parts.assembly.disc.nodes(b), parts.node_displacement(b), strict=True):
            twin = np.abs(nodes - at).max(axis=1)
            assert twin.min() < 1e-12
            assert np.abs(u - moved[twin.argmin()]).max() < 1e-9 * np.abs(moved).max()
            count += 1
    assert count > len(nodes)  # every node, those at the cuts twice


@pytest.mark.long
def test_a_strength_that_is_not_reached_changes_no_force() -> None:
    """Where several blocks meet forces are not unique: the least are taken, and least is nothing, not the strength."""
    panels = [
        concio.solve(
            concio.running_bond_panel(
                courses=3, blocks=3, block_size=(0.2, 0.1), joint=0.0, thickness=0.1, block=STONE,
                friction=bonded(strength), base="bearings", side_walls=False, top_pressure=10.0,
            )
        ) for strength in (1e2, 1e5)
    ]  # fmt: skip
    vaults = [concio.solve(dome(strength)) for strength in (1e6, 1e7)]
    for weak, strong in (panels, vaults):
        assert (weak.contacts.state == 1).all()
        assert distance(strong.contacts.force_on_b, weak.contacts.force_on_b) < 1e-8


@pytest.mark.long  # walls of bonded joints
def test_a_bonded_dome_may_be_turned() -> None:
    turned = concio.place(dome(1e6), turn=37.0, axis=(1.0, 2.0, 3.0))
    there, here = (concio.assemble(m).problem() for m in (dome(1e6), turned))
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    Q = rotation_matrix(np.radians(37.0) * axis)
    still = chain.solve(there)
    moved = chain.solve(here.with_loads((there.f.reshape(-1, 3) @ Q.T).ravel()))
    assert distance(moved.displacement.reshape(-1, 3), still.displacement.reshape(-1, 3) @ Q.T) < 1e-8
