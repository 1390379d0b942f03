"""What measurements read of rigid motions, against the motions themselves; nothing is symmetric or of length one."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.cracks.observed import readings
from concio.contact.assembly import Assembly
from concio.errors import InputError
from concio.model.materials import JointLaw, Rigid
from concio.model.model import Model, Support
from models import box, model_of
from solids import box as solid

FACTOR = 3.0
"""Of the group whose supports move."""


def plane() -> Model:
    """Two stones of different sizes on a base, side by side; the base is moved by a support."""
    base = Support("sinks", "base", displacement=(2e-3, -5e-3), rotation=4e-3, group="soil")
    return model_of(
        box("base", 2.0, 7.0, 1.0, 2.0, kind="fixed", role="ground"),
        box("left", 2.5, 4.0, 2.0, 5.0, kind="rigid", material="stone"),
        box("right", 4.0, 6.5, 2.0, 4.0, kind="rigid", material="stone"),
        supports=(base,),
    )


def space() -> Model:
    """The same in space, of other depths."""
    bodies = (
        solid("base", (2.0, 3.0, 1.0), (7.0, 6.0, 2.0), kind="fixed", role="ground"),
        solid("left", (2.5, 3.5, 2.0), (4.0, 5.5, 5.0), kind="rigid", material="stone"),
        solid("right", (4.0, 3.2, 2.0), (6.5, 5.2, 4.0), kind="rigid", material="stone"),
    )
    base = Support("sinks", "base", displacement=(2e-3, 3e-3, -5e-3), rotation=(-1e-3, 2e-3, 4e-3), group="soil")
    return Model(bodies, {"stone": Rigid(20.0)}, {"joint": JointLaw(0.5)}, supports=(base,))


class Moved:
    """A structure whose bodies all have motions of their own.

    Parameters
    ----------
    model : Model
    seed : int
    """

    def __init__(self, model: Model, seed: int = 3) -> None:
        self.assembly: Assembly = concio.assemble(model)
        d, rng = model.dim, np.random.default_rng(seed)
        self.turns = 1 if d == 2 else 3
        self.u = rng.uniform(-1e-2, 1e-2, self.assembly.disc.unknowns)
        self.centre = {"base": (4.5, 1.5), "left": (3.25, 3.5), "right": (5.25, 3.0)}
        if d == 3:
            self.centre = {"base": (4.5, 4.5, 1.5), "left": (3.25, 4.5, 3.5), "right": (5.25, 4.2, 3.0)}

    def of(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return the displacement of the centroid of a body and its rotation."""
        disc, d = self.assembly.disc, self.assembly.model.dim
        if name == "base":
            (support,) = self.assembly.model.supports
            return FACTOR * np.array(support.displacement), FACTOR * np.atleast_1d(support.rotation)
        b = [body.name for body in self.assembly.model.bodies].index(name)
        own = self.u[disc.offsets[b] : disc.offsets[b] + d + self.turns]
        return own[:d], own[d:] / disc.reach[b]

    def at(self, name: str, point: tuple[float, ...]) -> np.ndarray:
        """Return the displacement of a point of a body."""
        shift, turn = self.of(name)
        arm = np.array(point) - self.centre[name]
        swept = turn[0] * np.array([-arm[1], arm[0]]) if len(arm) == 2 else np.cross(turn, arm)
        moved: np.ndarray = shift + swept
        return moved

    def read(self, kind: str, **options: object) -> float:
        """Return what a measurement reads."""
        (found,) = readings(self.assembly, [concio.Measurement("M", kind, error=1e-3, **options)])
        return found.value(self.u, {"soil": FACTOR})


PLANE, SPACE = Moved(plane()), Moved(space())


@pytest.mark.parametrize("point", [(2.8, 2.0), (3.5, 2.0), (4.0, 2.0)])
def test_an_opening_is_the_way_of_the_upper_block_off_the_base(point: tuple[float, float]) -> None:
    motion = PLANE.at("left", point) - PLANE.at("base", point)
    for names in (("base", "left"), ("left", "base")):
        assert PLANE.read("opening", joint=names, at=point) == pytest.approx(motion[1], rel=1e-12)
        # the normal from the base is up; turned left it is -x
        assert PLANE.read("slip", joint=names, at=point) == pytest.approx(-motion[0], rel=1e-12)
        assert PLANE.read("closed", joint=names, at=point) == pytest.approx(motion[1], rel=1e-12)


def test_a_joint_is_read_in_its_middle_and_the_nearest_one_is_taken() -> None:
    middle = PLANE.at("right", (4.0, 3.0)) - PLANE.at("left", (4.0, 3.0))
    assert PLANE.read("opening", joint=("left", "right")) == pytest.approx(middle[0], rel=1e-12)
    assert PLANE.read("slip", joint=("right", "left")) == pytest.approx(middle[1], rel=1e-12)
    near = PLANE.at("right", (4.0, 3.6)) - PLANE.at("left", (4.0, 3.6))
    assert PLANE.read("opening", at=(4.0, 3.6)) == pytest.approx(near[0], rel=1e-12)
    with pytest.raises(InputError, match=r"is 0\.5 m away from the nearest joint"):
        PLANE.read("opening", at=(4.0, 4.5))
    with pytest.raises(InputError, match="away from the nearest joint"):
        PLANE.read("opening", joint=("base", "right"), at=(5.0, 2.2))
    assert PLANE.read("opening", joint=("base", "right"), at=(5.0, 2.1)) != 0.0


@pytest.mark.parametrize("name", ["left", "right", "base"])
def test_tilts_levels_and_distances_of_a_body_and_of_two(name: str) -> None:
    at = {"left": (2.5, 4.5), "right": (6.5, 2.5), "base": (2.0, 1.5)}[name]
    to = {"left": (3.5, 5.0), "right": (4.0, 3.5), "base": (6.5, 1.0)}[name]
    assert PLANE.read("tilt", body=name) == pytest.approx(PLANE.of(name)[1][0], rel=1e-9)
    assert PLANE.read("tilt", body=name, at=at, to=to) == pytest.approx(PLANE.of(name)[1][0], rel=1e-9)
    assert PLANE.read("level", body=name, at=at) == pytest.approx(PLANE.at(name, at)[1], rel=1e-12)
    way = np.array([3.0, -4.0]) / 5.0
    found = PLANE.read("level", body=name, at=at, direction=(6.0, -8.0))
    assert found == pytest.approx(PLANE.at(name, at) @ way, rel=1e-12)
    between = PLANE.read("level", body=name, at=at, to=to)
    assert between == pytest.approx((PLANE.at(name, at) - PLANE.at(name, to))[1], rel=1e-9, abs=1e-16)
    p, q = at, (6.2, 4.0)
    line = np.array(q) - p
    stretched = (PLANE.at("right", q) - PLANE.at(name, p)) @ line / np.linalg.norm(line)
    found = PLANE.read("distance", body=name, at=p, other="right", to=q)
    assert found == pytest.approx(stretched, rel=1e-9, abs=1e-16)


def test_where_and_between_which_bodies_a_reading_is_drawn() -> None:
    asked = [
        concio.Measurement("tilt", "tilt", error=1e-3, body="right", at=(6.0, 2.0), to=(6.0, 4.0)),
        concio.Measurement("level", "level", error=1e-3, body="right", at=(6.5, 4.0)),
        concio.Measurement("way", "distance", error=1e-3, body="left", at=(2.5, 5.0), other="right", to=(6.5, 2.0)),
        concio.Measurement("crack", "opening", error=1e-3, joint=("right", "base")),
    ]
    tilt, level, way, crack = readings(PLANE.assembly, asked)
    assert tilt.at == pytest.approx([6.0, 3.0])
    assert tilt.along == pytest.approx([-1.0, 0.0])  # what turns anticlockwise leans to the left
    assert level.at == pytest.approx([6.5, 4.0])
    assert level.along == pytest.approx([0.0, 1.0])
    assert way.at == pytest.approx([2.5, 5.0])
    assert way.along == pytest.approx([-0.8, 0.6])  # away from the other point
    assert crack.at == pytest.approx([5.25, 2.0])
    assert [r.bodies for r in (tilt, level, way, crack)] == [(2, -1), (2, -1), (1, 2), (0, 2)]
    assert [r.change for r in (tilt, level, way, crack)] == [True, True, True, False]


def test_openings_slips_and_tilts_in_space() -> None:
    point = (3.0, 4.1, 2.0)
    motion = SPACE.at("left", point) - SPACE.at("base", point)
    assert SPACE.read("opening", joint=("left", "base"), at=point) == pytest.approx(motion[2], rel=1e-12)
    way = np.array([3.0, -4.0, 0.0]) / 5.0
    slip = SPACE.read("slip", joint=("base", "left"), at=point, direction=(3.0, -4.0, 0.0))
    assert slip == pytest.approx(motion @ way, rel=1e-12)
    turned = SPACE.read("slip", joint=("left", "base"), at=point, direction=(3.0, -4.0, 0.0))
    assert turned == pytest.approx(-slip, rel=1e-12), "along it the second body named moves"
    for axis in ((1.0, 0.0, 0.0), (0.0, 2.0, 0.0)):
        # two points across the axis; the mean rotation of the line between them is that of the body
        found = SPACE.read("tilt", body="right", at=(5.0, 4.0, 2.0), to=(5.0, 4.0, 4.0), direction=axis)
        assert found == pytest.approx(SPACE.of("right")[1] @ (np.array(axis) / np.linalg.norm(axis)), rel=1e-9)
    with pytest.raises(InputError, match="do not determine it"):
        SPACE.read("tilt", body="right", at=(5.0, 4.0, 2.0), to=(5.0, 4.0, 4.0), direction=(0.0, 0.0, 1.0))
    with pytest.raises(InputError, match="away from the nearest joint"):
        SPACE.read("opening", joint=("left", "base"), at=(3.0, 4.1, 2.5))
    level = SPACE.read("level", body="right", at=(6.5, 3.2, 4.0))
    assert level == pytest.approx(SPACE.at("right", (6.5, 3.2, 4.0))[2], rel=1e-12)
