"""Parts placed and merged, in the plane and in space, from Python and from files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

import concio
from concio import Body, Elastic, InputError, JointLaw, Load, Model, Rigid, Support, Tie

PIER = {"width": 0.8, "height": 2.0, "blocks": 4, "block": "rigid"}


def structure() -> Model:
    """A plane structure with everything in it that has to move along."""
    block = concio.Body("a", np.array([[0, 0], [2, 0], [2, 1], [0, 1]]), "rock", "rigid")
    other = concio.Body("b", np.array([[2, 0], [3, 0], [3, 2], [2, 2]]), "rock", "rigid")
    ground = concio.Body("ground", np.array([[0, -1], [3, -1], [3, 0], [0, 0]]), kind="fixed", role="ground")
    return Model(
        (ground, block, other), {"rock": Rigid(20.0)}, {"joint": JointLaw(0.6), "base": JointLaw(0.3)},
        rules=(concio.JointRule("joint"), concio.JointRule("base", ("ground", "*"))),
        supports=(Support("jack", "ground", displacement=(0.01, 0.02), rotation=0.03),
                  Support("roller", "b", ((3, 0), (3, 2)), directions="x")),
        loads=(Load("weight", (0, -1)), Load("point", (1.0, 2.0), ("b",), at=(3, 2), group="live"),
               Load("pressure", (5.0,), ("a",), edge=((0, 1), (2, 1)), group="top")),
        ties=(Tie("rod", "a", (0, 1), "b", (3, 2), 100.0),),
    )  # fmt: skip


def motion(d: int, at: tuple[float, ...], turn: float, axis: tuple[float, ...] = (0, 0, 1), mirror: str = ""):
    """What mirrors first, then turns, then moves points (n, d)."""
    Q = Rotation.from_rotvec(np.deg2rad(turn) * np.array(axis) / np.linalg.norm(axis)).as_matrix()[:d, :d]
    Q = Q @ np.diag([-1.0 if letter in mirror else 1.0 for letter in "xyz"[:d]])
    return lambda points: points @ Q.T + np.array(at)[:d]


def facts(model: Model, there: tuple[np.ndarray, np.ndarray] | None = None) -> dict[str, np.ndarray]:
    """Numbers that no motion of the whole may change; pairs in the order of the points they moved to."""
    assembly = concio.assemble(model)
    pairs = assembly.pairs
    order = np.arange(len(pairs))
    if there is not None:
        key = [np.column_stack([p, 100.0 * b]) for p, b in (there, (pairs.point, pairs.interface))]
        far, order = cKDTree(key[1]).query(key[0])
        assert far.max() < 1e-9
        assert len(np.unique(order)) == len(order) == len(pairs)
    d = model.dim
    groups = {g: f for g, f in assembly.loads.items() if g != "dead"}
    forces = [np.linalg.norm(f.reshape(-1, d * (d + 1) // 2)[:, :d], axis=1) for f in groups.values()]
    normal, _ = assembly.moved["settlement"]
    return {
        "areas": np.array([i.area if d == 3 else i.length for i in assembly.detection.interfaces]),
        "forces": np.concatenate(forces),
        "openings": normal[order],
        "laws": assembly.laws.friction[order],
    }


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize(("turn", "mirror"), [(0, ""), (90, ""), (180, "x"), (270, "y"), (90, "xy")])
def test_a_structure_moved_as_a_whole_is_the_same_structure(space: bool, turn: float, mirror: str) -> None:
    model = concio.extrude(structure(), 0.4) if space else structure()
    mirror = mirror.replace("y", "z") if space else mirror
    moved = concio.place(model, (1.0, -2.0, 3.0)[: model.dim], turn=turn, mirror=mirror, name="left")
    to = motion(model.dim, (1.0, -2.0, 3.0), turn, mirror=mirror)
    pairs = concio.assemble(model).pairs
    one, other = facts(model), facts(moved, (to(pairs.point), pairs.interface))
    for key, value in one.items():
        assert np.allclose(other[key], value, atol=1e-12), key
    assert [b.name for b in moved.bodies] == ["left-ground", "left-a", "left-b"]
    assert moved.ties[0].body_b == "left-b"
    assert moved.rules[1].between == ("left-ground", "*")
    assert moved.loads[0].value == model.loads[0].value  # gravity stays where it is


def test_any_rotation_in_space_where_nothing_is_held_in_part() -> None:
    from dataclasses import replace

    model = concio.extrude(structure(), 0.4)
    model = replace(model, supports=model.supports[:1])
    moved = concio.place(model, (1.0, -2.0, 3.0), turn=37.0, axis=(1, 2, -0.5), mirror="y")
    to = motion(3, (1.0, -2.0, 3.0), 37.0, (1, 2, -0.5), mirror="y")
    pairs = concio.assemble(model).pairs
    one, other = facts(model), facts(moved, (to(pairs.point), pairs.interface))
    for key, value in one.items():
        assert np.allclose(other[key], value, atol=1e-12), key
    assert sum(b.volume for b in moved.polyhedra) == pytest.approx(sum(b.volume for b in model.polyhedra))


def test_a_roller_cannot_stand_askew() -> None:
    with pytest.raises(InputError, match=r"holds 'x' alone, which is not a direction of the axes after turning"):
        concio.place(structure(), turn=30.0)


@pytest.mark.long
def test_an_elastic_vault_keeps_its_mesh_when_mirrored() -> None:
    dome = concio.dome(span=4, ring=0.4, courses=2, blocks=6, oculus=1.0)
    for model in (concio.place(dome, mirror="x"), concio.place(dome, turn=20, axis=(0, 1, 1))):
        assembly = concio.assemble(model)
        assert assembly.pairs.contact_model == concio.assemble(dome).pairs.contact_model


def bound(model: Model) -> float:
    """Return the largest multiplier of the live loads, friction taken as associated."""
    return concio.limit(model, path=False, steps=False, search=False).associated.multiplier


def arcade(space: bool) -> Model:
    parts = [concio.place(concio.column(**PIER), (3.8 * k, 0), name=f"pier{k}") for k in range(3)]
    ring = concio.arch(span=3.0, ring=0.4, voussoirs=9, block="rigid")
    parts += [concio.place(ring, (3.8 * k + 1.9, 2.0), name=f"arch{k}", without="abutment") for k in range(2)]
    return concio.merge(*((concio.extrude(p, 0.5) for p in parts) if space else parts), title="arcade")


@pytest.mark.parametrize("space", [False, True])
def test_an_arcade_of_arches_on_piers(space: bool) -> None:
    model = arcade(space)
    detection = concio.assemble(model).detection
    between = [
        (model.bodies[i.a].name, model.bodies[i.b].name, round(i.size, 9))
        for i in detection.interfaces
        if model.bodies[i.a].name.split("-")[0] != model.bodies[i.b].name.split("-")[0] and not i.gap.any()
    ]
    size = 0.5 if space else 0.4  # the longer side of a patch is the thickness
    assert sorted(tuple(sorted(names)) for *names, _ in between) == [
        ("arch0-v01", "pier0-b04"), ("arch0-v09", "pier1-b04"), ("arch1-v01", "pier1-b04"), ("arch1-v09", "pier2-b04"),
    ]  # fmt: skip
    assert {s for *_, s in between} == {size}
    assert model.loads == (Load("weight", (0.0, 0.0, -1.0) if space else (0.0, -1.0)),)
    assert len(model.rules) == 1


def test_parts_keep_their_own_laws_materials_and_loads() -> None:
    a = concio.place(concio.column(**PIER, friction=0.3), name="a")
    soft = {**PIER, "block": Elastic(2e6, 0.1, 18.0)}
    b = concio.place(concio.column(**soft, friction=0.5, top_pressure=3.0), (0.8, 0), name="b")
    model = concio.merge(a, b, joint=0.1)
    assert model.materials["block"] == Rigid(20.0)
    assert model.materials["block 2"] == Elastic(2e6, 0.1, 18.0)
    bodies = {x.name: x for x in model.bodies}
    for pair, law in ((("a-b01", "a-b02"), 0.3), (("b-b01", "b-b02"), 0.5), (("a-b01", "b-b01"), 0.1)):
        rule = model.rule_between(*(bodies[name] for name in pair))
        assert model.laws[rule.law].friction == law
    assembly = concio.assemble(model)
    assert assembly.loads["top"].sum() == pytest.approx(-3.0 * 0.8)
    assert -assembly.loads["dead"].sum() == pytest.approx(0.8 * 2 * (20 + 18))


def test_a_load_that_only_one_part_has_stays_with_it() -> None:
    a, b = concio.column(**PIER), concio.column(**PIER, horizontal=0.1)
    model = concio.merge(concio.place(a, name="a"), concio.place(b, (2, 0), name="b"))
    (live,) = (load for load in model.loads if load.group == "live")
    assert live.bodies == ("b-*",)
    assert concio.assemble(model).loads["live"].sum() == pytest.approx(0.1 * 0.8 * 2 * 20)


def test_what_cannot_be_merged_or_placed() -> None:
    pier = concio.column(**PIER)
    for words, build in (
        ("two bodies of the parts are called 'ground'", lambda: concio.merge(pier, pier)),
        ("part 1 is in the plane, part 2 is not", lambda: concio.merge(pier, concio.extrude(pier, 1.0))),
        ("part 1 has element = 'Q4', part 2 'Q8'", lambda: concio.merge(
            pier, concio.place(concio.column(**PIER, element="Q8"), name="b"))),
        ("blocks have no name in common", lambda: concio.merge(
            pier, concio.place(concio.column(**PIER, friction=0.1), (3, 0), name="b"))),
        ("there is nothing to merge", concio.merge),
        ("no body, role or layer 'abutmnt' to leave out", lambda: concio.place(
            concio.arch(span=3, ring=0.4, voussoirs=5), without="abutmnt")),
        (r"at = \[1, 2, 3\] must be 2 finite lengths", lambda: concio.place(pier, (1, 2, 3))),
        (r"at = \[1.0, inf\] must be 2 finite lengths", lambda: concio.place(pier, (1.0, float("inf")))),
        ("mirror = 'z' is not made of x, y", lambda: concio.place(pier, mirror="z")),
        ("a plane model turns in its plane", lambda: concio.place(pier, turn=3, axis=(0, 0, 1))),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            build()


FILE = """
title = "arcade"
[[parts]]
name = "pier"
repeat = 3
step = [3.8, 0]
[parts.column]
width = 0.8
height = "200 cm"
blocks = 4
block = "rigid"
[[parts]]
name = "arch"
file = "ring.toml"
at = [1.9, 2.0]
repeat = 2
step = [3.8, 0]
without = "abutment"
[[supports]]
name = "settling"
body = "pier1-ground"
displacement = [0, "-2 mm"]
"""


def test_the_arcade_from_a_file(tmp_path: Path) -> None:
    (tmp_path / "ring.toml").write_text('[arch]\nspan = 3.0\nring = 0.4\nvoussoirs = 9\nblock = "rigid"\n')
    (tmp_path / "arcade.toml").write_text(FILE)
    model = concio.load(tmp_path / "arcade.toml")
    wanted = arcade(space=False)
    assert len(model.bodies) == len(wanted.bodies)
    assert model.supports[0].displacement == (0.0, -0.002)
    for b, w in zip(model.bodies, wanted.bodies, strict=True):
        assert np.allclose(b.vertices, w.vertices)
    (tmp_path / "arcade.toml").write_text(FILE + "[extrusion]\nthickness = 0.5\n")
    solid = concio.load(tmp_path / "arcade.toml")
    assert solid.dim == 3
    assert len(concio.assemble(solid).detection.patches) == len(concio.assemble(wanted).detection.segments)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[parts]]\nname = 'a'\n", "a part is a file or one generator"),
        ("[[parts]]\nrepeat = 2\nstep = [1, 0]\nfile = 'ring.toml'\n", "the part has no name"),
        ("[[parts]]\nname = 'a'\nrepeat = 2\nfile = 'ring.toml'\n", "repeat = 2 needs a step"),
        ("[[parts]]\nname = 'a'\nfile = 'ring.toml'\nat = [1, 2, 3]\n", "at has 3 coordinates"),
        ("[[parts]]\nname = 'a'\nfile = 'none.toml'\n", r"\[\[parts\]\] 1 'a', .*none.toml: there is no such file"),
        ("[[parts]]\nname = 'a'\nfile = 'whole.toml'\n", "the file is a part of itself: whole.toml -> whole.toml"),
        ("[[parts]]\nname = 'a'\nfile = 'ring.toml'\nwithout = 'x'\n", "no body, role or layer 'x' to leave out"),
        ("[[parts]]\nname = 'a'\nfile = 'ring.toml'\n[arch]\nspan = 3\nring = 1\nvoussoirs = 4\n",
         r"more than one of \[arch\], \[\[parts\]\]"),
        ("[[parts]]\nnme = 'a'\nfile = 'ring.toml'\n", "unknown key 'nme' .did you mean 'name'"),
        ("[dome]\nspan = 4\nring = 0.4\ncourses = 2\nblocks = 6\n[extrusion]\nthickness = 1\n",
         r"\[extrusion\]: this is for models in the plane"),
    ],
)  # fmt: skip
def test_bad_parts_in_files(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "ring.toml").write_text('[arch]\nspan = 3.0\nring = 0.4\nvoussoirs = 9\nblock = "rigid"\n')
    (tmp_path / "whole.toml").write_text(text)
    with pytest.raises(InputError, match=words):
        concio.load(tmp_path / "whole.toml")


def test_holes_move_with_their_block() -> None:
    square, hole = np.array([[0, 0], [2, 0], [2, 2], [0, 2.0]]), np.array([[0.5, 0.5], [1, 0.5], [1, 1.0]])
    model = Model(
        (Body("b", square, kind="rigid", material="m", holes=(hole,)),), {"m": Rigid(20.0)}, {"joint": JointLaw(0.6)}
    )
    moved = concio.place(model, at=(3.0, 0.0), turn=90.0, mirror="x").outlines[0]
    assert moved.area == pytest.approx(model.outlines[0].area)
    assert sorted(map(tuple, moved.holes[0].tolist())) == [(2.0, -1.0), (2.5, -1.0), (2.5, -0.5)]


def leaning(seed: int) -> Model:
    """A leaning pillar on a floor under a push of a random kind, whose multiplier depends on the side it comes from."""
    rng = np.random.default_rng(seed)
    lean, height, push = rng.uniform(-0.15, 0.15), rng.uniform(1.0, 2.0), rng.uniform(-2.0, 2.0)
    floor = Body("floor", [(-3, -0.5), (3, -0.5), (3, 0), (-3, 0)], kind="fixed")
    pillar = Body("pillar", [(-0.2, 0), (0.2, 0), (0.2 + lean, height), (-0.2 + lean, height)], kind="rigid")
    kind = ("weight", "body", "point", "traction")[seed % 4]
    where = {
        "point": {"at": (lean, height)}, "traction": {"edge": ((-0.2 + lean, height), (0.2 + lean, height))},
    }.get(kind, {})  # fmt: skip
    value = (push, 0.0) if kind == "weight" else (10 * push, rng.uniform(-1, 1))
    live = Load(kind, value, bodies=("pillar",), group="live", **where)
    return Model(
        (floor, pillar), {"block": Rigid(20.0)}, {"joint": JointLaw(0.7)}, loads=(Load("weight", (0, -1)), live)
    )


@pytest.mark.parametrize("seed", range(8))
def test_what_is_mirrored_or_turned_in_plan_carries_as_much(seed: int) -> None:
    """Whatever pushes: a share of the weight, a body force, a force, a traction; gravity stays."""
    model = leaning(seed)
    wanted = bound(model)
    mirrored = concio.place(model, mirror="x")
    assert bound(mirrored) == pytest.approx(wanted, rel=1e-9)
    assert mirrored.loads[0].value == (0, -1)
    space = concio.extrude(model, 1.0)
    placed = concio.place(space, turn=40.0 + 50 * seed, mirror="xy"[: seed % 3])
    assert bound(placed) == pytest.approx(wanted, rel=1e-7)


def test_the_world_keeps_the_directions_of_forces_where_it_is_asked_to() -> None:
    model = leaning(0)
    turned = concio.place(concio.extrude(model, 1.0), turn=90)
    kept = concio.place(concio.extrude(model, 1.0), turn=90, loads="world")
    push = model.loads[1].value[0]
    assert turned.loads[1].value == pytest.approx((0.0, push, 0.0))
    assert kept.loads[1].value == pytest.approx((push, 0.0, 0.0))
    mixed = concio.place(Model(model.bodies, model.materials, model.laws, loads=(Load("weight", (0.1, -1.0)),)),
                         mirror="x")  # fmt: skip
    assert mixed.loads[0].value == pytest.approx((-0.1, -1.0))
    with pytest.raises(InputError, match="'ground' is not 'body' or 'world'"):
        concio.place(model, loads="ground")


def stacked(lower: float, upper: float, apart: float = 0.0) -> tuple[Model, Model]:
    floor = Body("floor", [(-3, -0.5), (3, -0.5), (3, 0), (-3, 0)], kind="fixed")
    low = Body("low", [(-0.5, 0), (0.5, 0), (0.5, 0.4), (-0.5, 0.4)], kind="rigid")
    up = Body("up", [(-0.5, 0.4 + apart), (0.5, 0.4 + apart), (0.5, 0.8 + apart), (-0.5, 0.8 + apart)], kind="rigid")
    loads = (Load("weight", (0, -1)), Load("weight", (1.0, 0.0), group="live"))
    stone = {"block": Rigid(20.0)}
    return (
        concio.place(Model((floor, low), stone, {"joint": JointLaw(lower)}, loads=loads), name="a"),
        concio.place(Model((up,), stone, {"joint": JointLaw(upper)}, loads=loads), name="b"),
    )


def test_the_order_of_parts_decides_no_law() -> None:
    """Parts that touch under two laws ask which holds between them; the answer then is one in any order."""
    parts = stacked(0.7, 0.2)
    for order in (parts, parts[::-1]):
        words = "'.-(low|up)' of part 1 and '.-(low|up)' of part 2 touch, and nothing says which law holds between them"
        with pytest.raises(InputError, match=words):
            concio.merge(*order)
        with pytest.raises(InputError, match=words):
            concio.merge(*(concio.extrude(p, 1.0) for p in order))
    for joint in (0.2, 0.7):
        found = [bound(concio.merge(*order, joint=joint)) for order in (parts, parts[::-1])]
        assert found == pytest.approx([joint, joint], rel=1e-9)
    assert len(concio.merge(*stacked(0.7, 0.2, apart=0.1)).bodies) == 3
    same = [concio.merge(*order) for order in (stacked(0.4, 0.4), stacked(0.4, 0.4)[::-1])]
    assert [bound(m) for m in same] == pytest.approx([0.4, 0.4])
