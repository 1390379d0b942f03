"""Corners and edges on which bodies touch without a common face have marks, in the plane and in space."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import concio
from concio.plot.forces import plot_pressure
from concio.plot.space_figures import plot_space
from concio.post.joint_faces import joint_faces
from concio.post.joint_lines import MARK, _displacement, joint_lines
from concio.post.mechanism_states import mechanism_states
from concio.post.outlines import outlines
from concio.problem.pair_state import PairState
from concio.problem.solution import Status
from concio.report.space_data import space_view_data
from concio.report.view_data import view_data
from models import model_of, weight


def beam(live=0.0):
    """A beam on two knife edges, its ends beside a pier that it touches nowhere else."""
    knives = [concio.Body(f"k{x}", [(x - 0.2, 0.5), (x + 0.2, 0.5), (x, 1.0)], kind="fixed") for x in (1, 4)]
    body = concio.Body("beam", [(0, 1), (4.5, 1), (4.5, 1.3), (0, 1.3)], kind="rigid", material="stone")
    loads = (weight(), concio.Load("weight", (live, 0.0), group="live")) if live else (weight(),)
    return concio.solve(model_of(*knives, body, law=0.6, loads=loads), on_failure="return")


def slab():
    """A slab on three spikes."""
    sides = [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    spikes = []
    for k, (x, y) in enumerate(((0.5, 0.5), (1.5, 0.5), (1.0, 1.5))):
        foot = [(x + i, y + j, 0.0) for i, j in ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1))]
        spikes.append(concio.Polyhedron(f"p{k}", [*foot, (x, y, 1.0)], sides, kind="fixed"))
    top = concio.Polyhedron.box("slab", (0, 0, 1), (2, 2, 1.2), kind="rigid")
    return concio.solve(concio.Model(
        (*spikes, top), {"block": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.6)},
        loads=(concio.Load("weight", (0, 0, -1)),),
    ))  # fmt: skip


def test_knife_edges_have_a_mark_at_their_points():
    result = beam()
    marks = joint_lines(result, outlines(result))
    assert sorted(marks.ends.mean(axis=1)[:, 0].tolist()) == pytest.approx([1.0, 4.0])
    assert marks.ends[..., 1] == pytest.approx(np.ones((2, 2)))
    sizes = [MARK * contact.scale for contact in result.assembly.detection.point_contacts]
    assert np.ptp(marks.ends[..., 0], axis=1) == pytest.approx(sizes, rel=1e-12)


@pytest.mark.parametrize("speed", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("lost", [Status.COLLAPSES, Status.NO_EQUILIBRIUM])
def test_states_of_a_mechanism_do_not_depend_on_its_speed(speed, lost):
    """A joint slides where it opens by no more than the friction (of a collapse: the dilatancy) times its slip."""
    z, tiny = np.array([0.0, 0.0, 1.0]), 1e-8
    moves = [(0, 0, 0), (0.3, 0.4, 0), (0.3, 0.4, 0.2), (0.3, 0.4, 0.26)]
    moves += [(0, 0, tiny), (0, 0, 0.1), (tiny, 0, 0), (0, 0, -1)]
    moved_b = speed * np.repeat(np.array(moves, dtype=float)[:, None], 3, axis=1)
    faces = SimpleNamespace(moved_a=0.0 * moved_b, moved_b=moved_b, pair=np.arange(8)[::-1])
    laws = SimpleNamespace(friction=np.full(8, 0.5), dilatancy=np.full(8, 0.3))
    assembly = SimpleNamespace(pairs=SimpleNamespace(normal=np.tile(z, (8, 1))), laws=laws)
    found = mechanism_states(SimpleNamespace(assembly=assembly, status=lost), faces)
    between = PairState.OPEN if lost is Status.COLLAPSES else PairState.SLIP
    assert found.tolist() == [
        PairState.STICK, PairState.SLIP, between, PairState.OPEN, PairState.STICK, PairState.OPEN, PairState.STICK,
        PairState.STICK,
    ]  # fmt: skip


def test_marks_move_with_the_bodies_that_touch():
    """Beyond its friction the beam slides over the knives: its side of each mark moves, theirs stays."""
    result = beam(live=0.7)
    assert not result.solved
    shown = outlines(result, result.mechanism_velocity)
    marks = joint_lines(result, shown)
    sides = np.stack([np.abs(marks.moved_a).max(axis=(1, 2)), np.abs(marks.moved_b).max(axis=(1, 2))])
    assert sides.min(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert (sides.max(axis=0) > 0).all()


def test_spikes_have_octahedra_around_their_points():
    result = slab()
    faces = joint_faces(result)
    assert len(faces.corners) == 3 * 8
    for pair in range(3):
        own = faces.corners[faces.pair == pair].reshape(-1, 3)
        assert own.mean(axis=0) == pytest.approx(result.assembly.pairs.point[pair])
    corner = faces.corners[:8] - faces.corners[:8].reshape(-1, 3).mean(axis=0)
    out = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert ((out * corner.mean(axis=1)).sum(axis=1) > 0).all()


@pytest.mark.long
def test_pages_and_figures_take_them():
    flat, solid = beam(), slab()
    assert len(view_data([flat], [""])["steps"]) == 1
    assert len(space_view_data([solid], [""])["steps"]) == 1
    assert np.isfinite(plot_pressure(flat).get_ylim()).all()
    assert plot_space(solid).images


@pytest.mark.parametrize("scale", [0.25, 1.0, 16.0])
def test_the_place_nearest_to_a_point_lies_on_a_ring_and_not_between_two(scale):
    """A frame turned by a small angle: places of its outline and of its hole move by the angle times their arms."""
    ring = scale * np.array([(0, 0), (4, 0), (4, 3), (0, 3)])
    hole = scale * np.array([(0.5, 0.5), (2.5, 0.5), (2.5, 2), (0.5, 2)])
    frame = concio.Body("frame", ring, kind="rigid", material="stone", holes=(hole,))
    base = concio.Body("base", scale * np.array([(-1, -1), (5, -1), (5, 0), (-1, 0)]), kind="fixed")
    result = concio.solve(model_of(base, frame, loads=(weight(),)))
    turn = 1e-3
    motion = np.zeros(result.assembly.disc.unknowns)
    motion[-1] = turn * result.assembly.disc.reach[1]
    shown = outlines(result, motion)
    centre = frame.centroid
    for near, on in (
        ((1.0, -0.1), (1.0, 0.0)), ((4.2, 1.0), (4.0, 1.0)), ((3.0, 3.3), (3.0, 3.0)), ((-0.2, 2.9), (0.0, 2.9)),
        ((0.3, 0.35), (0.5, 0.5)), ((1.5, 0.7), (1.5, 0.5)), ((2.4, 1.2), (2.5, 1.2)), ((2.0, 2.1), (2.0, 2.0)),
    ):  # fmt: skip
        arm = scale * np.array(on) - centre
        found = _displacement(shown, 1, scale * np.array(near))
        assert found == pytest.approx(turn * np.array([-arm[1], arm[0]]), rel=1e-9, abs=1e-12 * scale)


@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (70.0, -30.0, 20.0)])
def test_a_view_is_drawn_about_its_middle_wherever_the_model_stands(shift):
    """The slab of 2 x 2 m lies between spikes that begin at the ground: the box is 2 x 2 x 1.2 m."""
    data = space_view_data([concio.solve(concio.place(slab().model, shift))], [""])
    assert data["origin"] == pytest.approx(np.array([1.0, 1.0, 0.6]) + shift)
    assert data["low"] == pytest.approx([-1.0, -1.0, -0.6])
    assert data["high"] == pytest.approx([1.0, 1.0, 0.6])
