"""Walls beside their homogenised continuum: exact cases, bounds from both sides, halved blocks, what is refused."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

import concio
from concio.analysis.cells.half_spaces import HalfSpaces
from concio.analysis.continuum.answers import CHECKED, StrengthComparison
from concio.analysis.continuum.continuum import continuum_of
from concio.analysis.continuum.elastic import solve_elastic
from concio.analysis.continuum.kinematic_bound import kinematic_bound
from concio.analysis.continuum.outline import mesh_lines
from concio.analysis.continuum.static_bound import static_bound
from samples import sample

DEAD, LIVE = {"dead": 1.0, "live": 0.0}, {"dead": 0.0, "live": 1.0}
STONE = concio.Rigid(unit_weight=20.0)


def mesh_of(wall, size=0.5, stretch=1.0):
    return continuum_of(concio.assemble(wall), size, stretch)


def pushed(n=1, **options):
    """A dry wall pushed by a share of its weight, blocks n times smaller."""
    given = {"length": 3.2, "height": 2.1, "block_size": (0.8 / n, 0.35 / n), "friction": 0.65, "block": STONE}
    return concio.wall(**given | {"horizontal": 1.0} | options)


@pytest.mark.parametrize("stretch", [1.0, 6.0, 0.2])
def test_the_mesh_covers_the_wall_and_leaves_its_openings(stretch):
    door = [{"x": 1.2, "y": 0.0, "width": 0.8, "height": 1.4}, {"x": 2.4, "y": 1.05, "width": 0.4, "height": 0.35}]
    wall = mesh_of(pushed(openings=door), 0.4, stretch)
    model = pushed(openings=door)
    assert wall.areas.min() > 0
    assert wall.areas.sum() == pytest.approx(sum(b.area for b in model.outlines if b.kind != "fixed"), rel=1e-12)
    assert (wall.lengths[:, None] * wall.outward).sum(0) == pytest.approx([0, 0], abs=1e-12)
    assert wall.lengths[wall.held_by >= 0].sum() == pytest.approx(3.2 - 0.8)
    x, y = wall.points[wall.edges].mean(axis=1)[wall.held_by >= 0].T
    assert np.abs(y).max() == 0
    assert not ((x > 1.2) & (x < 2.0)).any()


def test_a_wall_on_its_ground_has_the_settlement_of_springs_in_series():
    """Stack bond, nu = 0: nothing moves sideways, compliances along y add, half a course more than the blocks have."""
    stone, joint = concio.Elastic(E=1e6, nu=0.0, unit_weight=0.0), concio.JointLaw(0.6, normal_stiffness=2e5,
                                                                                  tangential_stiffness=1e5)
    wall = concio.wall(length=2.0, height=1.5, block_size=(0.5, 0.25), bond="stack", block=stone, friction=joint,
                       top_pressure=100.0, thickness=0.3)
    found = concio.compare_with_continuum(wall).elastic
    soft = 1 / 1e6 + 1 / (0.25 * 2e5)
    assert found.moduli.E_y == pytest.approx(1 / soft, rel=1e-9)
    assert found.continuum.max_settlement == pytest.approx(100.0 * (1.5 * soft + 1 / 2e5), rel=1e-10)
    assert np.abs(found.continuum.stress - [0, -100, 0]).max() < 1e-7
    assert found.continuum.reactions["ground"] == pytest.approx([0, 60.0], abs=1e-8)
    blocks, bonded, _ = found.settlements
    assert blocks == pytest.approx(bonded, rel=1e-9)
    assert bonded == pytest.approx(100.0 * (1.375 / 1e6 + 6 / 2e5), rel=1e-9)


@pytest.mark.parametrize("stiffness", [None, 1e5])
def test_a_ground_that_moves_and_turns_takes_the_wall_along_without_stress(stiffness):
    law = concio.JointLaw(0.6, normal_stiffness=stiffness, tangential_stiffness=stiffness)
    wall = concio.wall(length=2.0, height=1.5, block_size=(0.5, 0.25), block=concio.Elastic(1e6, 0.2), friction=law)
    move = concio.Support("moved", "ground", displacement=(2e-3, -1e-3), rotation=5e-4)
    mesh = mesh_of(replace(wall, loads=(), supports=(move,)))
    matrix = np.array([[3.0, 0.4, 0.2], [0.4, 1.0, -0.1], [0.2, -0.1, 0.5]]) * 1e5
    found = solve_elastic(mesh, matrix, {})
    x, y = (mesh.points - wall.body("ground").centroid).T
    assert found.displacement == pytest.approx(np.column_stack([2e-3 - 5e-4 * y, -1e-3 + 5e-4 * x]), abs=1e-12)
    assert np.abs(found.stress).max() < 1e-6


@pytest.mark.long
def test_bonded_blocks_come_to_the_continuum_in_proportion_to_their_size():
    def make(n):
        law = concio.JointLaw(0.65, normal_stiffness=3e5 * n, tangential_stiffness=1.2e5 * n)
        return concio.wall(length=3.2, height=2.1, block_size=(0.8 / n, 0.35 / n), friction=law, side_walls=True,
                           top_pressure=100.0, block=concio.Elastic(1e6, 0.2, unit_weight=20.0))

    found = concio.halve_blocks(make, sizes=(1, 2, 4))
    table = found.table()
    apart = table["difference_bonded"]
    assert (apart[1:] / apart[:-1] < 0.65).all()
    assert (apart[1:] / apart[:-1] > 0.4).all()
    assert apart[-1] < 0.04
    assert (table["difference_blocks"] > 0.5).all(), "joints that slip along the side walls are not moduli"
    assert found.comparisons[0].strength is None
    assert np.isnan(found.bracket).all()
    hung = found.comparisons[2].elastic
    assert hung.blocks.reactions["left wall"][1] < 0.1 * hung.continuum.reactions["left wall"][1]


def test_sliding_on_the_base_is_exact_from_both_sides():
    """A long low wall on a smooth base: the base slides before anything else, at its own coefficient."""
    wall = pushed(length=4.8, height=0.7, base_friction=0.2)
    found = concio.compare_with_continuum(wall, elastic=False).strength
    assert found.bracket == pytest.approx((0.2, 0.2), rel=1e-9)
    assert found.blocks.associated.multiplier == pytest.approx(0.2, rel=1e-9)
    assert found.proven == (True, True)


@pytest.mark.long
def test_crushing_under_pressure_is_exact_from_both_sides():
    law = concio.JointLaw(0.6, cohesion=50.0, tensile_strength=20.0, compressive_strength=3000.0)
    wall = concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), block=STONE, friction=law, top_pressure=1.0)
    wall = replace(wall, loads=tuple(replace(v, group="live") for v in wall.loads if v.kind == "pressure"))
    found = concio.compare_with_continuum(wall, elastic=False).strength
    assert found.bracket == pytest.approx((3000.0, 3000.0), rel=1e-8)
    assert found.blocks.associated.multiplier == pytest.approx(3000.0, rel=1e-8)


@pytest.mark.long
def test_prandtls_strip_footing_is_enclosed():
    """(2 + pi) c on a half-space of |s_1 - s_2| <= 2 c, here a polygon of 12 sides around the circle of Mohr."""
    turn = 2 * np.pi * (np.arange(12) + 0.5) / 12
    normals = np.column_stack([np.cos(turn) / 2, -np.cos(turn) / 2, np.sin(turn)])
    faces = HalfSpaces.of(normals, np.full(12, 10.0))
    glue = concio.JointLaw(0.6, cohesion=1e4, tensile_strength=1e4)
    wall = concio.wall(length=4.0, height=1.5, block_size=(0.5, 0.25), block=STONE, side_walls=True, friction=glue)
    strip = concio.Load("pressure", (1.0,), edge=((1.5, 1.5), (2.5, 1.5)), group="live")
    mesh = mesh_of(replace(wall, loads=(strip,)), 0.5)
    low = static_bound(mesh, faces, {"live": 0.0}, {"live": 1.0})
    high = kinematic_bound(mesh, faces, {"live": 0.0}, {"live": 1.0})
    assert max(low.residual, high.residual) < 1e-8
    exact = (2 + np.pi) * 10.0
    assert 0.9 * exact < low.multiplier < exact / np.cos(np.pi / 12)
    assert exact < high.multiplier < 1.1 * exact


@pytest.mark.long
@pytest.mark.parametrize("case", range(sample(1, 4)))
def test_stresses_never_carry_more_than_a_mechanism_allows(case):
    rng = np.random.default_rng(case)
    law = concio.JointLaw(rng.uniform(0.4, 0.9), cohesion=rng.uniform(0, 20), tensile_strength=rng.uniform(0, 10))
    wall = pushed(length=rng.uniform(2, 4), height=rng.uniform(1.5, 3), friction=law, top_pressure=rng.uniform(0, 50))
    found = concio.compare_with_continuum(wall, elastic=False, mesh_size=0.8).strength
    low, high = found.bracket
    assert 0 < low <= high * (1 + 1e-8)
    assert found.proven == (True, True)


@pytest.mark.long
def test_the_limit_load_comes_down_to_that_of_the_continuum_as_blocks_are_halved():
    found = concio.halve_blocks(pushed, sizes=(1, 2, 4), elastic=False)
    low, high = found.bracket
    load = found.table()["limit_blocks"]
    assert load == pytest.approx([0.65, 0.56624418, 0.48886525], rel=1e-6)
    assert low < high < load.min()
    assert high - low < 0.08 * high
    smaller = load[-1] - (load[-2] - load[-1])  # if what is left is in proportion to the size
    assert low < smaller < high


@pytest.mark.long  # its stresses and mechanisms bound each other
def test_the_bounds_are_those_of_the_same_wall_seen_in_a_mirror():
    wall = pushed(length=2.4, height=2.1)
    other = replace(wall, loads=tuple(replace(v, value=(-v.value[0], v.value[1])) for v in wall.loads))
    a, b = (concio.compare_with_continuum(w, elastic=False, mesh_size=0.6).strength.bracket for w in (wall, other))
    assert a == pytest.approx(b, rel=1e-7)


@pytest.mark.long
def test_the_cell_of_the_bond_is_found_or_asked_for():
    flemish = pushed(bond="flemish")
    own = concio.compare_with_continuum(flemish, elastic=False).cell.model
    assert own.generator["bond"] == "flemish"
    assert own.laws["joint"] == flemish.laws["joint"]
    arch = concio.column(width=0.5, height=1.0, blocks=4, friction=0.6, horizontal=1.0)
    with pytest.raises(concio.InputError, match="cell that this wall repeats is not known"):
        concio.compare_with_continuum(arch)
    cell = concio.cell(block_size=(0.5, 0.25), bond="stack", friction=0.6)
    assert concio.compare_with_continuum(arch, cell, elastic=False).strength is not None


@pytest.mark.long
def test_what_is_carried_without_end_and_what_is_not_carried_at_all():
    """Pressure on a dry wall; a dry wall with a door, whose continuum has no lintel: proofs of both."""
    wall = concio.wall(length=2.0, height=1.5, block_size=(0.5, 0.25), block="rigid", friction=0.6, top_pressure=10.0)
    found = concio.compare_with_continuum(wall, live="top", elastic=False)
    assert found.strength.bracket == (np.inf, np.inf)
    assert found.strength.proven == (True, True)
    assert found.checked
    with pytest.raises(concio.InputError, match="none to draw"):
        found.plot.mechanism()
    door = pushed(openings=[{"x": 1.2, "y": 0.0, "width": 0.8, "height": 1.4}], lintel=concio.Rigid(25.0))
    found = concio.compare_with_continuum(door, elastic=False, mesh_size=0.7)
    assert found.cell.model.materials["block"] == STONE
    assert found.strength.blocks.associated.multiplier > 0.1
    assert found.strength.kinematic.multiplier == -np.inf
    assert found.strength.kinematic.residual < 1e-8
    assert found.strength.proven == (True, True)
    over = found.strength.kinematic.wall.points
    falls = found.strength.kinematic.velocity[:, 1] < -0.1
    assert ((over[falls, 0] > 0.6) & (over[falls, 0] < 2.6)).all(), "what falls is over the door"


@pytest.mark.long
def test_ground_that_tears_apart_leaves_no_bonded_answer():
    halves = [
        concio.Body(n, [[x, -0.3], [x + 1.0, -0.3], [x + 1.0, 0], [x, 0]], kind="fixed")
        for n, x in (("west", 0.0), ("east", 1.0))
    ]
    wall = concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), block=concio.Elastic(1e7, 0.2, unit_weight=20.0),
                       friction=0.6, side_walls=True, ground=False)
    sinks = concio.Support("sinks", "east", displacement=(0.0, -1e-3))
    found = concio.compare_with_continuum(replace(wall, bodies=(*wall.bodies, *halves), supports=(sinks,))).elastic
    assert found.bonded is None
    blocks, bonded, smooth = found.settlements
    assert np.isnan(bonded)
    assert 0.9e-3 < blocks < 1.2e-3
    assert 0.5e-3 < smooth < 1.1e-3
    assert np.isnan(found.differences[1])


ARCH = concio.arch(span=2.0, ring=0.2, voussoirs=9, friction=0.6, horizontal=0.1)
BOND = concio.cell(block_size=(0.8, 0.35), friction=0.65, block=STONE)


@pytest.mark.parametrize(
    ("wall", "options", "words"),
    [
        (ARCH, {"cell": BOND}, "neither along x nor along y"),
        (BOND, {}, "periodic cell"),
        (pushed(), {"cell": pushed()}, "no periods"),
        (pushed(), {"live": "wind"}, "no load group 'wind'"),
        (pushed(), {"factors": {"snow": 1.0}}, "no load group 'snow'"),
        (pushed(), {"mesh_size": 0.0}, "must be positive"),
        (pushed(), {"mesh_size": 1e-4}, "triangles, more than"),
        (pushed(), {"mesh": 0.2}, "mesh"),
        (pushed(), {"cell": concio.cell(friction=0.6, thickness=0.3)}, "cell is 0.3 m thick"),
        (replace(pushed(), loads=(concio.Load("point", (1.0, 0.0), ("c01-b01",), at=(0.1, 0.1)),)), {}, "point loads"),
    ],
)
def test_what_has_no_continuum_is_refused(wall, options, words):
    with pytest.raises((concio.InputError, TypeError), match=words):
        concio.compare_with_continuum(wall, **options)


def test_a_dead_load_that_is_not_carried_is_said():
    wall = pushed(base_friction=0.1)
    dead = [replace(v, group="dead") for v in wall.loads]
    wall = replace(wall, loads=(*dead, concio.Load("weight", (0.1, 0.0), group="live")))
    with pytest.raises(concio.NoEquilibriumError, match="constant loads alone"):
        concio.compare_with_continuum(wall, elastic=False)


@pytest.mark.parametrize("sizes", [(), (2, 1), (0, 1), (1.5,), (True, 2)])
def test_sizes_that_mean_nothing_are_refused(sizes):
    with pytest.raises(concio.InputError, match="whole numbers"):
        concio.halve_blocks(pushed, sizes=sizes)


@pytest.mark.parametrize("near", [1e-6, 1e-3, 0.5])
def test_a_mesh_has_lines_through_corners_and_through_points_that_are_not_near_another_line(near):
    size = 100.0 * near
    shape = shapely.box(0.0, 0.0, size, 2.0 * size)
    points = np.array([[0.3, 0.5], [0.35, 0.7], [0.95, 3.0]]) * size
    columns, rows = mesh_lines(shape, points, near)
    assert columns == pytest.approx(size * np.array([0.0, 0.3, 1.0]))
    assert rows == pytest.approx(size * np.array([0.0, 0.5, 0.7, 2.0]))


@pytest.mark.parametrize(
    ("exact", "static", "kinematic", "proven"),
    [
        (True, (0.3, 0.0), (0.4, 0.0), (True, True)),
        (False, (0.3, 0.0), (0.4, 0.0), (False, True)),  # half-spaces around the domain bound from above alone
        (None, (0.3, 0.0), (0.4, 0.0), (False, True)),
        (True, (0.3, 2.0), (0.4, 0.0), (False, True)),
        (True, (0.3, 0.0), (0.4, 2.0), (True, False)),
        (True, (0.3, 1.0), (0.4, 1.0), (True, True)),
        (True, (np.inf, 0.0), (np.inf, np.nan), (True, True)),  # no mechanism, and stresses for any load
        (True, (np.inf, 2.0), (np.inf, np.nan), (False, False)),
        (False, (np.inf, 0.0), (np.inf, np.nan), (False, False)),
        (True, (np.nan, np.nan), (0.4, 0.0), (False, True)),
        (False, (np.nan, np.nan), (-np.inf, 0.0), (True, True)),  # falls under the dead load: nothing is left to prove
        (True, (0.3, 0.0), (-np.inf, 2.0), (False, False)),
    ],
)
def test_which_bounds_stand(exact, static, kinematic, proven):
    """Residuals in units of the largest that is small."""
    domain = SimpleNamespace(domain=None if exact is None else SimpleNamespace(exact=exact))
    parts = [SimpleNamespace(multiplier=at, residual=share * CHECKED) for at, share in (static, kinematic)]
    found = StrengthComparison(("live",), domain, None, *parts)
    assert found.proven == proven
    assert found.bracket == pytest.approx((static[0], kinematic[0]), nan_ok=True)


def test_a_mechanism_under_the_constant_loads_is_found_where_it_leaves_the_programme_without_end() -> None:
    """A stack bond pushed sideways while its weight grows: the simplex method went round and round, for hours."""
    law = concio.JointLaw(0.6, normal_stiffness=1e7, tangential_stiffness=4e6)
    wall = concio.wall(
        length=2.0, height=2.0, block_size=(0.5, 0.25), bond="stack", thickness=0.3, friction=law, horizontal=0.05,
        block=concio.Elastic(5e6, 0.0, unit_weight=20.0), top_pressure=200.0,
    )  # fmt: skip
    found = concio.compare_with_continuum(wall, live="dead", elastic=False)
    assert found.strength is not None
    assert found.strength.kinematic.multiplier == -np.inf
    assert found.strength.proven == (True, True)
