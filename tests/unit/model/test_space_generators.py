"""Generators in space: counts and volumes in closed form, no gaps, no overlaps, bonds that lap."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import shapely

import concio
from commands import run
from concio import GeometryError, InputError, Model
from concio.contact.assembly import Assembly
from concio.model.generate import plan, plan_walls
from concio.model.generate.bonds import SHORTEST
from samples import first

RIGID = {"block": "rigid", "unit_weight": 1.0}
U = {"lines": [((0.5, 0), (0.5, 8)), ((0, 0.5), (5, 0.5)), ((0, 7.5), (5, 7.5))], "height": 10, "block_size": (2, 1, 1)}
ROOM = [((0, 0), (4, 0)), ((4, 0), (4, 3)), ((0, 3), (4, 3)), ((0, 0), (0, 3)), ((2, 0), (2, 3))]


def sound(model: Model) -> Assembly:
    """Assemble a model whose blocks must fit each other without a word to say."""
    assembly = concio.assemble(model)
    assert not assembly.detection.report()
    joined = np.zeros(len(model.bodies), dtype=int)
    for p in assembly.detection.patches:
        joined[[p.a, p.b]] += 1
    assert joined.min() >= 1
    return assembly


def volume(model: Model) -> float:
    return sum(b.volume for b in model.free_bodies)


def test_the_u_wall_of_the_benchmark() -> None:
    model = concio.walls(**U, **RIGID)
    assembly = sound(model)
    assert len(model.free_bodies) == 85
    assert len(assembly.detection.patches) == 227
    assert volume(model) == pytest.approx(160)
    even, odd = ([b for b in model.polyhedra if b.name.startswith(f"w1-c{c}")] for c in ("01", "02"))
    assert [b.vertices[:, 1].min() for b in even] == [0, 2, 4, 6]
    assert [b.vertices[:, 1].min() for b in odd] == [1, 3, 5]
    returns = [b.vertices[:, 0].min() for b in model.polyhedra if b.name.startswith("w2-c01")]
    assert returns == [1, 3]


def test_the_l_wall_of_the_benchmark() -> None:
    model = concio.walls(lines=[((0.5, 0), (0.5, 7)), ((0, 0.5), (7, 0.5))], height=10, block_size=(2, 1, 1), **RIGID)
    sound(model)
    assert volume(model) == pytest.approx(130)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_walls_of_any_size_have_the_same_corners(scale: float) -> None:
    """Two walls that end a block before the third meet nothing, in millimetres as in metres."""
    lines = np.array([[(0, 0), (4, 0)], [(1, 0.6), (1, 3)], [(3, 0), (3, 3)]])
    size = np.array([0.5, 0.25, 0.2])
    one = concio.walls(lines=lines.tolist(), height=1.0, block_size=size.tolist(), **RIGID)
    other = concio.walls(
        lines=(scale * lines).tolist(), height=scale, block_size=(scale * size).tolist(), **RIGID
    )  # fmt: skip
    assert [b.name for b in other.bodies] == [b.name for b in one.bodies]
    for a, b in zip(one.polyhedra, other.polyhedra, strict=True):
        np.testing.assert_allclose(b.vertices, scale * a.vertices, atol=1e-9 * scale)


WALLS: dict[str, tuple[dict[str, object], float, float]] = {
    "corner": ({"lines": ROOM[:2], "block_size": (0.5, 0.25, 0.2)}, 0.25, (4.125 + 2.875) * 0.25 * 2 + 0.25**2 * 2),
    "room with a cross wall": ({"lines": ROOM, "block_size": (0.5, 0.25, 0.2)}, 0.25, 0.0),
    "crossing": ({"lines": [((0, 0), (6, 0)), ((3, -3), (3, 4))], "block_size": (0.5, 0.25, 0.2)}, 0.25, 0.0),
    "english": ({"lines": ROOM, "block_size": (0.25, 0.125, 0.1), "bond": "english", "wythes": 2}, 0.25, 0.0),
    "flemish": ({"lines": ROOM, "block_size": (0.25, 0.125, 0.1), "bond": "flemish", "wythes": 2}, 0.25, 0.0),
    "three wythes": ({"lines": ROOM, "block_size": (0.25, 0.125, 0.1), "wythes": 3, "headers": 3}, 0.25, 0.0),
    "four wythes": ({"lines": ROOM[:1], "block_size": (0.25, 0.125, 0.1), "wythes": 4, "headers": 4}, 0.25, 0.0),
    "narrow blocks": ({"lines": ROOM, "block_size": (0.5, 0.15, 0.2)}, 0.2, 0.0),
}


def plan_area(options: dict[str, object]) -> float:
    """Area of the plan from the union of the footprints, each axis prolonged by half the thickness where it ends."""
    import shapely

    half = 0.5 * options["block_size"][1] * options.get("wythes", 1)  # type: ignore[index, operator]
    lines = [shapely.LineString(line) for line in options["lines"]]  # type: ignore[attr-defined]
    boxes = []
    for line in lines:
        met = [other for other in lines if other is not line]
        (x0, y0), (x1, y1) = line.coords
        d = np.array([x1 - x0, y1 - y0]) / line.length
        ends = [np.array([x0, y0]), np.array([x1, y1])]
        for k, sign in ((0, -1), (1, 1)):
            if any(shapely.Point(ends[k]).distance(other) < 1e-9 for other in met):
                ends[k] = ends[k] + sign * half * d
        boxes.append(shapely.LineString(ends).buffer(half, cap_style="flat"))
    return float(shapely.union_all(boxes).area)


@pytest.mark.long
@pytest.mark.parametrize("name", first(7, sorted(WALLS, key=lambda name: name == "three wythes")))
def test_bonds_fill_the_walls_and_lap(name: str) -> None:
    options, least, _ = WALLS[name]
    model = concio.walls(height=0.8, **options, **RIGID)  # type: ignore[arg-type]
    assembly = sound(model)
    assert volume(model) == pytest.approx(0.8 * plan_area(options), rel=1e-9)
    length = options["block_size"][0]  # type: ignore[index]
    laps = [
        float(np.ptp(p.polygon, axis=0)[:2].min())
        for p in assembly.detection.patches
        if abs(p.normal[2]) > 0.9 and model.bodies[p.a].kind != "fixed"
    ]
    assert min(laps) >= least * length - 1e-9
    sizes = np.array([np.sort(np.ptp(b.vertices, axis=0)[:2]) for b in model.polyhedra if b.kind != "fixed"])
    assert sizes[:, 1].min() >= SHORTEST * length - 1e-9


def test_stack_bond_does_not_lap() -> None:
    model = concio.walls(lines=[((0, 0), (3, 0))], height=1.0, block_size=(0.5, 0.25, 0.25), bond="stack", **RIGID)
    assert len(model.free_bodies) == 6 * 4
    assert len(sound(model).detection.patches) == 6 * 4 + 5 * 4


def test_openings_leave_their_holes_and_lintels() -> None:
    door = {"x": 1.5, "y": 0.0, "width": 1.0, "height": 2.0, "lintel": 0.2}
    window = {"x": 1.3, "y": 0.9, "width": 1.0, "height": 1.1}
    model = concio.walls(
        lines=[{"start": (0, 0), "end": (5, 0), "openings": [door]},
               {"start": (5, 4), "end": (5, 0), "openings": [window]}],
        height=3.0, block_size=(0.5, 0.25, 0.25), top_pressure=10.0, **RIGID,
    )  # fmt: skip
    assembly = concio.assemble(model)
    assert not assembly.detection.overlaps
    plan = (5.125 + 3.875) * 0.25
    assert volume(model) == pytest.approx(3 * plan - 0.25 * (1.0 * 2.0 + 1.0 * 1.1), rel=1e-9)
    (lintel,) = (b for b in model.polyhedra if b.role == "lintel")
    assert np.allclose(np.ptp(lintel.vertices, axis=0), (1.4, 0.25, 0.2))
    # the axis of the second wall runs from y = 4 to y = 0: its window starts 1.3 m from there
    hole = (5.0, 4 - 1.3 - 0.5, 0.9 + 0.5)
    inside = [b.name for b in model.polyhedra if ((b.normals @ np.array(hole) - b.offsets) < 0).all()]
    assert not inside
    assert assembly.loads["top"].reshape(-1, 6)[:, 2].sum() == pytest.approx(-10 * plan)


def test_grounds_of_their_own_meet_all_walls() -> None:
    model = concio.walls(lines=ROOM, height=0.4, block_size=(0.5, 0.25, 0.2), ground="each", **RIGID)
    assembly = sound(model)
    on_ground = sum(p.area for p in assembly.detection.patches if model.bodies[p.a].kind == "fixed")
    assert on_ground == pytest.approx(plan_area({"lines": ROOM, "block_size": (0.5, 0.25, 0.2)}))


def test_a_tower_is_four_bonded_walls() -> None:
    model = concio.tower(width=3.0, depth=3.6, height=3.0, **RIGID)
    sound(model)
    assert volume(model) == pytest.approx(3 * (3 * 3.6 - 2.4 * 3.0))
    at = np.concatenate([b.vertices for b in model.polyhedra if b.kind != "fixed"])
    assert np.allclose(at.min(0), (-1.5, -1.8, 0))
    assert np.allclose(at.max(0), (1.5, 1.8, 3))


def chord_area(r: float, t: float, n: int, angle: float = np.pi) -> float:
    """Area of a ring of n straight voussoirs over an angle."""
    return n * 0.5 * ((r + t) ** 2 - r**2) * float(np.sin(angle / n))


@pytest.mark.parametrize("bond", ["running", "stack"])
@pytest.mark.parametrize("skew", [0.0, 30.0, "-0.4 rad"])
def test_barrels(bond: str, skew: float | str) -> None:
    model = concio.barrel(span=4, ring=0.4, length=3, voussoirs=11, blocks=4, bond=bond, skew=skew, **RIGID)
    assembly = sound(model)
    assert volume(model) == pytest.approx(3 * chord_area(2, 0.4, 11), rel=1e-9)
    across = 10 * 7 + 2 * 4 if bond == "running" else 12 * 4
    within = 6 * 3 + 5 * 4 if bond == "running" else 11 * 3
    if bond == "running":
        across = 10 * 8 + 2 * 4
    assert len(assembly.detection.patches) == across + within


@pytest.mark.parametrize("bond", ["running", "stack"])
@pytest.mark.parametrize("oculus", first(1, [1.2, 0.0]))
@pytest.mark.parametrize("rise", [None, 2.0])
def test_domes(bond: str, oculus: float, rise: float | None) -> None:
    n, m = 5, 10
    model = concio.dome(span=8, ring=0.5, courses=n, blocks=m, bond=bond, oculus=oculus, rise=rise, **RIGID)
    assembly = sound(model)
    cells = m * (2 if bond == "running" else 1)
    rings = n if oculus else n + 1
    wanted = cells * rings + m * n  # between rings and to the springers, and within the rings
    assert len(assembly.detection.patches) == wanted
    r = 4.0 if rise is None else (16 + 4) / 4
    low = np.pi / 2 if rise is None else np.arcsin(4 / r)
    top = np.arcsin(0.5 * oculus / r)
    exact = 2 * np.pi / 3 * ((r + 0.5) ** 3 - r**3) * (np.cos(top) - np.cos(low))
    assert volume(model) == pytest.approx(exact, rel=0.09)
    if bond == "stack":  # chords three times shorter leave a ninth of the error
        fine = concio.dome(span=8, ring=0.5, courses=3 * n, blocks=3 * m, oculus=oculus, rise=rise, bond=bond, **RIGID)
        assert volume(fine) - exact == pytest.approx((volume(model) - exact) / 9, rel=0.1)


def test_a_dome_with_a_lantern_on_spreading_springers() -> None:
    model = concio.dome(span=8, ring=0.5, courses=4, blocks=8, oculus=2.0, lantern=30.0, spread="10 mm", **RIGID)
    assembly = sound(model)
    total = assembly.loads["lantern"].reshape(-1, 6)[:, :3].sum(0)
    assert np.allclose(total, (0, 0, -30), atol=1e-12)
    for support in model.supports:
        out = np.array(support.displacement)
        assert np.linalg.norm(out) == pytest.approx(0.01)
        middle = model.body(support.body).centroid * [1, 1, 0]
        assert out @ middle / np.linalg.norm(middle) == pytest.approx(0.01)


@pytest.mark.parametrize("groin", ["stone", "mitre"])
@pytest.mark.parametrize(("sides", "oculus", "rise"), first(2, [(4, 0.0, None), (6, 0.0, 1.2), (8, 1.0, None)]))
def test_cloister_vaults(groin: str, sides: int, oculus: float, rise: float | None) -> None:
    options = {"span": 5.0, "ring": 0.3, "courses": 6, "block_length": 0.7, "sides": sides, "oculus": oculus}
    model = concio.cloister_vault(**options, rise=rise, groin=groin, **RIGID)  # type: ignore[arg-type]
    sound(model)
    other = concio.cloister_vault(**options, rise=rise, groin="mitre", **RIGID)  # type: ignore[arg-type]
    assert volume(model) == pytest.approx(volume(other), rel=1e-12)
    if groin == "stone":
        rings = [b for b in model.polyhedra if not b.convex]
        assert len(rings) >= sides * 4


def test_the_volume_of_a_square_cloister_vault() -> None:
    """Each web between two groins: the moment of its section about the middle, 8 times int x dA."""
    model = concio.cloister_vault(span=5.0, ring=0.3, courses=60, block_length=1.0, **RIGID)
    r, q = 2.5, 2.8
    assert volume(model) == pytest.approx(8 * (q**3 - r**3) / 3, rel=2e-3)


@pytest.mark.parametrize("groin", ["stone", "mitre"])
def test_cross_vaults(groin: str) -> None:
    model = concio.cross_vault(span=5.0, ring=0.3, courses=7, block_length=0.7, groin=groin, **RIGID)
    assembly = sound(model)
    # four equal quarters: the vault turned by a right angle is itself
    c = np.array([b.centroid for b in model.free_bodies])
    turned = c[:, [1, 0, 2]] * [-1, 1, 1]
    apart = np.linalg.norm(turned[:, None] - c, axis=2).min(1)
    assert apart.max() < 1e-9
    springers = {p.a for p in assembly.detection.patches if model.bodies[p.a].kind == "fixed"}
    assert len(springers) == 4


@pytest.mark.parametrize("ring", first(2, [0.07, 0.0855, 0.08, 0.0850]))
def test_springers_of_a_cross_vault_have_room_down_to_the_least_angle(ring: float) -> None:
    model = concio.cross_vault(span=1.0, ring=ring, courses=5, block_length=0.15, springing=40, **RIGID)
    assert min(b.volume for b in model.bodies if b.kind == "fixed") > 0
    sound(model)


def test_drums_and_their_taper() -> None:
    model = concio.drums(diameter=1.0, height=6, drums=5, sides=12, top_diameter=0.8, top_force=3.0,
                         eccentricity=(0.1, 0.2), **RIGID)  # fmt: skip
    assembly = sound(model)
    area = 0.5 * 12 * np.sin(2 * np.pi / 12) * 0.25  # of the unit circle's twelve-gon, diameter one
    assert volume(model) == pytest.approx(6 * area * (1 + 0.8 + 0.64) / 3, rel=1e-12)
    f = assembly.loads["top"].reshape(-1, 6)[-1]
    reach = assembly.disc.reach[-1]
    assert np.allclose(f[:3], (0, 0, -3))
    assert np.allclose(f[3:] * reach, (-0.6, 0.3, 0), atol=1e-12)


BAYS = [{}, {"shape": "segmental", "rise": 0.9, "fill": 0.4}, {"shape": "pointed", "fill": 0.3}, {"spandrels": False}]


@pytest.mark.parametrize("options", BAYS)
def test_an_arch_on_piers_in_plane_and_space(options: dict[str, object]) -> None:
    make: Callable[..., Model] = concio.arch_on_piers
    pier = {"pier_width": 1, "pier_height": 2.4, "pier_courses": 8}
    plane = make(span=3, ring=0.35, voussoirs=13, block="rigid", **pier, **options)
    space = concio.extrude(plane, 0.8)
    flat, solid = concio.assemble(plane).detection, concio.assemble(space).detection
    assert not flat.overlaps
    assert [(i.a, i.b) for i in flat.segments] == [(p.a, p.b) for p in solid.patches]
    names = {b.name: k for k, b in enumerate(plane.bodies)}
    pairs = {(i.a, i.b) for i in flat.segments} | {(i.b, i.a) for i in flat.segments}
    assert (names["v01"], names["left-p08"]) in pairs
    assert (names["v13"], names["right-p08"]) in pairs


@pytest.mark.parametrize("options", [{}, {"shape": "pointed", "fill": 0.3}, {"fill": 0.5, "block_length": 0.4}])
def test_spandrels_are_cut_into_blocks_of_the_length_asked_for(options: dict[str, object]) -> None:
    """From the outer face: none is longer, at its narrower edge, than by what is too short for a block of its own."""
    make: Callable[..., Model] = concio.arch_on_piers
    model = make(
        span=3, ring=0.35, voussoirs=13, block="rigid", pier_width=1, pier_height=2.4, pier_courses=8, **options
    )
    long = float(str(options.get("block_length", 0.6)))
    shapes = [shapely.Polygon(b.vertices) for b in model.free_bodies if b.layer == "spandrel"]
    assert len(shapes) > 8
    for shape in shapes:
        _, low, _, high = shape.bounds
        levels = low + np.array([0.02, 0.98]) * (high - low)
        edges = [shape.intersection(shapely.LineString([(-9, y), (9, y)])).length for y in levels]
        assert min(edges) <= 1.4 * long * (1 + 1e-9)


def test_horizontal_shares_have_a_direction() -> None:
    model = concio.drums(diameter=1, height=2, drums=2, horizontal=0.2, towards=(3, 4), **RIGID)
    f = concio.assemble(model).loads["live"].reshape(-1, 6)[:, :3].sum(0)
    assert np.allclose(f, 0.2 * volume(model) * np.array([0.6, 0.8, 0]))


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: concio.walls(lines=[((0, 0), (4, 1))], height=1), "a wall is longer than thick, along x or y"),
        (lambda: concio.walls(lines=[], height=1), "there are no walls"),
        (lambda: concio.walls(lines=ROOM), "height is missing"),
        (lambda: concio.walls(lines=ROOM, height=1, bond="english"), "english bond has two wythes, not 1"),
        (lambda: concio.walls(lines=ROOM, height=1, wythes=2, headers=3, block_size=(0.3, 0.1, 0.1)),
         "headers of blocks 0.3 m long do not fill two wythes"),
        (lambda: concio.walls(lines=ROOM, height=1, block_size=(0.3, 0.1)), "must be three lengths"),
        (lambda: concio.walls(lines=[{"start": (0, 0), "ende": (1, 0)}], height=1), "key 'ende' .did you mean 'end'"),
        (lambda: concio.walls(height=2, lines=[{"start": (0, 0), "end": (4, 0), "openings": [
            {"x": 1.5, "y": 0, "width": 0.5, "height": 1}]}, ((2, 0), (2, 3))]), "reaches into its corner with wall 2"),
        (lambda: concio.walls(lines=ROOM, height=1000, block_size=(0.01, 0.01, 0.01)), "blocks are more than 500,000"),
        (lambda: concio.tower(width=0.5, depth=3, height=3), "has no room inside"),
        (lambda: concio.barrel(span=4, ring=0.4, length=3, voussoirs=11, skew=80), "must lie between -75 and 75"),
        (lambda: concio.dome(span=8, ring=0.5, courses=3, blocks=8, rise=5), "rises at most 4 m"),
        (lambda: concio.dome(span=8, ring=0.5, courses=3, blocks=8, lantern=3.0), "a lantern stands on an oculus"),
        (lambda: concio.dome(span=8, ring=0.5, courses=3, blocks=8, ocullus=1), "did you mean 'oculus'"),
        (lambda: concio.cross_vault(span=5, ring=0.3, courses=7, block_length=0.7, springing=5), "springing = 5"),
        (lambda: concio.drums(diameter=1, height=2, drums=2, eccentricity=(1, 0)), "lies outside the head"),
        (lambda: concio.drums(diameter=1, height=2, drums=2, towards=(0, 0)), "is not a direction"),
        (lambda: concio.arch_on_piers(span=3, ring=1.2, voussoirs=9, pier_width=1, pier_height=2, pier_courses=4),
         "thicker at its springing than the pier"),
    ],
)  # fmt: skip
def test_what_generators_in_space_refuse(build: Callable[[], Model], words: str) -> None:
    with pytest.raises((InputError, GeometryError), match=words):
        build()


LARGE = ("walls", "tower", "barrel", "dome", "cloister_vault", "cross_vault")
SMALL = ("drums", "arch_on_piers", "arcade", "blocks_in_space")
KINDS = (*(pytest.param(kind, marks=pytest.mark.long) for kind in LARGE), *SMALL)


@pytest.mark.parametrize("kind", first(9, KINDS))
def test_a_new_file_of_each_is_read_and_checked(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"{kind}.toml"
    assert run("new", kind, path)[0] == 0
    picture = tmp_path / "picture.png"
    code, told, _ = run("check", path, "--out", picture)
    assert code == 0
    assert "no overlaps" in told or "near miss" in told
    assert picture.stat().st_size > 10_000
    model = concio.load(path)
    again = concio.loads(concio.dumps(model))
    assert [b.name for b in again.bodies] == [b.name for b in model.bodies]
    for b, c in zip(model.bodies, again.bodies, strict=True):
        assert np.array_equal(b.vertices, c.vertices)
        assert b.kind == c.kind
    assert again.loads == model.loads
    assert again.supports == model.supports
    assert files("concio.model").joinpath("templates", f"{kind}.toml").is_file()


@pytest.mark.parametrize("length", [0.25, 1.0, 8.0])
def test_courses_begin_with_whole_blocks_on_the_ground_and_lap_the_one_below(length: float) -> None:
    """Ends of a course are no joints to lap: a wall of 5 1/4 blocks begins with whole ones."""
    bricks = plan_walls._Bricks(length, 0.5 * length, 0.25 * length, 1, "running", 0)
    ends = length * np.array([0.0, 5.25])
    first = plan_walls._set_out(*ends, bricks, *bricks.unit(0), ends)
    assert first == pytest.approx(length * np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.25]))
    second = plan_walls._set_out(*ends, bricks, *bricks.unit(1), first)
    assert second == pytest.approx(length * np.array([0.0, 0.5, 1.5, 2.5, 3.5, 4.5, 5.25]))


@pytest.mark.parametrize(("axis", "at_the_end"), [(0, False), (0, True), (1, False), (1, True)])
def test_a_wall_that_ends_on_another_butts_against_it_whichever_is_drawn_first(axis: int, at_the_end: bool) -> None:
    """A cross-wall that ends on a long one, from the left or from the right, gives way to it; at a corner none does."""
    half, across = 0.125, 3.0
    reach = (across - 2.0, across + half) if at_the_end else (across - half, across + 2.0)
    long = plan.PlanWall(1 - axis, 0.0, 6.0, across, 2.0)
    short = plan.PlanWall(axis, *reach, 2.5, 2.0)
    assert plan.junctions([long, short], half) == [plan.Junction(0, 1)]
    assert plan.junctions([short, long], half) == [plan.Junction(1, 0)]
    for along in (half, 6.0 - half):
        corner = plan.PlanWall(axis, *reach, along, 2.0)
        assert plan.junctions([corner, long], half) == [plan.Junction(0, 1)]


@pytest.mark.parametrize("far", [0.0, 1e6, -1e6])
def test_walls_far_from_the_origin_are_not_more_blocks(far: float) -> None:
    """Coordinates of a survey are large: blocks are counted by lengths."""
    lines = [((far, far), (far + 2.0, far)), ((far, far), (far, far + 2.0))]
    near = concio.walls(lines=[((0, 0), (2, 0)), ((0, 0), (0, 2))], height=0.5, block_size=(0.5, 0.25, 0.25), **RIGID)
    assert len(concio.walls(lines=lines, height=0.5, block_size=(0.5, 0.25, 0.25), **RIGID).bodies) == len(near.bodies)
