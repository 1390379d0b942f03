"""Blocks from pictures: walls that were drawn are found again, boundaries are shared, corrections hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

import concio
from concio.errors import InputError
from concio.model.picture.photo import homography
from concio.model.picture.shared_boundaries import shared_outlines
from concio.trace import Photo, read_photo, trace_courses, trace_labels, trace_outlines, trace_regions, wire
from rendered import BEDS, HEADS, bricks, found_share, read_bricks, rendered, sideways
from samples import first, sample

WALL = {"block_size": (0.25, 0.125), "length": 1.0, "height": 0.625, "block": "rigid", "unit_weight": 20.0}


@pytest.fixture(scope="module")
def wall() -> concio.Model:
    return concio.wall(**WALL)


@pytest.mark.parametrize(("contrast", "light"), [(0.25, False), (0.08, True), (0.05, False)])
def test_courses_of_a_wall_are_found_again_and_its_multiplier(wall: concio.Model, contrast: float, light: bool) -> None:
    found = trace_courses(rendered(wall, contrast=contrast, seed=5, light=light), (0.28, 0.11))
    assert found_share(found, wall) >= 0.93
    assert sideways(found.model()) == pytest.approx(sideways(wall), rel=0.05)
    assert 0.005 < found.joint_width < 0.02
    strengths = [joint.strength for joint in found.joints]
    assert strengths == sorted(strengths), "the most doubtful first"
    assert sum(joint.kind == "bed" for joint in found.joints) == 4


def test_a_head_joint_that_only_noise_has_drawn_is_the_most_doubtful() -> None:
    """In the lowest course noise draws a joint 0.1 m from the edge; the other courses of its kind have none there."""
    long = concio.wall(block_size=(0.40, 0.20), length=2.4, height=1.4, block="rigid", unit_weight=20.0)
    found = trace_courses(rendered(long, contrast=0.05, seed=33, light=True), (0.44, 0.18))
    assert len(found.outlines()) == len(long.free_bodies) + 1
    first, second = found.joints[:2]
    assert (first.kind, first.ends[0][0]) == ("head", pytest.approx(2.3, abs=0.01))
    assert first.strength < 0.7 * second.strength


@pytest.mark.parametrize("unit", first(1, [(0.20, 0.075), (0.25, 0.08), (0.22, 0.065)], single=True))
def test_the_bricks_of_a_photograph_are_found_and_no_joint_is_invented(unit: tuple[float, float]) -> None:
    """Stretchers and headers stand in no regular order: other courses say nothing of where a course has its joints."""
    found = trace_courses(bricks(), unit)
    beds = sorted(j.ends[0][1] for j in found.joints if j.kind == "bed")
    assert beds == pytest.approx(BEDS, abs=0.004)
    for low, expected in zip((0.0, *beds), HEADS, strict=True):
        heads = [j.ends[0][0] for j in found.joints if j.kind == "head" and min(e[1] for e in j.ends) == low]
        assert sorted(heads) == pytest.approx(expected, abs=0.01)
    assert found.joint_width == pytest.approx(0.010, abs=0.002)
    assert sideways(found.model()) == pytest.approx(sideways(read_bricks()), rel=0.05)


def test_a_joint_that_was_painted_over_is_the_most_doubtful_or_missed_beside_it(wall: concio.Model) -> None:
    photo = rendered(wall, contrast=0.25, seed=1)
    grey = photo.grey.copy()
    column = round(0.5 / photo.pixel)
    row = round((0.625 - 0.0625) / photo.pixel)
    grey[row - 10 : row + 10, column - 4 : column + 4] = np.median(grey)
    found = trace_courses(Photo(grey, photo.pixel), (0.25, 0.125))
    assert len(found.outlines()) == len(wall.free_bodies)
    middle = np.mean(found.joints[0].ends, axis=0)
    assert middle == pytest.approx([0.5, 0.0625], abs=0.02)


@pytest.mark.parametrize("seed", [2, 12, 22])
def test_between_clear_joints_no_joint_is_missed_though_a_stone_may_be_split(wall: concio.Model, seed: int) -> None:
    found = trace_regions(rendered(wall, contrast=0.25, seed=seed), 0.177, joint=0.01)
    true = [shapely.Polygon(b.outline) for b in wall.free_bodies]
    for ring in found.outlines().values():
        own = shapely.Polygon(ring)
        assert sum(own.intersection(t).area > 0.2 * own.area for t in true) == 1
    assert found_share(found, wall) > 0.8


def test_outlines_between_clicks_follow_the_joint(wall: concio.Model) -> None:
    photo = rendered(wall, contrast=0.2, seed=3)
    stones = [b.outline for b in wall.free_bodies[:3]]
    clicks = [[*s, *(0.5 * (s + np.roll(s, -1, axis=0)))] for s in stones]
    ordered = [[np.asarray(p).tolist() for k in range(4) for p in (c[k], c[4 + k])] for c in clicks]
    found = trace_outlines(photo, ordered, joint=0.01).outlines()
    for k, stone in enumerate(stones, 1):
        own, true = shapely.Polygon(found[k]), shapely.Polygon(stone)
        assert own.intersection(true).area / own.union(true).area > 0.85


def test_a_wire_runs_along_the_joint_and_not_straight() -> None:
    grey = np.full((60, 100), 0.8)
    rows = (30 + 12 * np.sin(np.linspace(0.0, np.pi, 100))).astype(int)
    for c, r in enumerate(rows):
        grey[r - 1 : r + 2, c] = 0.3
    photo = Photo(grey, 0.01)
    ends = photo.metres(np.array([[0.5, rows[0] + 0.5], [99.5, rows[-1] + 0.5]]))
    path = photo.pixels(wire(photo, ends[0], ends[1], joint=0.03))
    away = np.abs(path[:, 1] - 0.5 - np.interp(path[:, 0], np.arange(100) + 0.5, rows))
    assert away.max() < 2.5


blobs = st.integers(1, 4).flatmap(
    lambda n: st.lists(st.lists(st.integers(0, n), min_size=7, max_size=7), min_size=6, max_size=6)
)


@settings(max_examples=sample(40, 200), deadline=None)
@given(blobs)
def test_unsimplified_outlines_enclose_the_pixels_of_their_regions(rows: list[list[int]]) -> None:
    labels = np.array(rows)
    for label, ring in shared_outlines(labels, 0.0).items():
        inside = shapely.Polygon(ring)
        x, y = np.meshgrid(np.arange(7) + 0.5, np.arange(6) + 0.5)
        assert inside.area >= 1.0
        covered = shapely.contains_xy(shapely.make_valid(inside), x, y)
        assert (covered & (labels == label)).any()
        assert ring.min() >= 0.0


def test_neighbours_share_every_point_of_their_boundary_whatever_the_tolerance() -> None:
    x, y = np.meshgrid(np.linspace(0, 6, 120), np.linspace(0, 4, 80))
    labels = (1 + (y > 2 + 0.4 * np.sin(2 * x)) + 2 * (x > 3 + 0.3 * np.sin(3 * y))).astype(int)
    for tolerance in (0.0, 1.0, 4.0):
        rings = [shapely.Polygon(r) for r in shared_outlines(labels, tolerance).values()]
        assert len(rings) == 4
        assert sum(r.area for r in rings) == pytest.approx(120 * 80)
        assert shapely.union_all(rings).area == pytest.approx(120 * 80)


def test_blocks_are_split_merged_and_counted(wall: concio.Model) -> None:
    found = trace_courses(rendered(wall, contrast=0.2, seed=4), (0.25, 0.125))
    before = found.outlines()
    a, b = 1, 2
    one = found.merged(a, b).outlines()
    assert len(one) == len(before) - 1
    assert shapely.Polygon(one[a]).area == pytest.approx(sum(shapely.Polygon(before[k]).area for k in (a, b)), rel=0.02)
    (x0, y0), (x1, y1) = before[a].min(0), before[a].max(0)
    two = found.split(a, [(0.5 * (x0 + x1), y0 - 0.01), (0.5 * (x0 + x1), y1 + 0.01)])
    assert len(two.outlines()) == len(before) + 1
    with pytest.raises(InputError, match="do not touch"):
        found.merged(1, max(before))
    with pytest.raises(InputError, match="does not cut"):
        found.split(1, [(-1.0, -1.0), (-0.5, -1.0)])
    with pytest.raises(InputError, match="there is no block 99"):
        found.merged(99, 1)


def test_a_picture_that_was_taken_askew_is_rectified(wall: concio.Model) -> None:
    straight = rendered(wall, contrast=0.25, seed=6)
    rows, columns = straight.grey.shape
    quad = np.array([[40.0, rows + 60.0], [columns + 10.0, rows + 20.0], [columns + 40.0, 30.0], [15.0, 10.0]])
    flat = np.array([[0, rows], [columns, rows], [columns, 0], [0, 0]], dtype=float)
    back = homography(quad, flat)
    x, y = np.meshgrid(np.arange(columns + 60) + 0.5, np.arange(rows + 80) + 0.5)
    at = back @ np.stack([x.ravel(), y.ravel(), np.ones(x.size)])
    from scipy import ndimage

    askew = ndimage.map_coordinates(straight.grey, (at[:2] / at[2])[::-1] - 0.5, order=1, mode="nearest").reshape(
        x.shape
    )
    found = trace_courses(Photo(askew).rectified(quad, 1.0, 0.625), (0.25, 0.125))
    assert found_share(found, wall) == 1.0


def test_two_points_give_the_scale_and_four_a_map() -> None:
    photo = Photo(np.zeros((50, 80))).scaled((10, 10), (40, 50), 1.0)
    assert photo.size == pytest.approx((80 / 50, 50 / 50))
    points = np.array([[0.2, 0.3], [1.0, 0.9]])
    assert photo.metres(photo.pixels(points)) == pytest.approx(points)
    for a, b, d in (((1, 1), (1, 1), 1.0), ((0, 0), (1, 0), -1.0)):
        with pytest.raises(InputError, match="give no scale"):
            photo.scaled(a, b, d)
    with pytest.raises(InputError, match="no convex quadrilateral"):
        photo.rectified([(0, 0), (80, 0), (80, 50), (0, 50)], 1.0, 1.0)


@pytest.mark.parametrize("mode", ["L", "RGB", "I;16"])
def test_pictures_of_all_kinds_are_read(mode: str, tmp_path: Path) -> None:
    values = np.linspace(0, 255, 12).reshape(3, 4)
    if mode == "I;16":
        Image.fromarray((256 * values).astype(np.uint16)).save(tmp_path / "a.png")
    else:
        Image.fromarray(values.astype(np.uint8)).convert(mode).save(tmp_path / "a.png")
    grey = read_photo(tmp_path / "a.png").grey
    assert grey.min() == pytest.approx(0.0)
    assert grey.max() == pytest.approx(1.0, abs=0.01)
    assert (np.diff(grey.ravel()) > 0).all()


def test_what_is_no_picture_is_refused_in_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_text("no picture")
    with pytest.raises(InputError, match="cannot be read"):
        read_photo(tmp_path / "a.png")
    photo = Photo(np.zeros((20, 20)), 0.01)
    for unit in ((0.0, 0.1), (9.0, 9.0), (float("nan"), 0.1)):
        with pytest.raises(InputError, match="a unit of"):
            trace_courses(photo, unit)
    with pytest.raises(InputError, match="labels of shape"):
        trace_labels(np.zeros((3, 3), dtype=int), photo)
    with pytest.raises(InputError, match="has 2 clicks"):
        trace_outlines(photo, [[(0.0, 0.0), (0.1, 0.1)]])
    with pytest.raises(InputError, match="stones of"):
        trace_regions(photo, 0.01)


def test_a_segmentation_of_ones_own_becomes_a_model() -> None:
    labels = np.repeat(np.repeat([[1, 2], [3, 4]], 20, axis=0), 30, axis=1)
    model = trace_labels(labels, Photo(np.zeros((40, 60)), 0.01)).model(thickness=0.4, unit_weight=25.0)
    assert len(model.free_bodies) == 4
    assert sum(b.volume for b in model.free_bodies) == pytest.approx(0.6 * 0.4 * 0.4)
    assert concio.solve(model).solved


def test_what_no_block_covers_in_a_segmentation_is_left_free() -> None:
    labels = np.zeros((40, 60), dtype=int)
    labels[10:30, :30], labels[10:30, 30:] = 1, 2
    model = trace_labels(labels, Photo(np.zeros((40, 60)), 0.01)).model(thickness=0.4)
    assert sum(b.volume for b in model.free_bodies) == pytest.approx(0.6 * 0.2 * 0.4)


def in_modes(folder, grey):
    """The same picture as other programs store it."""
    eight = Image.fromarray((255 * grey).astype(np.uint8))
    colours = Image.merge("RGB", [eight] * 3)
    shade = np.where(grey < 0.5, 255, 0).astype(np.uint8)  # black joints on a background that is transparent
    blank = np.zeros_like(shade)
    deep, cmyk = Image.fromarray((65535 * grey).astype(np.uint16)), colours.convert("CMYK")
    files = {
        "grey.png": eight, "deep.png": deep, "deep.tif": deep, "cmyk.jpg": cmyk, "cmyk.tif": cmyk,
        "palette.png": colours.convert("P", palette=Image.Palette.ADAPTIVE),
        "float.tif": Image.fromarray(grey.astype(np.float32)),
        "la.png": Image.fromarray(np.dstack([blank, shade]), "LA"),
        "rgba.png": Image.fromarray(np.dstack([blank] * 3 + [shade])),
    }  # fmt: skip
    for name, picture in files.items():
        picture.save(folder / name, **({"quality": 95} if name.endswith("jpg") else {}))
        yield name, read_photo(folder / name).grey


def test_a_picture_is_the_same_however_it_is_stored(tmp_path):
    """Black joints on a transparent background, and floating-point values, were black all over."""
    grey = np.ones((40, 64))
    grey[18:21] = grey[:18, 30:33] = 0.0
    for name, found in in_modes(tmp_path, grey):
        assert found == pytest.approx(grey, abs=0.08 if name.endswith("jpg") else 1e-6), name


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("kind", ["jpg", "png", "tif"])
def test_a_picture_stands_as_its_camera_says(tmp_path, orientation, kind):
    """A photograph taken upright lay on its side, while one in TIFF stood: bed joints were head joints."""
    stored = np.zeros((48, 64), dtype=np.uint8)
    stored[:16, :16], stored[:16, 48:] = 255, 128  # bright at its upper left corner, half as bright at its upper right
    exif = Image.Exif()
    exif[0x0112] = orientation
    Image.fromarray(stored).save(tmp_path / f"a.{kind}", exif=exif, **({"quality": 100} if kind == "jpg" else {}))
    found = read_photo(tmp_path / f"a.{kind}").grey
    turned = {1: lambda a: a, 2: np.fliplr, 3: lambda a: np.rot90(a, 2), 4: np.flipud, 5: np.transpose,
              6: lambda a: np.rot90(a, -1), 7: lambda a: np.rot90(a, 2).T, 8: np.rot90}[orientation]  # fmt: skip
    assert found == pytest.approx(turned(stored) / 255.0, abs=0.03)


def test_pieces_of_a_block_are_not_lost() -> None:
    """The outline was that of the largest piece: a quarter of a square metre of stone was missing."""
    labels = np.repeat(np.repeat([[1, 2], [3, 4]], 20, axis=0), 30, axis=1)
    photo = Photo(np.zeros((40, 60)), 0.01)
    labels[30:, 50:] = 1
    with pytest.raises(InputError, match="block 1 is in 2 pieces, of 600, 100 pixels"):
        trace_labels(labels, photo)
    labels[30:, 50:] = 5
    areas = [b.area for b in trace_labels(labels, photo).model().free_bodies]
    assert sum(areas) == pytest.approx(0.24)
    labels[10, 10] = 6
    with pytest.raises(InputError, match="block 6 is too small for an outline"):
        trace_labels(labels, photo).model()


def test_outlines_of_regions_are_their_outer_boundaries_counter_clockwise() -> None:
    """A ring of pixels about another region keeps its outer boundary; of a region in two pieces the larger counts."""
    labels = np.zeros((12, 15), dtype=int)
    labels[1:11, 2:13] = 1
    labels[3:9, 4:11] = 2
    labels[5:6, 6:8] = 0
    labels[0:1, 0:3] = 3
    labels[11:12, 4:12] = 3
    found = shared_outlines(labels, 0.0)
    assert set(found) == {1, 2, 3}
    for label, area in ((1, 110.0), (2, 42.0), (3, 8.0)):
        ring = shapely.LinearRing(found[label] * [1, -1])
        assert ring.is_ccw
        assert shapely.Polygon(ring).area == pytest.approx(area)
