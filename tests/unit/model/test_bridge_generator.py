"""The generator of arch bridges: profiles, rings, headers, piers, backing, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

import concio
from concio.errors import InputError
from concio.model.generate.bridge_barrel import barrel_between
from concio.model.generate.profiles import profile_of

ARCHES = [
    ("segmental", 6.0, 1.5), ("semicircular", 6.0, 3.0), ("elliptical", 6.0, 2.0), ("three-centred", 6.0, 2.0),
    ("parabolic", 6.0, 2.0), ("pointed", 6.0, 4.0),
]  # fmt: skip


def made(**more: object) -> concio.Model:
    """Return a bridge of rigid blocks."""
    options: dict[str, object] = {"span": 6.0, "rise": 1.5, "ring": 0.4, "voussoirs": 20, "block": "rigid"}
    return concio.bridge(**(options | more))  # type: ignore[arg-type]


@pytest.mark.parametrize(("shape", "span", "rise"), ARCHES)
def test_profiles_spring_at_the_springings_and_rise_as_told(shape: str, span: float, rise: float) -> None:
    profile = profile_of("bridge", shape, span, rise)
    s = np.linspace(0.0, 1.0, 401)
    points, normals = profile.points(s), profile.normals(s)
    assert points[[0, -1]] == pytest.approx(np.array([[0.0, 0.0], [span, 0.0]]), abs=1e-9)
    assert points[200] == pytest.approx([span / 2, rise])
    steps = np.hypot(*np.diff(points, axis=0).T)
    assert steps == pytest.approx(np.full(400, steps.mean()), rel=2e-3)  # equal lengths
    along = np.diff(points, axis=0)
    smooth = np.abs((along * 0.5 * (normals[1:] + normals[:-1])).sum(1))
    assert smooth[np.abs(s[1:] - 0.5) > 0.01].max() < 1e-2 * steps.mean()
    assert np.hypot(*normals.T) == pytest.approx(np.ones(401))


@pytest.mark.parametrize(("shape", "span", "rise"), ARCHES)
def test_every_shape_makes_a_bridge_whose_joints_all_touch(shape: str, span: float, rise: float) -> None:
    model = made(shape=shape, span=span, rise=rise)
    assembly = concio.assemble(model)
    assert len(assembly.detection.interfaces) == 21
    assert not assembly.detection.near_misses


def test_voussoirs_of_a_segmental_arch_have_the_area_of_sectors() -> None:
    model = made()
    radius = (9 + 1.5**2) / 3.0
    half = 2 * math.atan2(1.5, 3.0)
    sector = ((radius + 0.4) ** 2 - radius**2) * half / 20
    assert [b.area for b in model.free_bodies] == pytest.approx([sector] * 20, rel=1e-5)  # type: ignore[union-attr]


def test_rings_touch_along_their_whole_length_and_have_a_law_of_their_own() -> None:
    model = made(ring=[0.2, 0.2, 0.2], voussoirs=20, ring_friction=0.3)
    assembly = concio.assemble(model)
    assert len(assembly.detection.interfaces) == 3 * 21 + 2 * 20
    between = assembly.pairs.law == list(model.laws).index("ring joint")
    assert between.sum() == 2 * 2 * 20
    assert assembly.laws.friction[between] == pytest.approx(np.full(80, 0.3))


def test_staggered_rings_and_rings_of_other_numbers_share_their_line() -> None:
    for model in (made(ring=[0.2, 0.2], staggered=True), made(ring=[0.2, 0.2], voussoirs=[20, 23])):
        detection = concio.assemble(model).detection
        assert not detection.overlaps
        assert not detection.near_misses
        faces = {frozenset((model.bodies[i.a].name[:2], model.bodies[i.b].name[:2])) for i in detection.interfaces}
        assert frozenset(("r1", "r2")) in faces


def test_headers_run_through_all_rings() -> None:
    model = made(ring=[0.2, 0.2], headers=5)
    headers = [b for b in model.bodies if b.layer == "header"]
    assert len(headers) == 4
    assert len(model.free_bodies) == 2 * 20 - 4
    assert all(b.area > 1.9 * model.body("r1-v01").area for b in headers)  # type: ignore[union-attr]


def test_spans_stand_on_piers_with_backing() -> None:
    model = made(span=[5.0, 6.0, 5.0], rise=[1.2, 1.5, 1.2], pier_width=1.2, pier_height=3.0, pier_courses=3,
                 backing=0.5, ring=0.4)  # fmt: skip
    names = [b.name for b in model.bodies]
    assert {"pier1-p01", "pier2-p03", "backing1", "backing2", "pier1 ground", "s3-v20"} <= set(names)
    assembly = concio.assemble(model)
    assert not assembly.detection.overlaps
    assert not assembly.detection.near_misses
    backing = next(b for b in model.bodies if b.name == "backing1")
    assert backing.vertices[:, 1].max() == pytest.approx(0.5)
    assert concio.solve(model).verdict.holds


def test_a_ring_that_grows_towards_its_springings() -> None:
    model = made(springing_ring=0.7)
    first = concio.assemble(model)
    assert first.pairs.point[:, 1].min() == pytest.approx(0.0)
    middle = model.body("v10").vertices
    assert np.ptp(middle[:, 1]) < 0.45
    joint = model.body("left abutment").vertices
    radius = (9 + 1.5**2) / 3.0
    assert np.hypot(*(joint - [3.0, 1.5 - radius]).T).max() >= radius + 0.7 - 1e-9


def test_lines_of_a_survey_make_a_ring() -> None:
    x = np.linspace(0.0, 3.0, 13)
    inner = [[float(a), float(0.75 - 0.75 * ((a - 1.5) / 1.5) ** 2)] for a in x]
    outer = [[float(1.5 + 1.1 * (a - 1.5)), b + 0.25] for a, b in inner]
    model = concio.bridge(intrados=inner, extrados=outer, voussoirs=12, block="rigid")
    assert len(model.free_bodies) == 12
    assert not concio.assemble(model).detection.near_misses


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"span": [6.0, 6.0], "pier_width": 0.3}, "overlap above pier 1"),
        ({"span": [6.0, 6.0]}, "pier_width is missing"),
        ({"ring": [0.2, 0.2], "voussoirs": [20, 20, 20]}, "would not meet"),
        ({"ring": [0.2, 0.2], "voussoirs": [20, 21], "headers": 4}, "joints in line"),
        ({"rise": 4.0}, "rises at most"),
        ({"rise": None}, "rise is missing"),
        ({"backing": 2.5}, "above the crown"),
        ({"span": [6.0, 6.0], "pier_width": 1.2, "backing": 0.02}, "does not reach above the arches on pier 1"),
        ({"ring": -0.2}, "must be positive"),
        ({"intrados": [[0, 0], [1, 1], [2, 0]], "span": None, "rise": None, "ring": None}, "belong together"),
        ({"intrados": [[0, 0], [1, 1], [2, 0]]}, "both given"),
        ({"span": None}, "span.*is missing"),
        ({"shape": "pointed", "rise": 2.0}, "rises more than"),
        ({"shape": "three-centred", "rise": 3.5}, "rises between"),
        ({"width": 2.0, "thickness": 2.0}, "they are one"),
        ({"span": 6000.0, "rise": 1500.0, "ring": 450.0}, "longer than any of masonry .*such as '6000 mm'"),
        ({"ring": 450.0}, "thicker than the span .*such as '450 mm'"),
        ({"ring": 35.0}, "thicker than the span .*such as '35 cm'"),
        ({"ring": [3.0, 3.5]}, "thicker than the span"),
        ({"intrados": [[0, 0], [3000, 1500], [6000, 0]], "extrados": [[-300, 300], [3000, 2000], [6300, 300]],
          "span": None, "rise": None, "ring": None}, "longer than any of masonry"),
        ({"voussoirs": 100_000}, "more than 1,000"),
    ],
)
def test_bad_bridges_are_refused(more: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        made(**more)


def test_the_table_of_a_file_takes_one_value_or_a_list() -> None:
    text = "[bridge]\nspan = [5.0, '600 cm']\nrise = [1.2, 1.5]\nring = ['215 mm', 0.215]\nvoussoirs = 18\n"
    model = concio.loads(text + "pier_width = 1.2\nblock = 'rigid'\n")
    assert len(model.free_bodies) == 2 * 2 * 18


def test_a_list_of_one_ring_is_that_ring() -> None:
    """A ring of blocks that laps no other follows its curve by two chords a stone, however it was written."""
    one, listed, text = made(ring=0.4), made(ring=[0.4]), made(ring="400 mm")
    for other in (listed, text):
        assert [len(b.outline) for b in other.bodies] == [len(b.outline) for b in one.bodies]
        for a, b in zip(one.bodies, other.bodies, strict=True):
            np.testing.assert_allclose(b.outline, a.outline, atol=1e-12)
    assert len(made(ring=[0.2, 0.2]).free_bodies[0].outline) == 4
    assert len(one.free_bodies[0].outline) == 6


@pytest.mark.parametrize("thickness", [0.0, 1e-8, -0.1])
def test_a_ring_without_thickness_to_speak_of_is_refused(thickness: float) -> None:
    low = [[1.0, 2.0], [3.0, 3.0], [5.0, 2.0]]
    high = [[x, y + thickness] for x, y in low]
    with pytest.raises(InputError, match="ring 1 has no thickness at x"):
        barrel_between("bridge", [low, high], 4, "")
    high = [[x, y + 0.3] for x, y in low]
    assert len(barrel_between("bridge", [low, high], 4, "").pieces) == 4
