"""The reductions are the same problem: their forms, their eliminations and the sparse method agree on one answer."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from concio.errors import MethodError
from concio.problem.pair_state import Normal
from concio.problem.solution import Status
from concio.solvers.lcp.lemke_method import Outcome, lemke
from concio.solvers.methods import find
from concio.solvers.methods.forms.condensation import condense
from concio.solvers.methods.forms.dense_solve import DenseRun, read_states
from concio.solvers.methods.forms.force_method import force_method
from concio.solvers.methods.forms.forms import mixed_form
from concio.solvers.methods.forms.reduction import reduce
from concio.solvers.methods.forms.split_motions import join, split
from contact_problems import wall
from lcp_problems import small_wall
from samples import first

LAWS = [
    (),
    ("cohesion",),
    ("tension", "gap"),
    ("dilatancy", "origin"),
    ("springs", "tension", "gap", "origin", "dilatancy"),
]


def test_generalised_inverse_and_equilibrium() -> None:
    """u = u0 + K+ C' t + R alpha satisfies equilibrium for forces in equilibrium, and y = y0 + F t + G alpha."""
    problem = wall(2, 2, alpha=0.2)
    reduction = reduce(problem)
    system, m = reduction.system, problem.pairs
    t = np.linalg.lstsq(reduction.G.T, -reduction.e0, rcond=None)[0]
    alpha = np.arange(problem.rigid_motions, dtype=float)
    u = reduction.displacement(t, alpha) / system.s.length
    C = system.C[np.concatenate([2 * np.arange(m), 2 * reduction.rough + 1])]
    np.testing.assert_allclose(system.K @ u, system.load + C.T @ t, atol=1e-11 * np.abs(system.K @ u).max())
    y = reduction.y0 + reduction.F @ t + reduction.G @ alpha
    np.testing.assert_allclose(C @ u + system.x.ravel()[np.r_[2 * np.arange(m), 2 * reduction.rough + 1]], y, atol=1e-9)
    assert np.linalg.eigvalsh(reduction.F).min() > -1e-12 * np.abs(reduction.F).max()


def test_4m_form_is_copositive_and_3m_is_not() -> None:
    reduction = reduce(wall(2, 2, mu=5.0))
    four, three = mixed_form(reduction, "4m"), mixed_form(reduction, "3m")
    rng = np.random.default_rng(0)
    z = rng.exponential(size=(200, four.size)) * (rng.random((200, four.size)) < 0.3)
    assert np.einsum("ki,ij,kj->k", z, four.M, z).min() >= -1e-9
    assert np.diag(three.M)[: reduction.pairs].min() < 0  # F_nn - mu F_nt of a single pair


@pytest.mark.parametrize("laws", first(3, LAWS, single=True), ids=lambda n: "+".join(n) or "plain")
def test_all_reductions_agree_on_floating_blocks(laws: tuple[str, ...]) -> None:
    problem = small_wall(1, *laws, alpha=0.1)
    answer = find("sparse-lemke")(problem)
    assert answer.certificate.worst <= 1e-11
    size = np.abs(answer.displacement).max()
    for name, options in (
        ("ercolano", {}),
        ("ercolano", {"form": "3m"}),
        ("lee", {}),
        ("lee", {"form": "3m"}),
        ("lemke", {}),
    ):
        other = find(name)(problem, **options)
        assert other.solved, (name, options, other.trace)
        assert other.certificate.worst <= 1e-10
        np.testing.assert_allclose(
            other.displacement, answer.displacement, atol=1e-8 * size, err_msg=f"{name} {options}"
        )


@pytest.mark.parametrize("name", ["3m", "4m"])
@pytest.mark.parametrize("laws", [("dilatancy", "origin"), ("tension", "gap", "cohesion")], ids="+".join)
def test_states_of_a_complementary_solution_are_those_of_its_gaps_slips_and_forces(
    name: str, laws: tuple[str, ...]
) -> None:
    """A pair is open where it has a gap and sticks where friction is left; else it slips the way it slipped."""
    problem = small_wall(1, *laws, alpha=0.3)
    form = mixed_form(reduce(problem), name)  # type: ignore[arg-type]
    rough, system = form.reduction.rough, form.reduction.system
    lcp, back = force_method(form).standard()
    result = lemke(lcp)
    assert result.outcome is Outcome.SOLVED
    z, w = back(result.z, result.w)
    normal, sign = read_states(form, z, w)
    y, t, m = form.components(z, w), form.forces(z), problem.pairs
    left = system.cone.strength(t[:m])[rough] - np.abs(t[m:])
    small = 1e-7 * np.abs(y).max(), 1e-7 * np.abs(t).max()
    gap, slip = w[:m], y[m:]
    assert (normal[gap > small[0]] == Normal.OPEN).all()
    assert (normal[t[:m] > small[1]] == Normal.CLOSED).all()
    grazes = (t[:m] <= small[1]) & (gap <= small[0])  # neither gap nor force: it may slip either way
    slips = (np.abs(slip) > small[0]) & ~grazes[rough]
    assert slips.any()
    assert (sign[rough][slips] == np.sign(slip[slips])).all()
    sticks = (left > small[1]) & (normal[rough] == Normal.CLOSED)
    assert sticks.any()
    assert (sign[rough][sticks] == 0).all()


def test_six_unknowns_are_saved_for_each_free_body() -> None:
    problem = wall(3, 3)
    form = mixed_form(reduce(problem), "3m")
    free = problem.bodies.size - 1
    assert split(form).size - force_method(form).standard()[0].size == 6 * free
    assert force_method(form).generalised().size == 3 * problem.pairs


def test_generalised_problem_of_the_paper_is_the_standard_one() -> None:
    """The answer of the explicit elimination obeys (33), and its basis is a complementary one."""
    problem = wall(1, 2, alpha=0.1)
    chosen = force_method(mixed_form(reduce(problem), "4m"))
    general = chosen.generalised()
    lcp, back = chosen.standard()
    result = lemke(lcp)
    z, w = back(result.z, result.w)
    assert result.outcome is Outcome.SOLVED
    assert general.residual(z, w) <= 1e-9 * (1 + np.abs(general.A).max())
    basis, others = (np.where(chosen.basis() == taken, general.A, general.B) for taken in (True, False))
    np.testing.assert_allclose(-np.linalg.solve(basis, others), lcp.M, atol=1e-7)
    np.testing.assert_allclose(np.linalg.solve(basis, general.c), lcp.q, atol=1e-7)
    form = chosen.form
    solved = lemke(split(form))
    z_split, alpha = join(form, solved.z)
    np.testing.assert_allclose(form.E @ z_split + form.e, 0, atol=1e-9)
    assert alpha.size == problem.rigid_motions


def test_rigid_coordinates_are_normal_gaps_where_they_serve() -> None:
    boxed = force_method(mixed_form(reduce(wall(2, 2, sides=True)), "4m"))
    assert boxed.normal_only
    assert boxed.condition < 1e4
    lying = mixed_form(reduce(wall(1, 1)), "4m")  # nothing normal stops a block that lies on a flat base
    with pytest.raises(MethodError, match="normal gaps alone"):
        force_method(lying, normal_only=True)
    chosen = force_method(lying)
    assert not chosen.normal_only
    assert chosen.condition < 1e4


def test_condensation_refuses_floating_bodies_and_names_methods_that_take_them() -> None:
    with pytest.raises(MethodError, match="ercolano"):
        find("klarbring")(wall(1, 2))
    with pytest.raises(MethodError, match="9 rigid motions"):
        condense(mixed_form(reduce(wall(1, 3)), "3m"))


@pytest.mark.parametrize("form", ["3m", "4m"])
def test_klarbring_on_an_elastic_foundation(form: str) -> None:
    problem = wall(3, 3, alpha=0.4, soil=5.0)
    answer, other = find("klarbring")(problem, form=form), find("sparse-lemke")(problem)
    assert answer.solved
    np.testing.assert_allclose(answer.displacement, other.displacement, atol=1e-9 * np.abs(other.displacement).max())


def test_del_piero_frictionless_and_tresca() -> None:
    problem = wall(2, 3, mu=0.0, sides=True)
    smooth = find("del-piero")(problem)
    assert smooth.solved
    assert smooth.info["form"] == "normal"
    assert not smooth.friction_force.any()
    law = replace(problem.laws, cohesion=np.full(problem.pairs, 0.05))
    tresca = find("del-piero")(replace(problem, laws=law))
    assert tresca.solved
    assert np.abs(tresca.friction_force).max() == pytest.approx(0.05)
    with pytest.raises(MethodError, match="does not treat friction"):
        find("del-piero")(wall(1, 1))


@pytest.mark.parametrize("method", ["lemke", "ercolano", "lee", "sparse-lemke"])
def test_a_wall_pushed_over_is_no_equilibrium_with_a_mechanism(method: str) -> None:
    answer = find(method)(wall(3, 2, alpha=1.0))
    assert answer.status is Status.NO_EQUILIBRIUM
    assert answer.mechanism is not None
    assert answer.mechanism.power > 0


def test_a_cap_is_refused_by_the_dense_forms() -> None:
    with pytest.raises(MethodError, match="cap"):
        find("lee")(small_wall(0, "cap"))


def test_progress_can_stop_the_dense_methods() -> None:
    seen: list[str] = []

    def stop(progress: object) -> bool:
        seen.append(progress.method)  # type: ignore[attr-defined]
        return True

    answer = find("lee")(wall(2, 2), progress=stop)
    assert answer.status is Status.CANCELLED
    assert seen == ["lee"]


def test_the_motion_of_a_ray_is_that_of_its_bodies_at_any_length() -> None:
    """Of two rigid bodies of which one moves: differences of the two halves of the split problem."""
    problem = small_wall(1, alpha=0.1)
    form = mixed_form(reduce(problem), "4m")
    r, n, R = form.motions, form.size, form.reduction.system.problem.R
    alpha = np.zeros(r)
    alpha[1], alpha[4] = 3.0, -1.5
    for length in (1.0, 1e-9, 1e7):
        ray = np.concatenate([np.ones(n), length * np.maximum(alpha, 0) + 2.0, length * np.maximum(-alpha, 0) + 2.0])
        result = SimpleNamespace(ray=SimpleNamespace(dz=ray))
        velocity = DenseRun._ray_velocity(form, "split", result)  # type: ignore[arg-type]
        assert velocity is not None
        np.testing.assert_allclose(velocity, R @ (alpha / 3.0), atol=1e-6)
        assert DenseRun._ray_velocity(form, "condensation", result) is None  # type: ignore[arg-type]
    still = SimpleNamespace(ray=SimpleNamespace(dz=np.ones(n + 2 * r)))
    assert DenseRun._ray_velocity(form, "split", still) is None  # type: ignore[arg-type]
    assert DenseRun._ray_velocity(form, "split", SimpleNamespace(ray=None)) is None  # type: ignore[arg-type]
