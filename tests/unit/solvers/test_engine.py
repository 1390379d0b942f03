"""The engine on whole models: benchmark walls rigid and stiff, the rigid limit, loose blocks, verdicts, cancelling."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.model.materials import Elastic, Rigid
from concio.model.model import Load
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Status
from concio.solvers.algebra.scaled import scale
from concio.solvers.auto.friction_neighbours import from_neighbours
from concio.solvers.interior.interior_point import InteriorPoint
from concio.solvers.interior.newton import NewtonStep
from concio.solvers.interior.point import Residuals
from concio.solvers.interior.run import Cancelled, Run, Start
from concio.solvers.methods import find
from concio.solvers.states.settle import Settler
from concio.solvers.statics.existence import find_mechanism
from contact_problems import wall as plain_wall
from models import box, model_of, on_ground, weight
from rigid_walls import BLOCK, FERRIS_TIN_LOI, MU
from samples import first

STONE = {"kind": "rigid", "material": "stone"}


@pytest.mark.parametrize(("name", "interfaces"), [("wall 1", 83), ("wall 2", 141), ("wall 3", 102)])
@pytest.mark.parametrize("material", [Rigid(10.0), Elastic(1e8, 0.2, 10.0)], ids=["rigid", "stiff"])
def test_ferris_and_tin_loi_walls_stand(name, interfaces, material):
    """Gravity alone; walls of Ferris and Tin-Loi (2001), Int. J. Mech. Sci. 43."""
    model = concio.wall_of_courses(
        courses=FERRIS_TIN_LOI[name], block_size=BLOCK, block=material, friction=MU, mesh_size=0.2
    )
    result = concio.solve(model)
    assert len(result.assembly.detection.interfaces) == interfaces
    assert result.certificate.worst <= 1e-9
    own = sum(b.area for b in model.free_bodies) * 10.0
    assert result.reactions["ground"] == pytest.approx((0.0, own), abs=1e-8 * own)
    # each course carries what is above it
    total = np.zeros(20)
    height = BLOCK[1]
    for y, N, n in zip(result.joints.middle[:, 1], result.joints.N, result.joints.normal, strict=True):
        if abs(n[1]) > 0.5:
            total[round(y / height)] += abs(N)
    for level in range(len(FERRIS_TIN_LOI[name])):
        above = sum(10.0 * b.area for b in model.free_bodies if b.outline[:, 1].min() > level * height - 1e-9)
        assert total[level] == pytest.approx(above, rel=2e-2 if name == "wall 3" else 1e-6)


def determinate(block, kind):
    """Three blocks in a leaning stack under weight and a push: all joint resultants follow from statics."""
    bodies = [
        replace(box(f"b{k}", 0.05 * k, 1 + 0.05 * k, 0.4 * k, 0.4 * (k + 1), mesh_size=0.2), material="m", kind=kind)
        for k in range(3)
    ]
    push = Load("point", (2.0, 0.0), bodies=("b2",), at=(0.1, 1.2), group="push")
    return on_ground(*bodies, materials={"m": block}, loads=(weight(), push), law=0.7)


def test_rigid_limit_of_a_determinate_stack():
    rigid = concio.solve(determinate(Rigid(20.0), "rigid"))
    slope = []
    for E in (1e4, 1e6, 1e8):
        elastic = concio.solve(determinate(Elastic(E, 0.2, 20.0), "elastic"))
        np.testing.assert_allclose(elastic.joints.N, rigid.joints.N, rtol=1e-8)
        np.testing.assert_allclose(elastic.joints.V, rigid.joints.V, atol=1e-8)
        np.testing.assert_allclose(elastic.joints.eccentricity, rigid.joints.eccentricity, atol=1e-8)
        slope.append(np.abs(elastic.displacement).max())
    np.testing.assert_allclose(np.array(slope[:-1]) / slope[1:], 100.0, rtol=1e-6)  # to no displacement at all
    assert np.abs(rigid.displacement).max() < 1e-9


def test_rigid_limit_of_imposed_settlement():
    """A beam on two blocks of which one sinks: reactions and rotation approach the rigid answer."""

    def model(block, kind):
        bodies = [
            box("left", -2, -1, 0, 1, material="m", kind=kind, mesh_size=0.5),
            box("right", 1, 2, 0, 1, material="m", kind=kind, mesh_size=0.5),
            box("beam", -2, 2, 1, 1.5, material="m", kind=kind, mesh_size=0.5),
            box("soil", 1, 2, -1, 0, kind="fixed"), box("rock", -2, -1, -1, 0, kind="fixed"),
        ]  # fmt: skip
        sink = concio.Support("sink", "soil", displacement=(0.0, -0.01))
        return model_of(*bodies, materials={"m": block}, loads=(weight(),), supports=(sink,), law=0.5)

    rigid = concio.solve(model(Rigid(20.0), "rigid"))
    # the beam touches at x = -1 and x = 2, its weight 40 acts at x = 0: 80/3 and 40/3, and 20 of each block
    assert rigid.reactions["rock"][1] == pytest.approx(20 + 80 / 3)
    errors = []
    for E in (1e5, 1e6, 1e7):
        elastic = concio.solve(model(Elastic(E, 0.2, 20.0), "elastic"))
        # vertical reactions are unique; the thrust between the blocks is not where nothing deforms
        reaction = [elastic.reactions[name][1] - rigid.reactions[name][1] for name in ("rock", "soil")]
        sunk = elastic.node_displacement("beam")[:, 1].min() - rigid.node_displacement("beam")[:, 1].min()
        errors.append(np.abs([*reaction, sunk]))
    assert errors[-1][:2].max() < 1e-6
    assert errors[-1][2] < 2e-5
    assert errors[0][2] > 5e-4


def test_a_loose_block_nothing_presses_on_does_no_harm():
    """A weightless block lying in a niche: it carries nothing and moves nowhere far."""
    model = on_ground(
        box("a", -1, 0, 0, 1, mesh_size=0.5), box("b", 0, 1, 0, 0.5, mesh_size=0.5, material="feather"),
        box("c", 1, 2, 0, 1, mesh_size=0.5), loads=(weight(),),
        materials={"feather": Elastic(1e4, 0.2)},
    )  # fmt: skip
    result = concio.solve(model)
    assert result.reactions["ground"] == pytest.approx((0.0, 40.0))
    assert np.abs(result.displacement).max() < 1.0


@pytest.mark.parametrize(("share", "stands"), [(0.39, True), (0.41, False)])
@pytest.mark.parametrize("kind", ["elastic", "rigid"])
def test_verdicts_on_a_sliding_wall(share, stands, kind):
    """A low wall slides on its base at tan = mu = 0.4, whatever else it does."""
    block = Elastic(1e6, 0.2, 20.0) if kind == "elastic" else Rigid(20.0)
    model = concio.wall(length=2.0, height=0.25, block=block, friction=0.4, horizontal=share)
    result = concio.solve(model, on_failure="return")
    assert result.status is (Status.SOLVED if stands else Status.NO_EQUILIBRIUM)
    assert (find_mechanism(result.assembly.problem()) is None) is stands


def test_same_problem_same_answer_to_the_last_bit():
    problem = plain_wall(3, 3, mu=0.6, alpha=0.2)
    first, second = find("auto")(problem), find("auto")(problem)
    assert np.array_equal(first.displacement, second.displacement)
    assert np.array_equal(first.normal_force, second.normal_force)
    assert first.trace == second.trace


def test_progress_is_told_and_can_cancel():
    seen = []
    model = concio.running_bond_panel(top_pressure=10.0)
    concio.solve(model, progress=lambda p: seen.append((p.iteration, p.residual)) and None)
    assert len(seen) > 3
    assert [n for n, _ in seen] == sorted(n for n, _ in seen)
    calls = []

    def stop(_):
        calls.append(1)
        return len(calls) >= 3

    result = concio.solve(model, progress=stop, on_failure="return")
    assert result.status is Status.CANCELLED
    assert len(calls) == 3


@pytest.mark.long
def test_jammed_panel_without_base():
    """Hung between walls by friction: 3 x 6 stands at mu = 1; without friction it falls.

    Between, forces within the cones exist for any mu > 0 (an arch as flat as friction wants, pressed by the rigid
    walls): whether Coulomb friction builds up that thrust or not, collapse can never be proved.
    """
    panel = {"courses": 3, "blocks": 6, "base": "none", "top_pressure": 10.0}
    assert concio.solve(concio.running_bond_panel(friction=1.0, **panel)).solved
    smooth = concio.solve(concio.running_bond_panel(friction=0.0, **panel), on_failure="return")
    assert smooth.status is Status.NO_EQUILIBRIUM
    low = concio.solve(concio.running_bond_panel(friction=0.2, **panel), on_failure="return")
    assert low.status is not Status.NO_EQUILIBRIUM
    assert find_mechanism(low.assembly.problem()) is None


def _arch(friction: float, courses: int = 3, blocks: int = 6) -> ContactProblem:
    panel = concio.running_bond_panel(
        courses=courses, blocks=blocks, joint=0.02, friction=friction, base="none", top_pressure=10.0
    )
    return concio.assemble(panel).problem()


@pytest.mark.parametrize("begin", ["rest", "the other way", "far off"])
def test_exact_finish_forgets_where_it_began(begin):
    """An arch is hardly stiffer than the springs that hold weightless pieces: they must not pull in the end."""
    run = Run(scale(_arch(1.0)))
    found = run.from_start(Start(10.0, 10.0))
    start = {"rest": 0.0 * found.u, "the other way": -3.0 * found.u, "far off": found.u + 1e4}[begin]
    again = Settler(run.scaled).settle(run.scaled, start, found.t, found.states)
    assert again.error <= 1e-11
    assert again.u == pytest.approx(found.u, abs=1e-8 * np.abs(found.u).max())


@pytest.mark.parametrize(("friction", "courses", "blocks"), first(1, [(0.9, 3, 6), (1.0, 5, 10)]))
def test_neighbours_in_friction_lead_to_the_same_state(friction, courses, blocks):
    problem = _arch(friction, courses, blocks)
    plain = Run(scale(problem))
    straight = plain.solution(plain.from_start(Start(10.0, 10.0)))
    carried = from_neighbours(Run(scale(problem)))
    assert carried.solved
    assert carried.certificate.worst <= 1e-10
    assert carried.displacement == pytest.approx(straight.displacement, abs=1e-8 * np.abs(straight.displacement).max())


@pytest.mark.parametrize("friction", [0.9, 1.0])
def test_of_several_answers_a_symmetric_panel_gets_the_symmetric_one(friction):
    """Deciding pairs before the iteration is near leads to answers that lean by half a thousandth, certified too."""
    solution = find("interior-point")(_arch(friction))
    across = solution.displacement.reshape(-1, 2)[:, 0]
    assert solution.solved
    assert abs(across.sum()) <= 1e-10 * np.abs(across).sum()


@pytest.mark.long
def test_the_way_from_a_neighbour_can_be_cancelled():
    seen = []

    def stop(report):
        seen.append(report.method)
        return report.method == "sparse-lemke"

    with pytest.raises(Cancelled):
        from_neighbours(Run(scale(_arch(1.0, 8, 12))), stop)
    assert seen[-1] == "sparse-lemke"


def test_neighbours_in_friction_of_a_smooth_structure_are_not_tried():
    assert from_neighbours(Run(scale(_arch(0.0)))) is None


def test_blocks_ten_million_times_stiffer_than_their_joints():
    """Rounding of displacements must hide neither that the answer is found nor what it is: forces tend to a limit."""

    def settled(E):
        model = concio.running_bond_panel(
            courses=4, blocks=4, block=Elastic(E=E, nu=0.2, unit_weight=20.0), friction=0.6, side_walls=False,
            horizontal=0.2,
        )  # fmt: skip
        joints = {k: replace(j, normal_stiffness=1e5, tangential_stiffness=1e5) for k, j in model.laws.items()}
        result = concio.solve(replace(model, laws=joints), method="interior-point")
        assert result.certificate.worst <= 1e-9
        return result.joints.N

    soft, stiff, stiffer = settled(1e7), settled(1e9), settled(1e11)
    size = np.abs(stiff).max()
    assert np.abs(soft - stiff).max() <= 1e-2 * size
    assert np.abs(stiffer - stiff).max() <= 1.1e-2 * np.abs(soft - stiff).max() + 1e-8 * size


def test_a_full_step_of_newton_satisfies_all_linear_equations():
    """Whatever the products are asked to become: equilibrium, gaps, slips, strengths and caps are linear."""
    problem = plain_wall(2, 2, alpha=0.2, mu=0.5)
    m = problem.pairs
    laws = replace(
        problem.laws, dilatancy=np.full(m, 0.3), cohesion=np.full(m, 0.2), cap=np.full(m, 9.0),
        normal_compliance=np.full(m, 1e-3), tangential_compliance=np.full(m, 2e-3),
    )  # fmt: skip
    iteration = InteriorPoint(scale(replace(problem, laws=laws)))
    z = iteration.start()
    s, dilatancy = iteration.problem, iteration.dilatancy(0.0)
    spread = np.random.default_rng(3).uniform(0.5, 1.2, (4, m))
    z = replace(z, t=z.t * spread[0][:, None], y_n=z.y_n * spread[1], eta=z.eta * spread[2][:, None], p=z.p * spread[3])
    rest = Residuals.of(s, z, dilatancy)
    assert rest.worst > 0.1
    newton = NewtonStep.at(s, z, rest, dilatancy)
    assert newton is not None
    step = newton.direction(newton.products.scaled(-1.0))
    assert step is not None
    assert Residuals.of(s, z.moved(step, 1.0), dilatancy).worst < 1e-6
    # and the products change as asked, to first order: by minus what they are
    np.testing.assert_allclose(z.t[:, 0] * step.y_n + z.y_n * step.t[:, 0], -z.t[:, 0] * z.y_n, rtol=1e-9)
    for side in (0, 1):
        b, e, db, de = (x[:, side] for x in (rest.beta, z.eta, step.beta, step.eta))
        np.testing.assert_allclose(b * de + e * db, -b * e, rtol=1e-9)
