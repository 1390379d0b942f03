"""Statics with round cones: closed forms, an independent solver, proofs from both sides, every law, turned in space."""

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg as sl
import scipy.sparse as sp

import concio
from concio.problem.cone import Cone
from concio.problem.contact_problem import Array, ContactProblem, Laws
from concio.problem.tolerances import BALANCED
from concio.solvers.algebra.second_order_cone import product, reach, times
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.cone_interior import ConeAnswer, maximise
from concio.solvers.statics.cone_programme import ConeProgramme, Pairs, Point
from concio.solvers.statics.cone_statics import ConeStatics, _motions_of_bodies, _room
from concio.solvers.statics.cone_step import Step
from concio.solvers.statics.existence import statically_admissible
from concio.solvers.statics.friction import smallest_friction
from concio.solvers.statics.mechanism import absorbed_power, pair_velocities
from concio.solvers.statics.pivoted import Mixed
from contact_problems import rigid
from contact_problems import wall as plane_wall
from samples import first
from space_problems import Built, barrel, box, build, dome, on_floor, wall

SHARP = 1e-10
"""Distance of the two proofs."""


def turn(angle: float, axis: tuple[float, float, float]) -> Array:
    """A rotation matrix."""
    n = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    rotation: Array = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return rotation


def proven(problem: ContactProblem, live: Array, multiplier: float) -> None:
    """Recompute both proofs of a limit from the original arrays, and compare."""
    found = associated_limit(problem, live)
    t_n, t_t = found.normal_force, found.friction_force
    load = problem.f + found.multiplier * live
    size = np.abs(load).sum()
    left = problem.R.T @ (load + problem.C_n.T @ t_n + problem.C_t.T @ t_t.ravel())
    assert np.abs(left).max() <= BALANCED * size
    assert problem.cone.excess(t_n, t_t).max() <= BALANCED * size
    v = found.mechanism.velocity
    w_n, speed = pair_velocities(problem, v)
    assert problem.cone.lift(w_n, speed)[~problem.cone.capped].min(initial=0.0) >= -1e-14
    upper = (absorbed_power(problem, v) - problem.f @ v) / (live @ v)
    assert found.upper == pytest.approx(upper, rel=1e-12)
    assert -1e-13 <= upper - found.multiplier <= SHARP * max(1.0, abs(upper))
    assert found.multiplier - 1e-10 * abs(multiplier) <= multiplier <= found.upper + 1e-10 * abs(multiplier)


def single_box(a: float, b: float, h: float, mu: float) -> Built:
    """One box a x b x h on the ground."""
    return build([box((0, a), (0, b), (0, h))], on_floor, mu)


@pytest.mark.parametrize("mu", [0.9, 0.3])
@pytest.mark.parametrize("degrees", [0.0, 15.0, np.degrees(np.arctan(0.5)), 45.0, 77.0, 90.0, 200.0])
def test_box_pushed_in_any_direction_of_the_plan(mu: float, degrees: float) -> None:
    a, b, h = 2.0, 1.0, 3.0
    built, angle = single_box(a, b, h, mu), np.radians(degrees)
    with np.errstate(divide="ignore"):
        slides, tips = mu, min(a / h / abs(np.cos(angle)), b / h / abs(np.sin(angle)))
    proven(built.problem, built.pushed(np.array([np.cos(angle), np.sin(angle), 0.0])), min(slides, tips))


@pytest.mark.parametrize(("degrees", "multiplier"), [(0, 1.0), (30, 1 / np.sqrt(3)), (60, 0.5), (180, 0.5)])
def test_tripod(degrees: float, multiplier: float) -> None:
    """Three feet on a circle of radius one, the weight one above them; legs at 0, 120 and 240 degrees."""
    feet = np.array([[np.cos(t), np.sin(t), -1.0] for t in np.radians([0, 120, 240])])
    C = np.zeros((9, 6))
    for k, r in enumerate(feet):
        motion = np.hstack([np.eye(3), [[0, r[2], -r[1]], [-r[2], 0, r[0]], [r[1], -r[0], 0]]])
        C[3 * k : 3 * k + 3] = motion[[2, 0, 1]]
    problem = ContactProblem(
        sp.csr_array((6, 6)), np.array([0, 0, -1.0, 0, 0, 0]), sp.csr_array(C[::3]),
        sp.csr_array(C[[1, 2, 4, 5, 7, 8]]), np.zeros(3), Laws.coulomb(2.0, 3), sp.csc_array(sp.eye_array(6)),
        np.array([0, 6]),
    )  # fmt: skip
    t = np.radians(degrees)
    proven(problem, np.array([np.cos(t), np.sin(t), 0, 0, 0, 0]), multiplier)


@pytest.mark.parametrize(
    ("built", "multiplier"),
    [
        (wall(4, 5), 0.6),  # slides as a whole
        (wall(10, 6, direction=(0.0, 1.0, 0.0)), 1 / 6),  # turns about its foot: t / H
        (wall(6, 6, direction=(1.0, 1.0, 0.0)), 1 / 6),
        (wall(4, 4, mu=0.0), 0.0),
    ],
)
def test_walls_in_closed_form(built: Built, multiplier: float) -> None:
    if multiplier:
        proven(built.problem, built.live, multiplier)
    else:
        assert associated_limit(built.problem, built.live).multiplier == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ["wall", "headers", "barrel", "dome"])
def test_the_same_bounds_as_clarabel(name: str) -> None:
    clarabel = pytest.importorskip("clarabel")
    built = {
        "wall": lambda: wall(6, 7, direction=(1.0, 0.3, 0.0)),
        "headers": lambda: wall(2, 4, leaves=3),
        "barrel": lambda: barrel(11, 2, direction=(1.0, 0.5, 0.0)),
        "dome": lambda: dome(4, 12, mu=0.5),
    }[name]()
    p, m = built.problem, built.problem.pairs
    A = sp.csc_matrix(sp.hstack([sp.vstack([p.C_n, p.C_t]).T, sp.csc_array(built.live[:, None])]))
    rows = [sp.csc_array(([p.laws.friction[k]], ([0], [k])), shape=(1, 3 * m + 1)) for k in range(m)]
    cones = [clarabel.ZeroConeT(A.shape[0])]
    G = []
    for k in range(m):
        tangential = sp.csc_array(([1.0, 1.0], ([0, 1], [m + 2 * k, m + 2 * k + 1])), shape=(2, 3 * m + 1))
        G += [rows[k], tangential]
        cones.append(clarabel.SecondOrderConeT(3))
    matrix = sp.csc_matrix(sp.vstack([A, -sp.vstack(G)]))
    right = np.r_[-p.f, np.zeros(3 * m)]
    cost = np.r_[np.zeros(3 * m), -1.0]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    other = clarabel.DefaultSolver(sp.csc_matrix((3 * m + 1,) * 2), cost, matrix, right, cones, settings).solve()
    proven(p, built.live, associated_limit(p, built.live).multiplier)
    assert associated_limit(p, built.live).multiplier == pytest.approx(other.x[-1], rel=2e-6)


@pytest.mark.parametrize(
    "make",
    first(3, [
        lambda: wall(5, 5),
        lambda: wall(3, 4, leaves=2),
        lambda: barrel(9, 2),
        lambda: dome(4, 10),
        lambda: dome(4, 10, elastic=True),
    ]),
)
def test_forces_or_mechanism_either_side_of_the_limit(make: Callable[[], Built]) -> None:
    built = make()
    limit = associated_limit(built.problem, built.live)
    for share in (0.5, 0.99, 1 - 1e-7):
        below = built.at(share * limit.multiplier)
        state = statically_admissible(below)
        assert state.exists
        assert state.mechanism is None
    for share in (1 + 1e-7, 1.01, 1.5):
        above = built.at(share * limit.multiplier)
        state = statically_admissible(above)
        assert not state.exists
        v = state.mechanism.velocity
        w_n, speed = pair_velocities(above, v)
        assert (w_n - 0.6 * speed).min() >= -1e-14
        assert above.f @ v > 0


def test_turning_the_structure_changes_nothing() -> None:
    straight = wall(5, 4, direction=(1.0, 0.4, 0.0))
    turned = wall(5, 4, direction=(1.0, 0.4, 0.0), turned=turn(1.1, (0.3, -0.5, 0.8)))
    wanted = associated_limit(straight.problem, straight.live).multiplier
    assert associated_limit(turned.problem, turned.live).multiplier == pytest.approx(wanted, rel=1e-10)


def test_a_wedged_wall_carries_any_load() -> None:
    wedged = wall(6, 4, sides=True)
    found = associated_limit(wedged.problem, wedged.live)
    assert np.isinf(found.multiplier)
    assert found.residual <= 1e-11
    capped = wedged.problem
    capped = replace(capped, laws=replace(capped.laws, cap=np.full(capped.pairs, 7.0)))
    found = associated_limit(capped, wedged.live)
    assert np.isfinite(found.multiplier)
    assert found.gap <= SHARP


def test_nothing_to_carry_the_load_at_any_multiplier() -> None:
    falling = wall(3, 2, sides=True, mu=0.0)
    assert np.isnan(associated_limit(falling.problem, falling.live).multiplier)


@pytest.mark.parametrize("seed", range(12))
def test_every_law_in_one_pair_against_its_support_function(seed: int) -> None:
    """A free point held by one pair: the largest multiplier is where the ray of loads leaves the strength domain."""
    rng = np.random.default_rng(seed)
    mu = rng.uniform(0.2, 1.0) * (seed % 4 != 3)
    tension = rng.uniform(0, 0.5) * (seed % 2)
    cohesion = mu * tension + rng.uniform(0.1, 1.0) * (seed % 3 > 0 or mu == 0)
    cap = [np.inf, 3.0][seed % 2]
    laws = Laws.coulomb(mu, 1)
    laws = replace(laws, cohesion=np.array([cohesion]), tension=np.array([tension]), cap=np.array([cap]))
    problem = ContactProblem(
        sp.csr_array((3, 3)), np.array([0, 0, -1.0]), sp.csr_array([[0, 0, 1.0]]), sp.csr_array(np.eye(3)[:2]),
        np.zeros(1), laws, sp.csc_array(sp.eye_array(3)), np.array([0, 3]),
    )  # fmt: skip
    live = rng.standard_normal(3)

    def inside(factor: float) -> bool:
        t = -(problem.f + factor * live)
        return bool(problem.cone.excess(t[2:], t[None, :2])[0] <= 0)

    low, high = 0.0, 1e3
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if inside(middle) else (low, middle)
    if high == 1e3:
        assert np.isinf(associated_limit(problem, live).multiplier)
    else:
        proven(problem, live, low)


@pytest.mark.parametrize("seed", range(6))
def test_plane_and_space_agree_where_the_problem_is_plane(seed: int) -> None:
    """Plane rigid walls with an idle third direction: the linear programme and the cone programme say the same."""
    rng = np.random.default_rng(seed)
    mu = float(rng.uniform(0.3, 0.9))
    plane = rigid(plane_wall(int(rng.integers(2, 5)), int(rng.integers(2, 5)), mu=mu))
    live = np.zeros(plane.unknowns)
    live[::3] = -plane.f[1::3]
    wanted = associated_limit(plane, live)
    m = plane.pairs
    rows = np.column_stack([np.arange(m), m + np.arange(m)]).ravel()
    C_t = sp.csr_array(sp.vstack([plane.C_t, sp.csr_array((m, plane.unknowns))])[rows])
    space = replace(plane, C_t=C_t, slip_origin=np.zeros((m, 2)), bodies=plane.bodies)
    proven(space, live, wanted.multiplier)


def test_least_friction_of_a_tilted_box() -> None:
    """On a plane tilted about two axes a flat box needs mu = sqrt(tan2 a + tan2 b)."""
    built = single_box(2.0, 2.0, 0.2, 1.0)
    slope = np.array([0.3, -0.2])
    problem = built.problem.with_loads(built.problem.f + built.pushed(np.array([*slope, 0.0])))
    found = smallest_friction(problem)
    assert found.settled
    assert found.factor == pytest.approx(np.hypot(*slope), rel=1e-6)
    assert found.below < np.hypot(*slope) <= found.factor + 1e-12


def test_the_friction_of_a_tower_that_slides_is_found_without_pivoting(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tenth of the weight sideways slides on a sixth of 0.6; programmes beside it may lose their digits undecided.

    Each step of a whole system with pivoting costs as much as fifty others: on a large tower the margin took most of
    the time of a limit load.
    """
    monkeypatch.setattr(Mixed, "factors", lambda *given: pytest.fail("a whole system was factorised"))
    tower = concio.tower(width=1.2, depth=1.2, height=1.8, block="rigid", friction=0.6, horizontal=0.1)
    found = concio.friction_margin(tower, live=None)
    assert found.settled
    assert found.below < 1 / 6 <= found.factor + 1e-12
    assert found.programmes <= 8, "Newton's method begins with nearly the forces that it ends with"


@pytest.mark.parametrize("make", [lambda: barrel(7, 2), lambda: wall(3, 3), lambda: dome(3, 6)])
def test_the_least_friction_is_what_single_trials_say(make: Callable[[], Built]) -> None:
    """Newton's method beside programmes that begin with one unit on every contact, either side of its bracket."""
    loaded = make().at(0.05)
    found = smallest_friction(loaded)
    assert found.settled
    assert found.factor > 0
    assert statically_admissible(loaded.with_friction(found.factor * (1 + 1e-6))).exists
    less = statically_admissible(loaded.with_friction(found.below * (1 - 1e-6)))
    assert less.mechanism is not None


def test_all_directions_of_friction_are_alike() -> None:
    """A point on the floor: held just inside the circle, mechanism just outside, in every direction."""
    for angle, (size, holds) in itertools.product(np.linspace(0, 2 * np.pi, 7), ((1 - 1e-7, True), (1 + 1e-7, False))):
        load = np.r_[0.5 * size * np.cos(angle), 0.5 * size * np.sin(angle), -1.0]
        problem = ContactProblem(
            sp.csr_array((3, 3)), load, sp.csr_array([[0, 0, 1.0]]), sp.csr_array(np.eye(3)[:2]), np.zeros(1),
            Laws.coulomb(0.5, 1), sp.csc_array(sp.eye_array(3)), np.array([0, 3]),
        )  # fmt: skip
        state = statically_admissible(problem)
        assert state.exists is holds
        assert (state.mechanism is None) is holds


def test_forces_are_moved_into_balance() -> None:
    """Any forces inside the cones are moved until what is left of the load is rounding."""
    built = wall(3, 4, leaves=2)
    statics = ConeStatics(built.problem)
    load, t = statics.project(built.problem.f), np.zeros((built.problem.pairs, 3))
    t[:, 0] = 1.0
    first = np.abs(statics.programme.Ct @ t.ravel() + load).max()
    moved = statics.balance(t, load)
    assert np.abs(statics.programme.Ct @ moved.ravel() + load).max() < 1e-9 * first


def test_every_iterate_tells_the_residuals_of_its_point_and_the_best_is_given() -> None:
    built = wall(4, 5)
    statics = ConeStatics(built.problem)
    it, e, g = statics.programme, statics.offset(built.problem.f), statics.project(built.live)
    seen: list[ConeAnswer] = []

    def note(answer: ConeAnswer) -> bool:
        seen.append(answer)
        return False

    found = maximise(it, e, g, stop=note)
    for answer in seen:
        left = np.abs(it.Ct @ answer.t.ravel() + e + answer.multiplier * g).max()
        assert answer.primal == pytest.approx(left / max(1.0, answer.t[:, 0].max()), rel=1e-12)
    assert found.t[:, 0].max() > 2.0
    worst = [max(a.primal, a.dual, a.gap) for a in seen]
    assert max(found.primal, found.dual, found.gap) == min(worst) < 1e-12


@pytest.mark.parametrize("share", [1.0, 0.01])
def test_the_gap_told_is_that_of_the_two_bounds(share: float) -> None:
    """Of plain cones -e'v - lambda once balance and velocities are met, over lambda where that is above one."""
    built = dome(4, 10)
    statics = ConeStatics(built.problem)
    e, g = statics.offset(built.problem.f), share * statics.project(built.live)
    seen: list[ConeAnswer] = []
    maximise(statics.programme, e, g, stop=lambda answer: bool(seen.append(answer)))
    met = [a for a in seen if max(a.primal, a.dual) < 1e-3 * a.gap < 1e-5]
    assert len(met) > 3
    for answer in met:
        size = max(1.0, abs(answer.multiplier))
        assert answer.gap == pytest.approx((-e @ answer.v - answer.multiplier) / size, rel=1e-2)
    assert (met[-1].multiplier > 50) is (share < 1)


@pytest.mark.parametrize(
    ("mu", "cohesion", "cap"),
    [(0.6, 0.0, np.inf), (0.6, 0.3, np.inf), (0.4, 0.3, 4.0), (0.0, 0.7, np.inf), (0.0, 0.7, 4.0)],
)
def test_a_share_of_their_room_never_takes_forces_out_of_the_cones(mu: float, cohesion: float, cap: float) -> None:
    """1/sqrt(2) of it in any direction; of a plain cone no more."""
    rng, m = np.random.default_rng(5), 20
    cone = Cone(*(np.full(m, v) for v in (mu, cohesion, 0.0, cap)))
    it = ConeProgramme(Pairs(sp.csr_array(np.tile(np.eye(3), (m, 1))), cone, np.array([0, 3])))
    t_n, angle = rng.uniform(0.5, 3.0, m), rng.uniform(0, 2 * np.pi, m)
    size = rng.uniform(0, 0.95, m) * (cohesion + mu * t_n)
    t = np.column_stack([t_n, size * np.cos(angle), size * np.sin(angle)])
    step = rng.normal(size=(2000, 1, 3))
    moved = (np.linalg.cholesky(_room(it, t)) @ (step / np.linalg.norm(step, axis=2)[..., None])[..., None])[..., 0]

    def outside(share: float) -> Array:
        """The largest way outside of each pair (m,)."""
        return np.max([cone.excess(x[:, 0], x[:, 1:]) for x in t + share * moved], axis=0)

    assert (outside(0.7) <= 0).all()
    if cohesion == 0:
        assert (outside(0.75) > 0).all()


LAWS = {
    "coulomb": (0.6, 0.0, np.inf),
    "coulomb, capped": (0.5, 0.0, 4.0),
    "cohesive": (0.6, 0.3, np.inf),
    "cohesive, capped": (0.4, 0.3, 4.0),
    "tresca": (0.0, 0.7, np.inf),
    "tresca, capped": (0.0, 0.7, 4.0),
    "smooth": (0.0, 0.0, np.inf),
    "smooth, capped": (0.0, 0.0, 4.0),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("dim", [2, 3])
def test_the_room_of_forces_is_the_inverse_hessian_of_logarithms(law: str, dim: int) -> None:
    """Of minus log of what is left to each bound, half of it for the square of a cone, by finite differences."""
    mu, cohesion, cap = LAWS[law]
    cone = Cone(*(np.array([v]) for v in (mu, cohesion, 0.0, cap)))
    it = ConeProgramme(Pairs(sp.csr_array(np.eye(dim)), cone, np.array([0, dim])))
    t = np.array([1.3, 0.35, -0.2])[:dim]

    def barrier(x: Array) -> float:
        value = -0.5 * np.log((cohesion + mu * x[0]) ** 2 - (x[1:] ** 2).sum()) if mu or cohesion else 0.0
        value -= np.log(x[0]) if cohesion or not mu else 0.0  # the cone keeps it positive by itself
        return float(value - (np.log(cap - x[0]) if np.isfinite(cap) else 0.0))

    free = dim if mu or cohesion else 1  # without friction nothing holds sideways
    step = 1e-3 * np.eye(dim)[:free]
    hessian = [
        [(barrier(t + a + b) - barrier(t + a - b) - barrier(t - a + b) + barrier(t - a - b)) / 4e-6 for a in step]
        for b in step
    ]
    room = np.zeros((dim, dim))
    room[:free, :free] = np.linalg.inv(hessian)
    assert _room(it, t[None])[0] == pytest.approx(room, rel=1e-3, abs=1e-4 * float(np.abs(room).max()))


def test_motions_are_those_of_one_body_after_another() -> None:
    problem = wall(3, 2).problem
    r = problem.rigid_motions
    assert _motions_of_bodies(problem).tolist() == list(range(0, r + 1, 6))
    mixed = replace(problem, R=sp.csc_array(problem.R[:, ::-1]))
    assert _motions_of_bodies(mixed).tolist() == list(range(r + 1))


def every_law(seed: int) -> tuple[ConeProgramme, Point, Array, tuple[Array, Array, float]]:
    """Pairs of every law on two bodies, a point inside all cones, a load, and what is left of the equations there."""
    rng = np.random.default_rng(seed)
    mu, cohesion, cap = np.array([
        (0.6, 0.0, np.inf), (0.4, 0.3, np.inf), (0.7, 0.2, 5.0), (0.5, 0.0, 9.0), (0.0, 0.8, np.inf), (0.0, 0.5, 6.0),
        (0.0, 0.0, np.inf), (0.0, 0.0, 7.0),
    ]).repeat(2, axis=0).T  # fmt: skip
    m = len(mu)
    C = sp.csr_array(rng.normal(size=(3 * m, 12)))
    it = ConeProgramme(Pairs(C, Cone(mu, cohesion, 0.0 * mu, cap), np.array([0, 6, 12])))
    t = np.column_stack([rng.uniform(0.5, 4.0, m), np.zeros((m, 2))])
    angle, share = rng.uniform(0, 2 * np.pi, m), rng.uniform(0.1, 0.9, m)
    size = share * it.cone.linear_strength(t[:, 0])
    t[:, 1:] = np.where(it.rough, size, 0.0)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    eta = np.column_stack([np.full(m, 2.0), rng.uniform(-1.2, 1.2, (m, 2))])
    eta[~it.rough] = 0.0
    eta[~it.rough, 0] = 1.0
    p = Point(t, 0.3, rng.normal(size=12), rng.uniform(0.5, 2.0, m), eta, rng.uniform(0.5, 2.0, m))
    g, rest = rng.normal(size=12), it.rate(rng.normal(size=12))
    rest[~it.rough, 1:] = 0.0
    return it, p, g, (rng.normal(size=12), rest, 0.7)


@pytest.mark.parametrize("degenerate", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_a_direction_solves_newtons_equations_of_every_law(seed: int, degenerate: bool) -> None:
    """Balance, velocities, the given power and the three kinds of products, each linearised as it stands."""
    it, p, g, (r_p, r_d, r_g) = every_law(seed)
    it.degenerate = degenerate
    step = Step.at(it, p, g, r_p, r_d, r_g)
    assert step is not None
    rng = np.random.default_rng(seed + 9)
    rc_z, rc_t, rc_w = rng.normal(size=p.z.shape), rng.normal(size=p.t.shape), rng.normal(size=p.w.shape)
    d = step.direction(rc_z, rc_t, rc_w)
    assert d is not None
    rounding = 1e-11 * max(np.abs(d.t).max(), np.abs(d.v).max(), 1.0)
    assert it.Ct @ d.t.ravel() + g * d.multiplier == pytest.approx(-r_p, abs=rounding)
    assert g @ d.v == pytest.approx(r_g, abs=rounding)
    left = it.rate(d.v) + r_d - it.pressed(d.z, d.eta, d.w)
    assert np.abs(left[it.rough]).max() <= rounding
    assert np.abs(left[~it.rough, 0]).max() <= rounding
    line, capped, rough = it.line, it.capped, it.rough
    assert (p.z * d.t[:, 0] + p.t[:, 0] * d.z)[line] == pytest.approx(rc_z[line], abs=rounding)
    assert ((it.cap - p.t[:, 0]) * d.w - p.w * d.t[:, 0])[capped] == pytest.approx(rc_w[capped], abs=rounding)
    turned = times(step.scaling.W, d.eta) + times(step.scaling.inverse, step.of_strength(d.t))
    assert np.abs(product(step.scaling.point, turned) - rc_t)[rough].max() <= 10 * rounding
    assert not d.z[~line].any()
    assert not d.w[~capped].any()


@pytest.mark.parametrize("seed", range(20))
def test_the_longest_step_ends_on_the_first_wall_it_meets(seed: int) -> None:
    it, p, g, rest = every_law(seed)
    step = Step.at(it, p, g, *rest)
    assert step is not None
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-1.5, 1.0)
    d = Point(*(size * rng.normal(size=np.shape(v)) for v in (p.t, p.multiplier, p.v, p.z, p.eta, p.w)))
    d.eta[~it.rough] = 0.0

    def room(q: Point) -> tuple[float, float]:
        """How far forces and multipliers are inside their cones."""
        t, eta = it.strength(q.t)[it.rough], q.eta[it.rough]
        forces = [q.t[it.line, 0], (it.cap - q.t[:, 0])[it.capped], t[:, 0] - np.hypot(*t[:, 1:].T)]
        others = [q.z[it.line], q.w[it.capped], eta[:, 0] - np.hypot(*eta[:, 1:].T)]
        return float(np.concatenate(forces).min()), float(np.concatenate(others).min())

    assert min(room(p)) > 0
    longest = step.longest(d)
    for k in range(2):
        assert 0 < longest[k] <= 1
        assert room(p.moved(d, *((1 - 1e-9) * np.array(longest))))[k] > 0
        if longest[k] < 1:
            assert room(p.moved(d, *((1 + 1e-9) * np.array(longest))))[k] < 0


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_way_to_the_edge_of_a_cone_keeps_its_digits_next_to_it(sense: float) -> None:
    """Of the two roots of the quadratic equation the small one is not a difference of large ones."""
    x = np.array([[1.0, sense * (1.0 - 2.0**-40)]])
    dx = np.array([[-0.25, sense * 0.25]])
    assert reach(x, dx) == pytest.approx(2.0**-39, rel=1e-9)
    assert reach(x, -dx + np.array([[-1.0, 0.0]])) == pytest.approx(2.0**-40 / 0.5, rel=1e-9)
    assert reach(x, np.array([[0.5, sense * 0.25]])) == np.inf


def test_the_equations_as_a_whole_are_solved_with_pivoting() -> None:
    """Roots of many sizes, some of them nothing, some pairs that feel one block: against the dense equations."""
    rng = np.random.default_rng(3)
    m, r = 12, 24
    C = sp.csr_array(np.kron(rng.random((m, 4)) < 0.6, np.ones((3, 6))) * rng.standard_normal((3 * m, r)))
    g, right = rng.standard_normal(r), rng.standard_normal(3 * m + r + 1)
    mixed = Mixed(C, m)
    for _ in range(3):  # one order, other roots
        F = rng.standard_normal((m, 3, 3)) * (10.0 ** rng.integers(-4, 4, m) * (rng.random(m) < 0.9))[:, None, None]
        FC = sl.block_diag(*F).T @ C.toarray()
        dense = np.zeros((right.size, right.size))
        dense[: 3 * m, : 3 * m], dense[3 * m : -1, 3 * m : -1] = np.eye(3 * m), -1e-9 * np.eye(r)
        dense[: 3 * m, 3 * m : -1], dense[3 * m : -1, : 3 * m] = FC, FC.T
        dense[3 * m : -1, -1] = dense[-1, 3 * m : -1] = g
        x = mixed.factors(F, g, 1e-9).solve(right)
        assert dense @ x == pytest.approx(right, abs=1e-12 * np.abs(dense).max() * np.abs(x).max())


def test_what_was_ordered_for_other_pairs_is_not_taken() -> None:
    """Programmes share what only the velocities of their pairs decide: others have an order of their own."""
    C = sp.csr_array(np.tile(np.eye(3), (2, 1)))
    cone, bodies = Cone(*(x * np.ones(2) for x in (0.5, 0.0, 0.0, np.inf))), np.array([0, 3])
    one = ConeProgramme(Pairs(C, cone, bodies))
    stronger = ConeProgramme(Pairs(C.copy(), replace(cone, friction=0.9 * np.ones(2)), bodies))
    assert stronger.ordered is one.ordered
    assert stronger.factor is not one.factor
    assert ConeProgramme(Pairs(sp.csr_array(2.0 * C), cone, bodies)).ordered is not one.ordered
    assert ConeProgramme(Pairs(C, cone, np.arange(4))).ordered is not one.ordered
