"""Figures: what is drawn is what was computed, on the axes given, with units, scales and one meaning a colour."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text

import concio
from concio.analysis.result import Result
from concio.display import Units
from concio.errors import InputError
from concio.kinematics.mass import signed_area
from concio.model.generate.arches import arch
from concio.plot import style
from concio.plot.figures import TITLES, suitable_figures, write_figures
from concio.plot.path_figure import plot_path
from concio.post.body_motion import body_motions
from concio.post.crosses import crosses
from concio.post.force_lines import force_chains, joint_forces
from concio.post.joint_lines import joint_lines
from concio.post.mechanism_states import mechanism_states
from concio.post.motion_frames import Frame, box_of
from concio.post.outlines import NO_MOTION, STILL, display_scale, outlines
from concio.post.pressure import pressure_diagrams
from concio.post.struts import Pushed, balanced, struts
from concio.post.thrust_line import thrust_lines
from concio.problem.certificate import kinematics
from concio.problem.solution import Status
from models import bearing_panel, box, on_ground, sliding_panel, weight


@pytest.fixture(scope="module")
def panel() -> Result:
    return concio.solve(bearing_panel())


@pytest.fixture(scope="module")
def ring() -> Result:
    return concio.solve(arch(span=4.0, ring=0.6, voussoirs=11))


@pytest.fixture(scope="module")
def collapse() -> Result:
    return concio.solve(sliding_panel(), on_failure="return")


def test_outlines_are_the_blocks(panel: Result) -> None:
    shown = outlines(panel)
    for (polygon,), body in zip(shown.moved(0.0), panel.model.bodies, strict=True):
        np.testing.assert_array_equal(polygon[0], polygon[-1])
        assert signed_area(polygon[:-1]) == pytest.approx(body.area, rel=1e-12)


def test_outlines_move_with_the_nodes(panel: Result) -> None:
    shown = outlines(panel)
    for b in range(len(panel.model.bodies)):
        nodes, moved = panel.nodes(b), panel.node_displacement(b)
        part = slice(shown.starts[b], shown.starts[b + 1])
        away = np.linalg.norm(shown.points[part][:, None] - nodes[None], axis=2)
        np.testing.assert_allclose(away.min(axis=1), 0.0, atol=1e-12)
        np.testing.assert_allclose(shown.displacement[part], moved[away.argmin(axis=1)], atol=1e-15)


@pytest.mark.parametrize("name", ["panel", "ring"])
def test_joint_pieces_cover_the_joints_and_move_with_both_sides(name: str, request: pytest.FixtureRequest) -> None:
    result: Result = request.getfixturevalue(name)
    pieces = joint_lines(result, outlines(result))
    pairs = result.assembly.pairs
    length = np.linalg.norm(pieces.ends[:, 1] - pieces.ends[:, 0], axis=1)
    face = pairs.interface[pieces.pair]
    np.testing.assert_allclose(
        np.bincount(face, length), [f.length for f in result.assembly.detection.interfaces], rtol=1e-6
    )
    # where a piece begins at its pair (the end of a joint), its sides move apart as C_n u and C_t u say
    ends = np.linalg.norm(pieces.ends[:, 0] - pairs.point[pieces.pair], axis=1) < 1e-9
    assert ends.sum() >= len(result.assembly.detection.interfaces)
    apart = (pieces.moved_b - pieces.moved_a)[ends, 0]
    k = pieces.pair[ends]
    u = result.displacement
    np.testing.assert_allclose((apart * pairs.normal[k]).sum(1), (pairs.C_n @ u)[k], atol=1e-12)
    np.testing.assert_allclose((apart * pairs.tangent[k]).sum(1), (pairs.C_t @ u)[k], atol=1e-12)


def test_motion_of_a_rigid_turn_is_that_turn(panel: Result) -> None:
    disc = panel.assembly.disc
    turn, shift = 1e-3, np.array([2e-3, -1e-3])
    u = np.zeros(disc.unknowns)
    for b in np.flatnonzero(disc.shape_of >= 0):
        arm = disc.nodes(b) - disc.centroids[b]
        u[disc.offsets[b] : disc.offsets[b + 1]] = (shift + turn * np.column_stack([-arm[:, 1], arm[:, 0]])).ravel()
    motion = body_motions(panel, u)
    free = disc.shape_of >= 0
    np.testing.assert_allclose(motion[free], np.tile([*shift, turn], (free.sum(), 1)), atol=1e-15)
    assert not motion[~free].any()


def test_motion_of_a_rigid_stone_three_times_as_wide_as_high() -> None:
    """Its unknown is the rotation times its radius of gyration."""
    result = concio.solve(on_ground(box("stone", 0, 3, 0, 1, kind="rigid", material="stone"), loads=(weight(),)))
    disc = result.assembly.disc
    assert disc.reach[1] == pytest.approx(np.sqrt(10 / 12))
    motion = body_motions(result, np.array([2e-3, -1e-3, disc.reach[1] * 1e-3]))
    np.testing.assert_allclose(motion[1], [2e-3, -1e-3, 1e-3], rtol=1e-12)


def carried_across(result: Result, height: float) -> float:
    """Vertical force of the chains across a horizontal cut [kN]."""
    chains = force_chains(result, 0.0)
    (x0, y0), (x1, y1) = np.moveaxis(chains.lines, 0, 2)
    cut = (y0 - height) * (y1 - height) < 0
    return float((chains.force * np.abs(y1 - y0) / np.hypot(x1 - x0, y1 - y0))[cut].sum())


def test_force_chains_pass_through_a_lintel_to_the_ground() -> None:
    """A stone in the middle of a lintel: its weight runs to both ends, and every cut carries what stands above it."""
    result = concio.solve(
        on_ground(
            box("left", 0, 0.5, 0, 1), box("right", 2, 2.5, 0, 1), box("lintel", 0, 2.5, 1, 1.4),
            box("stone", 1.0, 1.5, 1.4, 2, kind="rigid", material="stone"), loads=(weight(),),
        )
    )  # fmt: skip
    assert carried_across(result, 1e-3) == pytest.approx(-result.total_load[1], rel=1e-9)
    above = joint_forces(result)
    on_piers = np.abs(above.force[np.isclose(above.point[:, 1], 1.0), 1]).sum()
    assert carried_across(result, 1.0 + 1e-6) == pytest.approx(on_piers, rel=1e-9)
    chains = force_chains(result)
    inside = (chains.lines[:, :, 1] > 1 - 1e-9).all(axis=1) & (chains.lines[:, :, 1] < 1.4 + 1e-9).all(axis=1)
    ends = chains.lines[inside & (chains.force > 0)].reshape(-1, 2)
    assert (np.isclose(ends[:, 1], 1.4) & (np.abs(ends[:, 0] - 1.25) < 0.26)).any()  # from under the stone
    assert (np.isclose(ends[:, 1], 1.0) & (ends[:, 0] <= 0.5)).any()  # to the left pier
    assert (np.isclose(ends[:, 1], 1.0) & (ends[:, 0] >= 2.0)).any()  # and to the right one
    assert (chains.force[inside] < 0).any()  # a lintel bends


def test_in_a_block_whose_joints_carry_nothing_no_force_flows() -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.0, 0.4]])
    pressed = np.array([[0.0, 2.0], [0.0, 0.0], [0.0, -2.0]])
    idle, busy = (Pushed(corners[[0, 1, 3]], force, corners) for force in (0.0 * pressed, pressed))
    found = struts([idle, busy])
    assert found.force[found.body == 0] == pytest.approx(0.0, abs=1e-12)
    assert found.force[found.body == 1].max() == pytest.approx(2.0)


def test_force_chains_cross_a_bed_of_mortar_on_the_spot() -> None:
    result = concio.solve(
        on_ground(
            box("bed", 0, 2, 0, 0.02, material="mortar", mesh_size=0.5), box("left", 0, 0.9, 0.02, 0.5, mesh_size=0.5),
            box("right", 0.9, 2, 0.02, 0.5, mesh_size=0.5),
            loads=(weight(),), materials={"mortar": concio.Elastic(1e3)},
        )
    )  # fmt: skip
    assert carried_across(result, 0.01) == pytest.approx(-result.total_load[1], rel=1e-9)
    assert carried_across(result, 0.3) == pytest.approx(2.0 * 0.48 * 20.0, rel=1e-9)  # the stones, from their tops


def test_the_force_chain_of_an_arch_is_its_line_of_thrust(ring: Result) -> None:
    """A strut along every chord of the line of thrust, which carries most of the thrust on either side of it."""
    line = thrust_lines(ring)[0]
    chains = force_chains(ring)
    for k in range(len(line.points) - 1):
        chord = line.points[k : k + 2]
        off = np.minimum(*(np.abs(chains.lines[:, ::way] - chord).max(axis=(1, 2)) for way in (1, -1)))
        assert off.min() < 1e-9
        assert 0.6 * line.force[k : k + 2].min() < chains.force[off.argmin()] < 1.2 * line.force[k : k + 2].max()


@pytest.mark.parametrize("points", [2, 3, 5, 30])
@pytest.mark.parametrize("line", [False, True])
def test_struts_hold_what_acts_on_a_body(points: int, line: bool) -> None:
    """Random forces at random points, or at points on one line, and the load that balances them."""
    rng = np.random.default_rng(points)
    body = box("stone", 0, 2, 0, 1)
    across = 2.0 * (np.arange(points) + rng.uniform(0.0, 0.5, points)) / points
    place = np.column_stack([across, np.full(points, 1.0) if line else rng.uniform(0, 1, points)])
    pushed = balanced(body, place, rng.normal(size=(points, 2)))
    np.testing.assert_allclose(pushed.force.sum(axis=0), 0.0, atol=1e-12)
    moment = pushed.point[:, 0] * pushed.force[:, 1] - pushed.point[:, 1] * pushed.force[:, 0]
    assert moment.sum() == pytest.approx(0.0, abs=1e-9)
    bars = struts([pushed])
    way = bars.lines[:, 0] - bars.lines[:, 1]
    push = bars.force[:, None] * way / np.linalg.norm(way, axis=1)[:, None]
    for point, force in zip(pushed.point, pushed.force, strict=True):
        first, second = (np.abs(bars.lines[:, k] - point).max(axis=1) < 1e-9 for k in (0, 1))
        np.testing.assert_allclose(push[first].sum(axis=0) - push[second].sum(axis=0), -force, atol=1e-6)


@pytest.mark.parametrize("scale", [2.0**-9, 2.0**9])
def test_struts_of_a_body_of_any_size_are_the_same(scale: float) -> None:
    rng = np.random.default_rng(5)
    place = np.column_stack([rng.uniform(0, 2, 12), rng.uniform(0, 1, 12)])
    force = rng.normal(size=(12, 2))
    one = struts([balanced(box("stone", 0, 2, 0, 1), place, force)])
    other = struts([balanced(box("stone", 0, 2 * scale, 0, scale), scale * place, force)])
    assert other.lines / scale == pytest.approx(one.lines, abs=1e-9)
    assert other.force == pytest.approx(one.force, abs=1e-9)


def test_a_load_enters_above_joints_whose_forces_meet_in_one_point() -> None:
    """Two joints push at the middle of the foot: there is no chord between them."""
    foot, up = np.array([[1.0, 0.0], [1.0, 0.0]]), np.array([[0.3, 2.0], [-0.3, 3.0]])
    pushed = balanced(box("stone", 0, 2, 0, 1), foot, up)
    assert pushed.force[-1] == pytest.approx([0.0, -5.0])
    assert pushed.point[-1, 0] == pytest.approx(1.0)
    assert np.isfinite(pushed.point).all()


def test_crosses_of_a_pressed_column() -> None:
    block = concio.Elastic(1e5, 0.0)
    model = concio.running_bond_panel(
        courses=2, blocks=1, block=block, base="full", side_walls=False, top_pressure=10.0, friction=1.0
    )
    result = concio.solve(model)
    for of in ("bodies", "elements"):
        found = crosses(result, of)
        np.testing.assert_allclose(found.s2, -10.0, rtol=1e-9)
        np.testing.assert_allclose(found.s1, 0.0, atol=1e-7)
        arms, value = found.arms(0.02)
        upright = arms[value < -1.0]
        np.testing.assert_allclose(np.abs(upright[:, 1, 1] - upright[:, 0, 1]), 0.2, rtol=1e-9)
        np.testing.assert_allclose(upright[:, 1, 0], upright[:, 0, 0], atol=1e-9)


def test_element_stresses_average_to_the_block(panel: Result) -> None:
    found = crosses(panel, "elements")
    mean_trace = np.bincount(found.body, found.size**2 * (found.s1 + found.s2)) / np.bincount(found.body, found.size**2)
    body = crosses(panel)
    np.testing.assert_allclose(mean_trace[body.body], body.s1 + body.s2, rtol=1e-9, atol=1e-9)


def test_pressure_diagrams_hold_the_normal_forces(panel: Result) -> None:
    pieces = joint_lines(panel, outlines(panel))
    diagrams = pressure_diagrams(panel, pieces, 1e-3)
    loaded = np.flatnonzero([panel.contacts.pressure[panel.assembly.pairs.interface == j].max() > 0
                             for j in range(len(panel.joints.N))])  # fmt: skip
    assert len(diagrams) == len(loaded)
    force = [abs(signed_area(d)) / 1e-3 * 0.10 for d in diagrams]  # area over scale, times thickness
    np.testing.assert_allclose(force, panel.joints.N[loaded], rtol=1e-9, atol=1e-12)


def test_force_chains_carry_the_joint_forces(panel: Result) -> None:
    found = joint_forces(panel)
    joints = panel.joints
    np.testing.assert_allclose(found.size, np.hypot(joints.N, joints.V)[found.joint], rtol=1e-12)
    off = ((found.point - joints.middle[found.joint]) * joints.tangent[found.joint]).sum(1)
    assert (np.abs(off) <= joints.length[found.joint] / 2 * (1 + 1e-12)).all()


def test_thrust_line_of_an_arch(ring: Result) -> None:
    lines = thrust_lines(ring)
    assert len(lines) == 1
    line = lines[0]
    assert len(line.points) == 12
    assert len(line.bodies) == 13
    at_end = {name: np.hypot(*force) for name, force in ring.reactions.items()}
    ends = [at_end[ring.model.bodies[line.bodies[k]].name] for k in (0, -1)]
    np.testing.assert_allclose([line.force[0], line.force[-1]], ends, rtol=1e-9)
    order = np.argsort(line.points[:, 0])
    np.testing.assert_allclose(line.points[order][:, 1], line.points[order][::-1, 1], atol=1e-6)  # symmetric
    assert (line.ratio < 1).all()
    for k in range(1, 11):  # each body is between the joints next to it
        centre = ring.assembly.disc.centroids[line.bodies[k]]
        assert np.linalg.norm(line.points[k] - centre) < 0.8


def test_walls_have_no_thrust_line(collapse: Result) -> None:
    wall = concio.solve(
        concio.running_bond_panel(courses=3, blocks=3, base="full", side_walls=False, unit_weight=20.0, friction=0.6)
    )
    assert sum(len(line.points) for line in thrust_lines(wall)) * 2 <= len(wall.model.free_bodies)
    assert "thrust" not in suitable_figures(wall)


def test_mechanism_slides_where_it_slides(collapse: Result) -> None:
    assert collapse.status is Status.NO_EQUILIBRIUM
    shown = outlines(collapse, collapse.mechanism_velocity)
    pieces = joint_lines(collapse, shown)
    state = mechanism_states(collapse, pieces)
    bodies = collapse.model.bodies
    pairs = collapse.assembly.pairs
    on_ground = np.array([
        "fixed" in (bodies[a].kind, bodies[b].kind)
        for a, b in zip(pairs.body_a[pieces.pair], pairs.body_b[pieces.pair], strict=True)
    ])  # fmt: skip
    assert (state[on_ground] > 1).all()
    fixed = [i for i, b in enumerate(bodies) if b.kind == "fixed"]
    assert not shown.displacement[shown.starts[fixed[0]] : shown.starts[fixed[0] + 1]].any()
    ax = collapse.plot.mechanism()
    assert "22 of 22" not in _texts(ax)
    assert f"{len(collapse.model.free_bodies)} of {len(collapse.model.free_bodies)} bodies move" in _texts(ax)


def _texts(ax) -> str:
    labels = [t.get_text() for t in ax.texts] + [ax.get_title(loc="left"), ax.get_xlabel(), ax.get_ylabel()]
    if ax.get_legend():
        labels += [t.get_text() for t in ax.get_legend().get_texts()]
    return "\n".join(labels)


def _lines(ax, look: style.Line) -> list[np.ndarray]:
    found = []
    for c in ax.collections:
        colours = c.get_edgecolor() if isinstance(c, LineCollection) else []
        if len(colours) and to_hex(colours[0]) == look.colour.lower():
            found += [path.vertices for path in c.get_paths()]
    return found


NAMES = ["model", "deformed", "principal", "pressure", "forces", "slip"]


@pytest.mark.parametrize("name", NAMES)
def test_figures_draw_on_the_axes_given(panel: Result, name: str) -> None:
    import matplotlib.pyplot as plt

    open_before = plt.get_fignums()
    ax = Figure().add_subplot()
    assert getattr(panel.plot, name)(ax=ax) is ax
    assert ax.has_data()
    assert ax.get_title(loc="left")
    assert "[m]" in ax.get_xlabel()
    assert getattr(panel.plot, name)().figure is not ax.figure
    assert plt.get_fignums() == open_before  # nothing is kept alive or shown by pyplot
    hatched = [c for c in ax.collections if isinstance(c, PolyCollection) and c.get_hatch()]
    assert sum(len(c.get_paths()) for c in hatched) == sum(b.kind == "fixed" for b in panel.model.bodies)


def test_deformed_states_scale_and_shows_states(panel: Result) -> None:
    ax = panel.plot.deformed(scale=25.0)
    assert "displacements x 25" in _texts(ax)
    states = panel.contacts.state
    assert len(_lines(ax, style.STICK)) == (states == 1).sum()
    assert len(_lines(ax, style.SLIP)) == (states > 1).sum()
    assert len(_lines(ax, style.OPEN)) == 2 * (states == 0).sum()  # both sides of a gap
    for word in (style.STICK.word, style.SLIP.word, "open"):
        assert word in _texts(ax)


@pytest.mark.parametrize("of", ["bodies", "elements"])
def test_crosses_tell_compression_from_tension_twice(panel: Result, of: str) -> None:
    ax = panel.plot.principal(of=of)
    found = crosses(panel, of)
    value = np.concatenate([found.s1, found.s2])
    shown = np.abs(value) > 0.01 * found.largest
    assert len(_lines(ax, style.COMPRESSION)) == (shown & (value < 0)).sum()
    assert len(_lines(ax, style.TENSION)) == (shown & (value > 0)).sum()
    assert style.COMPRESSION.dash != style.TENSION.dash
    assert Units().text("stress", float(found.s2.min())) in _texts(ax)
    drawn = np.vstack(_lines(ax, style.COMPRESSION) + _lines(ax, style.TENSION))
    for points, (low, high) in zip(drawn.T, (ax.get_xlim(), ax.get_ylim()), strict=True):
        assert low <= points.min() <= points.max() <= high  # no arm is cut off at the frame


@pytest.mark.parametrize("scale", [0.01, 1.0])
def test_no_diagram_of_pressure_is_cut_off_at_the_frame(panel: Result, scale: float) -> None:
    ax = panel.plot.pressure(scale=scale)
    drawn = [c for c in ax.collections if isinstance(c, PolyCollection) and c.get_zorder() == 3]
    points = np.vstack([path.vertices for c in drawn for path in c.get_paths()])
    assert np.ptp(points, axis=0).max() > scale  # some pressure is above 1 kN/m2
    for values, (low, high) in zip(points.T, (ax.get_xlim(), ax.get_ylim()), strict=True):
        assert low <= values.min() <= values.max() <= high


def test_looks_differ_in_grey() -> None:
    """Every state differs from every other by dash or by width, not by colour alone."""
    looks = [style.STICK, style.SLIP, style.OPEN, style.COMPRESSION, style.TENSION]
    assert len({(str(look.dash), look.width) for look in looks}) == len(looks)


def test_figures_suit_the_outcome(panel: Result, collapse: Result, ring: Result) -> None:
    assert {"deformed", "principal", "forces"} <= set(suitable_figures(panel))
    assert set(suitable_figures(collapse)) == {"model", "mechanism"}
    assert "thrust" in suitable_figures(ring)
    assert set(suitable_figures(ring)) | {"mechanism"} <= set(TITLES)


def test_figures_that_make_no_sense_are_refused(panel: Result) -> None:
    with pytest.raises(InputError, match="no mechanism"):
        panel.plot.mechanism()
    pressed = concio.running_bond_panel(courses=3, blocks=4, joint=0.02, friction=0.6, top_pressure=10.0)
    wall = concio.solve(pressed)
    assert not thrust_lines(wall)
    with pytest.raises(InputError, match="no line of thrust"):
        wall.plot.thrust()


def test_drawings_are_reproducible(collapse: Result, tmp_path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        write_figures(collapse, tmp_path / name, formats=("svg",))
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes()


def test_path_figure_shows_events_and_peak() -> None:
    events = [SimpleNamespace(parameter=0.5, control=0.001, kind="opens"),
              SimpleNamespace(parameter=1.0, control=0.004, kind="slips")]  # fmt: skip
    curve = SimpleNamespace(parameter=[0.0, 0.5, 1.0, 0.8], control=[0.0, 0.001, 0.004, 0.01], events=events)
    ax = Figure().add_subplot()
    assert plot_path(curve, ax, bound=1.1) is ax
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), curve.control)
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), curve.parameter)
    text = _texts(ax)
    assert "peak 1" in text
    assert "a joint opens (1)" in text
    assert "a joint slips (1)" in text
    assert "bound 1.1" in text


@pytest.mark.parametrize(("largest", "unit", "told"), [(0.01, "[mm]", "10"), (0.4, "[m]", "0.4")])
def test_path_figure_tells_small_motions_in_mm(largest: float, unit: str, told: str) -> None:
    curve = SimpleNamespace(parameter=[0.0, 1.0], control=[0.0, -largest], events=[])
    ax = plot_path(curve)
    ax.figure.canvas.draw()
    assert ax.get_xlabel().endswith(unit)
    ticks = [label.get_text().replace("\N{MINUS SIGN}", "-") for label in ax.get_xticklabels()]
    assert f"-{told}" in [tick.rstrip("0") if "." in tick else tick for tick in ticks]
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), curve.control)


@pytest.mark.parametrize(
    ("largest", "size", "scale"), [(1e-3, 1.0, 50.0), (3.9e-3, 1.4, 10.0), (1.0, 1.0, 0.05), (0.0, 1.0, 1.0)]
)
def test_display_scale_is_round(largest: float, size: float, scale: float) -> None:
    assert display_scale(largest, size) == pytest.approx(scale)




def test_the_frame_of_a_film_holds_what_moves_in_every_picture():
    model = on_ground(box("block", 0, 1, 0, 2))
    pictures = []
    for k in (0.0, 3.0):
        rings = tuple((b.outline + np.array([k * (b.kind != "fixed"), 0.0]),) for b in model.bodies)
        pictures.append(Frame(len(pictures), k, "", rings))
    low, high = box_of(pictures, model)
    assert low == pytest.approx([-0.32, -0.32])  # 8 hundredths of the larger side beyond what moves
    assert high == pytest.approx([4.32, 2.32])


@pytest.mark.parametrize("size", [0.3, 1.0, 40.0])
def test_rounding_is_not_drawn_as_motion(size: float) -> None:
    """A block that sticks stood beside its place, and its joint was drawn as slipping: both were rounding x 1e21."""
    assert display_scale(0.5 * NO_MOTION * size, size) == 1.0
    assert display_scale(2.0 * NO_MOTION * size, size) > 1e9
    column = concio.column(width=0.5 * size, height=size, blocks=2, block="rigid", unit_weight=20.0, horizontal=0.2)
    result = concio.solve(column)
    rounding = 1e-17 * size * np.random.default_rng(0).normal(size=result.solution.displacement.shape)
    problem = result.assembly.problem(result.factors)
    found = result.solution
    seen = kinematics(problem, rounding, found.normal_force, found.friction_force)
    moved = replace(result, solution=replace(found, displacement=rounding, kinematics=seen))
    ax = moved.plot.deformed()
    assert STILL in [text.get_text() for text in ax.figure.findobj(Text)]
    drawn = np.concatenate([path.vertices for c in ax.findobj(PolyCollection) for path in c.get_paths()])
    assert np.abs(drawn[:, 0]).max() <= 0.25 * size * (1 + 1e-9)
    slips = moved.plot.slip()
    assert not [c for c in slips.findobj(LineCollection) if max(c.get_linewidths(), default=0.0) > 5.0]


def test_what_moves_is_drawn_as_before(panel: Result) -> None:
    ax = panel.plot.deformed()
    assert [t for t in ax.figure.findobj(Text) if t.get_text().startswith("displacements x ")]
