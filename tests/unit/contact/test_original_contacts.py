"""Certificates of pushes and motions rest on contact pairs written down once more: faults of the solve show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.analysis.motion.dynamics_result import Ending
from concio.analysis.motion.push_result import PushEnding
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Statics
from concio.analysis.motion.step_pairs import PairMaker
from concio.analysis.motion.stepper import Stepper
from concio.contact import edge_search as search_module
from concio.contact.attachments import Held, Ties
from concio.contact.laws import LawTable
from concio.contact.original import OriginalContacts
from concio.contact.reference import Reference
from concio.contact.rows import RowMaker
from concio.errors import NoEquilibriumError
from concio.kinematics.placement import Placement
from concio.problem.tolerances import CERTIFIED
from models import box, model_of, weight
from motion_models import G, standing
from samples import first, sample

LAWS = (
    0.6,
    concio.JointLaw(0.5, normal_stiffness=1e6, tangential_stiffness=5e5),
    concio.JointLaw(0.5, compressive_strength=1e3, cohesion=10.0, tensile_strength=5.0),
)


def wall(kind, law):
    bodies = [box("floor", -3.0, 6.0, -0.5, 0.0, kind="fixed")]
    options = {"material": "stone"} if kind == "rigid" else {}
    for row in range(3):
        left = 0.25 * (row % 2)
        bodies += [
            box(f"b{row}{k}", left + 0.5 * k, left + 0.5 * (k + 1), 0.25 * row, 0.25 * (row + 1), kind=kind, **options)
            for k in range(3)
        ]
    return model_of(*bodies, law=law, loads=(weight(),))


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
@pytest.mark.parametrize("law", range(len(LAWS)))
@pytest.mark.parametrize("seed", range(sample(1, 4, 8)))
def test_pairs_written_twice_are_the_same(kind, law, seed):
    """Rows, gaps, areas and what turning adds, of bodies that have moved at random; laws and openings too."""
    rng = np.random.default_rng(seed)
    reference = Reference.of(wall(kind, LAWS[law]))
    maker, state = PairMaker(reference, Scheme()), MotionState.at_rest(reference)
    count = len(state.rotation)
    free = (np.arange(count) > 0)[:, None]
    centre = state.centre + 1e-3 * free * rng.normal(size=(count, 2))
    rotation, spin = (free[:, 0] * size * rng.normal(size=count) for size in (3e-3, 1.0))
    velocity, strain = rng.normal(size=(count, 2)), 1e-4 * rng.normal(size=state.strain.shape)
    _, rows, _ = maker.contacts(state.memory, Placement(centre, rotation), velocity, spin, strain)
    original = OriginalContacts(reference)
    layout = maker.search.layout
    slots, again = original.at(layout, centre, rotation, velocity, spin, strain)
    assert original.named(layout).sound
    assert (again.columns == rows.columns).all()
    inside = (rows.columns < reference.disc.unknowns)[:, None, :]
    assert inside.any()
    assert again.values * inside == pytest.approx(rows.values * inside, abs=1e-12)
    for name in ("gap", "imposed", "turning", "valid", "area", "point", "normal"):
        wanted = np.asarray(getattr(rows, name), float)
        assert np.asarray(getattr(again, name), float) == pytest.approx(wanted, abs=1e-12), name
    for name in ("law", "opening", "share", "fraction", "thickness", "bonded", "body_a", "body_b"):
        assert getattr(slots, name) == pytest.approx(getattr(maker.slots, name), abs=1e-15), name


def sign_of_the_slip(rows, _):
    values = rows.values.copy()
    values[:, 1] *= -1.0
    return replace(rows, values=values)


def sign_of_an_arm(rows, _):
    values = rows.values.copy()
    values[:, 0, 5] *= -1.0
    values[:, 0, 6:] *= -1.0
    return replace(rows, values=values)


def gaps_too_large(rows, _):
    return replace(rows, gap=rows.gap + 1e-4)


def stale(rows, first):
    return first


FAULTS = (sign_of_the_slip, sign_of_an_arm, gaps_too_large, stale)


def faulty(monkeypatch, fault):
    """Put a fault into the rows of every solve; ``stale`` keeps those of the first look at a layout."""
    true, first = RowMaker.rows, {}

    def rows(self, *args, **options):
        found = true(self, *args, **options)
        return fault(found, first.setdefault(id(self), (self, found))[1])

    monkeypatch.setattr(RowMaker, "rows", rows)


def pushed_once(model):
    """Return a point at a multiplier, far enough to have turned or slid, and the residual of its own equations."""
    push = concio.Load("point", (1.0, 0.0), bodies=("block",), at=(-0.2, 1.2), group="live")
    model = replace(model, loads=(*model.loads, push))
    statics = Statics(Reference.of(model, G), Scheme(), {}, ("live",))
    start = statics.balance(MotionState.at_rest(statics.reference), 0.0)
    found = statics.balance(start.state, 0.4, target=0.01)
    look = statics.look(found.state, start.state.memory, np.zeros(0), found.multiplier)
    return found, statics.problem(look, found.multiplier, None)


@pytest.mark.parametrize("fault", first(3, FAULTS), ids=lambda f: f.__name__)
def test_the_certificate_of_a_push_refuses_faults_in_the_rows_of_the_solve(monkeypatch, fault):
    found, _ = pushed_once(standing(friction=0.3))
    assert found.found
    faulty(monkeypatch, fault)
    try:
        found, _ = pushed_once(standing(friction=0.3))
    except NoEquilibriumError:
        return
    assert not found.found
    assert found.residual > 1e3 * CERTIFIED


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f.__name__)
@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_the_certificate_of_a_motion_refuses_faults_in_the_rows_of_the_solve(monkeypatch, fault, kind):
    """A block that leans and slides: what the solve says of its own faulty rows is exact."""

    def last(steps=30):
        stepper = Stepper(Reference.of(standing(tilt=0.1, friction=0.05, kind=kind), G), Scheme())
        state = stepper.located(MotionState.at_rest(stepper.reference))
        drive, worst, own = Drive(np.array([1.0, 0.0]), np.zeros(2), {}), 0.0, 0.0
        inner = stepper.solver.step

        def solve(*args):
            nonlocal own
            found = inner(*args)
            own = max(own, found.residual)
            return found

        stepper.solver.step = solve
        for _ in range(steps):
            state, report = stepper.step(state, 2e-3, drive)
            worst = max(worst, report.solution.residual)
            if worst > CERTIFIED:
                break
        return worst, own

    assert last()[0] <= CERTIFIED
    faulty(monkeypatch, fault)
    worst, own = last()
    assert own <= CERTIFIED
    assert worst > 1e3 * CERTIFIED


def with_a_stop():
    """A block on a floor, half a step before a wall that it will run into."""
    floor = box("floor", -3.0, 3.0, -0.5, 0.0, kind="fixed")
    stop = box("stop", 0.52, 1.0, 0.0, 1.0, kind="fixed")
    block = box("block", 0.0, 0.5, 0.0, 0.25, kind="rigid", material="stone")
    live = concio.Load("point", (1.0, 0.0), bodies=("block",), at=(0.0, 0.05), group="live")
    return model_of(floor, stop, block, law=0.3, loads=(weight(), live))


@pytest.mark.parametrize("how", first(1, ["candidate", "row"]))
def test_a_dropped_row_is_seen_where_a_block_enters_another(monkeypatch, how):
    """The rows to the stop are lost, or not even looked for: no point behind it, and no motion through it."""
    model = with_a_stop()
    free = concio.push(model, until=0.019)
    assert free.ending is PushEnding.REACHED
    if how == "row":
        faulty(monkeypatch, lambda rows, _: replace(rows, valid=rows.valid & (np.abs(rows.normal[:, 0]) < 0.5)))
    else:
        true = search_module.find_candidates

        def fewer(edges, *args):
            found = true(edges, *args)
            away = 1
            face = (edges.body[found.edge_a] != away) & (edges.body[found.edge_b] != away)
            lone = (edges.body[found.corner] != away) & (edges.body[found.edge] != away)
            return replace(
                found, edge_a=found.edge_a[face], edge_b=found.edge_b[face], corner=found.corner[lone],
                edge=found.edge[lone],
            )  # fmt: skip

        monkeypatch.setattr(search_module, "find_candidates", fewer)
    through = concio.push(model, until=0.1)
    assert through.ending is PushEnding.NO_EQUILIBRIUM
    assert through.displacement[-1] < 0.0202
    moved = concio.dynamics(
        model, duration=0.1, start="as described", velocities={"block": (1.0, 0.0)}, factors={"live": 0.0}, gravity=G
    )
    assert moved.ending is Ending.UNSOLVED


def test_a_sign_in_the_rows_of_ties_is_refused(monkeypatch):
    rod = concio.Tie("rod", "block", (0.2, 1.0), "", (2.0, 1.0), stiffness=3000.0, yield_force=30.0)
    tied = replace(standing(), ties=(rod,))
    stepper = Stepper(Reference.of(tied, G), Scheme())
    assert len(stepper.maker.ties) == 1
    assert concio.dynamics(tied, duration=0.02, velocities={"block": (-0.1, 0.0)}, gravity=G).certified
    true = Ties.rows

    def wrong(self, *args):
        values, *others = true(self, *args)
        return -values, *others

    monkeypatch.setattr(Ties, "rows", wrong)
    moved = concio.dynamics(tied, duration=0.02, velocities={"block": (-0.1, 0.0)}, gravity=G, start="as described")
    assert moved.ending is Ending.UNSOLVED


def test_a_sign_in_the_rows_of_supports_is_refused(monkeypatch):
    """A block held at its side, in a motion and in equilibrium."""
    side = ((0.2, 0.0), (0.2, 1.2))
    model = replace(standing(), supports=(concio.Support("side", "block", edge=side, directions="x"),))
    push = concio.Load("point", (0.4, 0.0), bodies=("block",), at=(-0.2, 1.0), group="live")
    model = replace(model, loads=(*model.loads, push))

    def worst():
        stepper = Stepper(Reference.of(model, G), Scheme())
        assert len(stepper.maker.held)
        state = stepper.located(MotionState.at_rest(stepper.reference))
        moved = stepper.step(state, 2e-3, Drive(np.zeros(2), np.zeros(2), {}))[1].solution.residual
        rests = Statics(Reference.of(model, G), Scheme(), {}).balance(MotionState.at_rest(stepper.reference), 0.0)
        return moved, rests.residual

    assert max(worst()) <= CERTIFIED
    true = Held.values
    monkeypatch.setattr(Held, "values", lambda self, turn: true(self, turn) * [[[1.0], [1.0]]] * [1.0, 1.0, -1.0])
    assert min(worst()) > 1e3 * CERTIFIED


def test_the_strength_of_a_joint_is_read_from_the_model_again(monkeypatch):
    """Twice the friction in the table that the solve uses: a leaning push that would slide is refused."""
    model = with_a_stop()
    wanted = concio.push(model, until=0.01).peak
    reference = Reference.of(model, G)
    table = LawTable.of(model)
    table = replace(table, friction=2 * table.friction)
    reference.__dict__["laws"] = table
    statics = Statics(reference, Scheme(), {}, ("live",))
    start = statics.balance(MotionState.at_rest(reference), 0.0)
    found = statics.balance(start.state, wanted, target=0.005)
    assert not found.found
    assert found.residual > 1e3 * CERTIFIED
