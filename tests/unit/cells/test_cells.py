"""Periodic cells as models: what the generator makes, which joints wrap round, what files hold and what is refused."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.contact.detection import detect
from concio.contact.macroscopic_strain import STRAINS
from concio.errors import GeometryError, InputError
from concio.model.generate.periodic_rubble import _contracted
from concio.model.interfaces.detect import detect_interfaces
from concio.model.model import Body, Model

MORTAR = concio.Elastic(E=1e6, nu=0.2)
CELLS = {
    "running": {},
    "running, third of a block": {"lap": 1 / 3},
    "stack": {"bond": "stack"},
    "stack of two": {"bond": "stack", "head": 0.3},
    "english": {"bond": "english"},
    "flemish": {"bond": "flemish", "repeat": (2, 1)},
    "own courses": {"bond": [[1.0], [0.75], [0.5, 1.0]]},
    "with mortar": {"joint": 0.01, "mortar": MORTAR},
    "flemish with mortar": {"bond": "flemish", "joint": 0.01, "mortar": MORTAR},
    "rubble": {"bond": "rubble", "length": 1.6, "height": 1.1, "stone": 0.3, "seed": 4},
    "rubble of two stones": {"bond": "rubble", "length": 0.6, "height": 0.3, "stone": 0.3, "shortest_edge": 0.0},
}


def tiled(model: Model, count: int = 2) -> list[Body]:
    """Return the bodies of a cell and of its neighbours as bodies of their own, cell after cell."""
    p = np.asarray(model.periods)
    cells = sorted(
        ((i, j) for i in range(-count, count + 1) for j in range(-count, count + 1)), key=lambda c: (c != (0, 0), c)
    )
    return [replace(b, name=f"{b.name} {c}", outline=b.outline + np.array(c) @ p, grid=None)
            for c in cells for b in model.bodies]  # fmt: skip


@pytest.mark.parametrize("name", CELLS)
def test_cells_fill_the_plane_and_meet_all_around_as_in_a_tiled_wall(name: str) -> None:
    model = concio.cell(**CELLS[name])
    found = detect(model)
    assert not found.overlaps
    assert not found.near_misses
    area = abs(np.linalg.det(np.asarray(model.periods)))
    assert sum(b.area for b in model.bodies) == pytest.approx(area, rel=1e-12)
    # the same joints in a piece of wall: all those within the middle cell once, all others twice, from either side
    number = len(model.bodies)
    wall = detect_interfaces(tiled(model), tolerance=1e-6)
    assert not wall.overlaps
    lengths: Counter[tuple[int, int]] = Counter()
    for face in wall.interfaces:
        if face.a < number:
            a, b = face.a, face.b % number
            weight = 1.0 if face.b < number else 0.5
            lengths[min(a, b), max(a, b)] += weight * face.length
    own: Counter[tuple[int, int]] = Counter()
    for face in found.interfaces:
        own[min(face.a, face.b), max(face.a, face.b)] += face.length
    assert set(own) == set(lengths)
    assert np.allclose([own[k] for k in own], [lengths[k] for k in own], rtol=1e-9)


def test_a_block_meets_its_own_image() -> None:
    """A stack of one block: its head joint and its bed joint are with itself."""
    found = detect(concio.cell(bond="stack", block_size=(0.3, 0.1)))
    assert [(f.a, f.b, f.shift) for f in found.interfaces] == [(0, 0, (0.3, 0.0)), (0, 0, (0.0, 0.1))]
    assert [f.normal.tolist() for f in found.interfaces] == [[1.0, 0.0], [0.0, 1.0]]


def test_an_affine_motion_opens_joints_by_the_strain_between_the_bodies_centres() -> None:
    """Rigid bodies that all move as the strain moves their centroids: E (x_b + s - x_a) whatever stands where."""
    model = concio.cell(bond="flemish", block="rigid", block_size=(0.3, 0.1))
    assembly = concio.assemble(model)
    disc, pairs = assembly.disc, assembly.pairs
    E = np.array([[1.0, 0.25], [0.25, -2.0]])
    u = np.zeros((len(model.bodies), 3))
    u[:, :2] = disc.centroids @ E.T
    shift = np.array([f.shift for f in assembly.detection.interfaces])[pairs.interface]
    apart = (disc.centroids[pairs.body_b] + shift - disc.centroids[pairs.body_a]) @ E.T
    values = np.array([1.0, -2.0, 0.5])
    normal, tangential = (
        sum(v * assembly.moved[name][k] for v, name in zip(values, STRAINS, strict=True)) for k in (0, 1)
    )
    assert np.allclose(pairs.C_n @ u.ravel() + normal, (apart * pairs.normal).sum(1), atol=1e-14)
    assert np.allclose(pairs.C_t @ u.ravel() + tangential[:, 0], (apart * pairs.tangent).sum(1), atol=1e-14)


def test_strains_have_the_factor_zero_where_none_is_given() -> None:
    assembly = concio.assemble(concio.cell())
    assert assembly.groups == STRAINS
    assert not assembly.problem().gap.any()
    assert assembly.problem({"strain xx": 1e-3}).gap.max() == pytest.approx(0.25e-3)


def test_files_hold_cells() -> None:
    text = """
        [cell]
        bond = "flemish"
        block_size = ["25 cm", 0.12]
        joint = "10 mm"
        mortar.E = "2 GPa"
        repeat = [2, 1]
    """
    model = concio.loads(text)
    again = concio.loads(concio.dumps(model))
    assert again.periods == model.periods == ((0.78, 0.0), (0.0, pytest.approx(0.26)))
    assert [b.outline.tolist() for b in again.bodies] == [b.outline.tolist() for b in model.bodies]
    own = concio.loads("""
        periods = [[0.3, 0], [0.1, 0.1]]
        [[blocks]]
        name = "b"
        rectangle = [[0, 0], [0.3, 0.1]]
        [materials.block]
        E = 1e6
        [joints.joint]
        friction = 0.6
    """)
    joints = sorted((round(f.shift[0], 9), f.shift[1], round(f.length, 9)) for f in detect(own).interfaces)
    assert joints == [(-0.2, 0.1, 0.1), (0.1, 0.1, 0.2), (0.3, 0.0, 0.1)]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"bond": "herringbone"}, "not known"),
        ({"repeat": (0, 1)}, "at least 1"),
        ({"repeat": (1000, 1000)}, "100,000"),
        ({"joint": 0.01}, "mortar"),
        ({"mortar": MORTAR}, "thickness"),
        ({"joint": -0.01, "mortar": MORTAR}, "zero or positive"),
        ({"head": 0.3, "joint": 0.01, "mortar": MORTAR}, "head"),
        ({"length": 1.0}, "rubble"),
        ({"bond": "rubble", "length": 1.0, "height": 1.0}, "stone"),
        ({"bond": "rubble", "length": 1.0, "height": 1.0, "stone": 5.0}, "holds 0"),
        ({"bond": "rubble", "length": 1.0, "height": 1.0, "stone": 0.3, "joint": 0.01, "mortar": MORTAR}, "thickness"),
        ({"horizontal": 0.1}, "horizontal"),
        ({"base_friction": 0.3}, "base"),
        ({"bond": [[1.0], [0.7], [0.313]]}, "no common multiple"),
        ({"stones": 4}, "no argument 'stones'"),
    ],
)
def test_what_is_no_cell_is_refused(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        concio.cell(**arguments)


def test_a_cell_is_held_by_its_neighbours_alone() -> None:
    model = concio.cell()
    for change, words in (
        ({"loads": (concio.Load("weight", (0.0, -1.0)),)}, "loads"),
        ({"supports": (concio.Support("s", "c01-b01"),)}, "supports"),
        ({"periods": ((1.0, 0.0), (2.0, 0.0))}, "parallel"),
        ({"periods": ((1.0, 0.0), (0.0, np.nan))}, "two vectors"),
        ({"bodies": (*model.bodies, Body("g", [[0, -1], [1, -1], [1, -0.5]], kind="fixed"))}, "fixed body"),
        ({"bodies": (model.bodies[0], replace(model.bodies[1], thickness=0.3))}, "thicknesses"),
    ):
        with pytest.raises(InputError, match=words):
            replace(model, **change)
    small = replace(model, periods=((0.2, 0.0), (0.0, 0.25)))
    with pytest.raises(GeometryError, match=r"cell at \(\+1, \+0\).* overlap"):
        concio.assemble(small)


@pytest.mark.parametrize("numbers", [(3, 1, 0, 2), (3, 0, 1, 2)])
@pytest.mark.parametrize("shift", [(0, 0), (1, 0), (0, 1), (-2, 3)])
def test_short_edges_are_contracted_alike_wherever_a_stone_is_told(
    shift: tuple[int, int], numbers: tuple[int, ...]
) -> None:
    """Stones of a periodic rubble may be told some periods away: each edge has one length, and the cell one picture."""
    period = np.array([3.0, 2.0])
    xy = np.zeros((4, 2))
    xy[list(numbers)] = [[0.0, 0.0], [1.5, 0.0], [1.5, 0.07], [0.0, 1.0]]
    ring = [(v, *shift) for v in numbers]
    (found,) = _contracted(xy, [ring], 0.2, period)
    np.testing.assert_allclose(found - np.array(shift) * period, [[0.0, 0.0], [1.5, 0.035], [0.0, 1.0]], atol=1e-12)
