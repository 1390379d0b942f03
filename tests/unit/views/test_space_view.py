"""Blocks and joints in space as they are drawn: surfaces, pieces of joints, pictures, and the data of reports."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.quiver import Quiver

import concio
from concio.analysis.result import Result
from concio.plot.picture import Picture
from concio.plot.space_figures import VIEWS, directions, plot_space_model
from concio.post.body_motion import body_motions
from concio.post.joint_faces import joint_faces, pieces_of
from concio.post.mechanism_states import mechanism_states
from concio.post.solids import model_solids, moved_ties, solids
from concio.problem.solution import Mechanism, Status, failed
from concio.report.page import report_html
from concio.report.space_data import space_view_data
from concio.report.view_data import steps_within, unpack
from solids import box, frame_block, l_block, turned


def tower(mu: float = 0.6) -> concio.Model:
    """Return a block of 3:1:0.5 on a fixed one, with an L on top: no axis is like another."""
    bodies = (
        box("ground", (-2, -1, -0.4), (4, 3, 0), kind="fixed"),
        box("low", (0, 0, 0), (3, 1, 0.5), kind="rigid", material="stone"),
        l_block("top", 1.0, 0.5, kind="rigid", material="stone"),
    )
    return concio.Model(
        bodies=bodies,
        materials={"stone": concio.Rigid(unit_weight=20.0)},
        laws={"dry": concio.JointLaw(friction=mu)},
        rules=(concio.JointRule("dry"),),
        loads=(concio.Load("weight", (0, 0, -1)),),
    )


def moving(model: concio.Model, velocity: dict[str, tuple[tuple[float, ...], tuple[float, ...]]]) -> Result:
    """Return a result whose mechanism moves bodies by (translation of the centroid, rotation)."""
    assembly = concio.assemble(model)
    problem, disc = assembly.problem(), assembly.disc
    v = np.zeros(problem.unknowns)
    for b, body in enumerate(model.bodies):
        if body.name in velocity:
            move, turn = velocity[body.name]
            v[disc.offsets[b] : disc.offsets[b] + 6] = [*move, *(disc.reach[b] * np.array(turn))]
    mechanism = Mechanism(v, 1.0, 0.0)
    return Result(assembly, {}, failed(problem, Status.NO_EQUILIBRIUM, method="", mechanism=mechanism), {})


def test_surfaces_enclose_the_volume_of_their_bodies() -> None:
    bodies = (box("a", (0, 0, 0), (3, 1, 0.5)), turned(frame_block("b")), turned(l_block("c", 0.7)))
    model = concio.Model(bodies=bodies, materials={"block": concio.Elastic(E=1e6, nu=0.2)}, laws={}, rules=())
    shown = model_solids(model)
    corners = shown.points[shown.triangles]
    pieces = np.einsum("ti,ti->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    volume = np.bincount(shown.body, pieces)
    assert volume == pytest.approx([1.5, 5.5, 2.1], rel=1e-12)
    edges = [int((shown.edge_body == b).sum()) for b in range(3)]
    assert edges == [12, 24, 18]  # no line where triangles of one face meet


def test_bodies_are_drawn_where_they_move() -> None:
    turn = (0.1, -0.2, 0.3)
    result = moving(tower(), {"top": ((0.5, 0.0, -0.25), turn)})
    shown = solids(result, result.mechanism_velocity)
    motion = body_motions(result, result.mechanism_velocity)
    assert motion[2] == pytest.approx([0.5, 0.0, -0.25, *turn])
    own = shown.body[np.isin(shown.triangles, np.arange(shown.starts[2], shown.starts[3])).all(axis=1)]
    assert set(own) == {2}
    points = shown.points[shown.starts[2] :]
    centre = result.assembly.disc.centroids[2]
    wanted = np.array([0.5, 0, -0.25]) + np.cross(turn, points - centre)
    assert shown.displacement[shown.starts[2] :] == pytest.approx(wanted, abs=1e-12)
    assert not shown.displacement[: shown.starts[2]].any()


def test_pieces_cover_each_joint_once_and_lie_nearest_to_their_pair() -> None:
    result = moving(tower(), {})
    corners, pair = pieces_of(result)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    pairs = result.assembly.pairs
    total = np.bincount(pairs.interface[pair], area)
    assert total == pytest.approx([p.area for p in result.assembly.detection.patches], rel=1e-9)
    middle = corners.mean(axis=1)
    for at, k in zip(middle, pair, strict=True):
        rivals = np.flatnonzero(pairs.interface == pairs.interface[k])
        away = np.linalg.norm(pairs.point[rivals] - at, axis=1)
        assert np.linalg.norm(pairs.point[k] - at) <= away.min() + 1e-9


def test_joints_of_a_mechanism_open_where_they_open() -> None:
    # the top turns about its edge x = 0, which stays closed, and opens away from it
    turn = np.array([0.0, -1.0, 0.0])
    model = tower()
    centre = concio.assemble(model).disc.centroids[2]
    result = moving(model, {"top": (tuple(np.cross(turn, centre - [0.0, 0.0, 0.5])), tuple(turn))})
    faces = joint_faces(result, result.mechanism_velocity)
    state = mechanism_states(result, faces)
    top = result.assembly.pairs.body_b[faces.pair] == 2
    opened = np.linalg.norm((faces.moved_b - faces.moved_a).mean(axis=1), axis=1)
    assert opened[top] == pytest.approx(faces.corners.mean(axis=1)[top, 0], abs=1e-9)
    assert (state[~top] == 1).all()
    assert (state[top] == 0).all()


def test_sliding_joints_are_told_from_opening_ones() -> None:
    for rise, wanted in ((0.59, 2), (0.61, 0)):  # friction 0.6
        result = moving(tower(0.6), {"top": ((0.6, 0.8, rise), (0, 0, 0))})
        faces = joint_faces(result, result.mechanism_velocity)
        state = mechanism_states(result, faces)
        assert set(state[result.assembly.pairs.body_b[faces.pair] == 2]) == {wanted}


def test_views_look_along_three_right_handed_axes() -> None:
    for view in VIEWS:
        right, up, eye = directions(view)
        assert np.cross(right, up) == pytest.approx(eye, abs=1e-12)
    assert directions("front")[2] == pytest.approx([0, -1, 0])
    assert directions("plan")[2] == pytest.approx([0, 0, 1])
    with pytest.raises(concio.InputError, match="no view 'top'"):
        directions("top")


def test_a_picture_shows_what_is_nearest() -> None:
    picture = Picture.of(np.array([[0.0, 0.0], [2.0, 1.0]]), np.eye(3))
    near = np.array([[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]])
    far = np.array([[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]])
    for first, second in ((near, far), (far, near)):
        picture.depth[:] = -np.inf
        for triangle in (first, second):
            picture.fill(triangle, np.array([[1.0, 0, 0] if triangle is near else [0, 0, 1.0]]))
        height, width = picture.depth.shape
        assert picture.colour[height // 4, width // 8].tolist() == [255, 0, 0]
        assert picture.colour[height // 4, width // 2].tolist() == [0, 0, 255]
    picture.stroke(np.array([[[0.0, 0.25, 0.5], [1.5, 0.25, 0.5]]]), (0.0, 1.0, 0.0), 1, 1e-9)
    row = picture.colour[round(0.25 / picture.step)]
    assert row[width // 8].tolist() == [255, 0, 0]  # behind the near triangle
    assert row[width // 2].tolist() == [0, 255, 0]


def test_ties_are_carried_along_by_their_bodies() -> None:
    """One end rises and turns about x with its block, the other stands; twice as far at a scale of two."""
    tie = concio.Tie("bar", "top", (1.0, 0.0, 0.75), "", (5.0, 0.0, 0.75), stiffness=1e3)
    result = moving(replace(tower(), ties=(tie,)), {"top": ((0, 0, 1.0), (0.5, 0, 0))})
    arm = np.array([1.0, 0.0, 0.75]) - result.model.polyhedra[2].centroid
    ends = moved_ties(result, result.mechanism_velocity, 2.0)
    assert ends[0, 1] == pytest.approx([5.0, 0.0, 0.75])
    assert ends[0, 0] == pytest.approx([1.0, -2 * 0.5 * arm[2], 0.75 + 2 * (1.0 + 0.5 * arm[1])])
    data = space_view_data([result], ["collapse"])["ties"]
    assert unpack(data["body"]).tolist() == [2, -1]


def test_a_legend_explains_only_what_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The joint under a block that lifts is seen from the corner, and is hidden by both blocks from above."""
    monkeypatch.setattr("concio.plot.picture.LONGER_SIDE", 400)
    result = moving(tower(), {"top": ((0, 0, 1.0), (0, 0, 0))})
    words = {}
    for view in ("axonometry", "plan"):
        figure = result.plot.mechanism(view=view).figure
        told = [t.get_text() for legend in (*figure.legends, figure.axes[0].get_legend()) if legend
                for t in legend.get_texts()]  # fmt: skip
        words[view] = told
    assert words == {"axonometry": ["opens"], "plan": []}


@pytest.mark.long
def test_figures_of_a_model_in_space() -> None:
    for view in ("front", "axonometry"):
        axes = plot_space_model(tower(), view=view)
        assert len(axes.images) == 1
    assert plot_space_model(tower(), view="side").get_xlabel() == "y [m]"


@pytest.mark.long
def test_the_report_of_a_mechanism_in_space_is_one_offline_file() -> None:
    result = moving(tower(), {"top": ((0, 0, 1.0), (0, 0, 0))})
    data = space_view_data([result], ["collapse"])
    assert unpack(data["bodies"]["owner"]).max() == 2
    assert data["mechanism"]
    page = report_html(result)
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert 'id="cut-z"' in page
    assert "webgl" in page
    text = page.split('id="data">')[1].split("</script>")[0]
    assert json.loads(text)["bodies"]["name"] == ["ground", "low", "top"]
    assert page.count("<figure") == 5


@pytest.mark.long
def test_loads_are_drawn_where_and_as_they_act() -> None:
    face = ((0, 0, 0), (3, 0, 0), (3, 0, 0.5), (0, 0, 0.5))
    loads = (
        concio.Load("pressure", (2.0,), ("low",), polygon=face),
        concio.Load("pressure", (-3.0,), polygon=face[::-1]),
        concio.Load("point", (-4.0, 0.0, 0.0), ("low",), at=(3.0, 0.5, 0.2)),
    )
    ax = plot_space_model(replace(tower(), loads=loads), view="plan", names=False)
    arrows = [a for a in ax.collections if isinstance(a, Quiver)]
    assert [np.sign(np.round([*a.U, *a.V], 9)).tolist() for a in arrows] == [[0, 1], [0, -1], [-1, 0]]
    assert {"2 kN/m2", "3 kN/m2", "4 kN"} <= {text.get_text() for text in ax.texts}
    front = plot_space_model(replace(tower(), loads=loads), view="front", names=False)
    assert len([a for a in front.collections if isinstance(a, Quiver)]) == 1  # the others come straight at the eye


def test_both_views_say_how_many_steps_they_leave_out() -> None:
    column = concio.column(width=0.5, height=1.0, blocks=2, block="rigid", unit_weight=20.0)
    for model in (column, concio.extrude(column, thickness=0.5)):
        page = report_html(concio.solve(model), figures=False)
        assert page.count("if (data.left_out) complain(") == 1
        assert '"left_out":0' in page


def test_forces_of_joints_act_where_they_are_in_the_view_too() -> None:
    result = concio.solve(tower())
    data = space_view_data([result], ["one"])
    at = unpack(data["steps"][0]["at"]).reshape(-1, 3) + np.array(data["origin"])
    assert at == pytest.approx(result.joints_in_space.point, abs=1e-6)


@pytest.mark.parametrize(("budget", "count", "each", "kept"), [
    (100, 50, 10, 10), (100, 5, 10, 5), (100, 50, 1000, 2), (100, 3, 0, 3), (0, 50, 10, 2)])  # fmt: skip
def test_steps_of_a_view_fit_into_a_budget_with_the_first_and_the_last(
    budget: int, count: int, each: int, kept: int
) -> None:
    found = steps_within(budget, count, each)
    assert len(found) == kept
    assert (found[0], found[-1]) == (0, count - 1)
    gaps = np.diff(found)
    assert gaps.min() > 0
    assert gaps.max() - gaps.min() <= 1
