"""What a strengthening adds to a model: weight of mass, widths of buttresses, forces of ties, cohesion of joints."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import Body, InputError, JointLaw, JointRule, Load, Model, Polyhedron, Rigid, Tie
from concio.analysis.seismic.buttress import with_buttress
from concio.analysis.seismic.strengthening import Measure
from concio.contact.assembly import assemble
from seismic_walls import courses


def pillar(at: float = 0.0, width: float = 0.5, height: float = 3.0, thickness: float = 0.7) -> Model:
    """Three courses on a wide ground; its left face is at x = at."""
    ground = Body("ground", np.array([[at - 6, -0.5], [at + 6, -0.5], [at + 6, 0.0], [at - 6, 0.0]]), kind="fixed")
    blocks = [
        replace(c, outline=np.asarray(c.outline) - np.asarray(c.outline).min(axis=0)
                + (at, height / 3 * k), thickness=thickness)
        for k, c in enumerate(courses(3, height, width))
    ]  # fmt: skip
    laws = {"joint": JointLaw(0.8), "weak": JointLaw(0.5, cohesion=2.0)}
    rules = (JointRule("joint"), JointRule("weak", between=(blocks[0].name, blocks[1].name)))
    return Model((ground, *blocks), {"block": Rigid(20.0)}, laws, rules=rules, loads=(Load("weight", (0.0, -1.0)),))


def weights(model: Model) -> dict[str, float]:
    return {b.name: b.volume * model.materials[b.material].unit_weight for b in model.free_bodies}


def test_mass_adds_its_weight_by_volume_to_the_bodies_named() -> None:
    model = pillar()
    names = [b.name for b in model.free_bodies]
    for of, share in (((names[2],), {names[2]: 1.0}), ((names[0], names[2]), {names[0]: 0.5, names[2]: 0.5})):
        measure = Measure("mass", of)
        assert measure.applied(model, 0.0) is model
        before, after = weights(model), weights(measure.applied(model, 6.0))
        for name in names:
            assert after[name] - before[name] == pytest.approx(6.0 * share.get(name, 0.0))


def test_a_tie_yields_at_the_amount_and_has_no_larger_prestress() -> None:
    model = pillar()
    top = model.free_bodies[-1].name
    ties = tuple(Tie(n, top, (0.0, 2.5), "", (-4.0, 2.5), 1000.0, prestress=5.0, yield_force=9.0) for n in ("t1", "t2"))
    model = replace(model, ties=ties)
    for amount, prestress in ((3.0, 3.0), (7.0, 5.0), (40.0, 5.0)):
        one, other = Measure("tie", ("t1",)).applied(model, amount).ties
        assert (one.yield_force, one.prestress) == (amount, prestress)
        assert other == ties[1]
    assert [t.name for t in Measure("tie", ("t1",)).applied(model, 0.0).ties] == ["t2"]
    with pytest.raises(InputError, match="no tie called 't3'"):
        Measure("tie", ("t3",)).applied(model, 1.0)


def test_grout_adds_cohesion_to_the_weakest_law_between_the_bodies_of_the_zone() -> None:
    model = pillar()
    low, middle, top = model.free_bodies
    measure = Measure("grout", (low.name, middle.name))
    made = measure.applied(model, 30.0)
    assert measure.applied(model, 0.0) is model
    within = made.laws[made.rule_between(low, middle).law]
    assert (within.friction, within.cohesion) == (0.5, 32.0)
    assert made.rule_between(middle, top).law == "joint"
    assert made.rule_between(model.bodies[0], low).law == "joint"


@pytest.mark.parametrize("at", [-2.0, 0.0, 3.0])
@pytest.mark.parametrize(("side", "width", "height"), [
    ("left", 0.4, None), ("right", 0.4, None), ("left", 1.1, 1.5), ("right", 1.1, 2.0),
])  # fmt: skip
def test_a_buttress_stands_beside_the_wall_with_its_width_and_height(
    at: float, side: str, width: float, height: float | None
) -> None:
    model = pillar(at)
    measure = Measure("buttress", tuple(b.name for b in model.free_bodies), side=side, height=height, unit_weight=17.0)
    assert measure.applied(model, 0.0) is model
    made = measure.applied(model, width)
    block = made.bodies[-1]
    low, high = block.vertices.min(axis=0), block.vertices.max(axis=0)
    face = at if side == "left" else at + 0.5
    assert (low[0], high[0]) == pytest.approx((face - width, face) if side == "left" else (face, face + width))
    assert (low[1], high[1]) == pytest.approx((0.0, height or 3.0))
    assert block.thickness == pytest.approx(0.7)
    assert made.materials[block.material].unit_weight == 17.0
    assert len(made.bodies) == len(model.bodies) + 1
    with pytest.raises(InputError, match="has no ground under it"):
        measure.applied(model, 20.0)


@pytest.mark.parametrize(("side", "axis", "sense"), [("left", 0, -1), ("+x", 0, 1), ("-y", 1, -1), ("+y", 1, 1)])
def test_a_buttress_in_space_stands_along_the_wall(side: str, axis: int, sense: int) -> None:
    base = Polyhedron.box("ground", (-5, -5, -1), (5, 5, 0), kind="fixed")
    wall = Polyhedron.box("wall", (-0.2, -1.0, 0.0), (0.2, 1.0, 3.0), kind="rigid")
    model = Model((base, wall), {"block": Rigid(20.0)}, {"joint": JointLaw(0.6)}, loads=(Load("weight", (0, 0, -1)),))
    measure = Measure("buttress", ("wall",), side=side, height=2.0, unit_weight=17.0)
    assert measure.most(model) == 2.0
    made = measure.applied(model, 0.5)
    points = np.asarray(made.bodies[-1].vertices)
    face = np.asarray(wall.vertices)[:, axis]
    near, far = (face.min(), face.min() - 0.5) if sense < 0 else (face.max(), face.max() + 0.5)
    assert sorted((points[:, axis].min(), points[:, axis].max())) == pytest.approx(sorted((near, far)))
    other = 1 - axis
    assert np.ptp(points[:, other]) == pytest.approx(np.ptp(np.asarray(wall.vertices)[:, other]))
    assert (points[:, 2].min(), points[:, 2].max()) == pytest.approx((0.0, 2.0))
    assert len(assemble(made).detection.interfaces) == 3
    with pytest.raises(InputError, match="no ground under it"):
        measure.applied(model, 7.0)


def test_a_buttress_in_space_has_the_multiplier_of_the_one_in_the_plane() -> None:
    """A wall of one block that is pushed over its buttress."""
    flat = Model(
        (Body("ground", np.array([[-5, -1], [5, -1], [5, 0], [-5, 0.0]]), kind="fixed", thickness=2.0),
         Body("wall", np.array([[-0.2, 0], [0.2, 0], [0.2, 3], [-0.2, 3.0]]), kind="rigid", thickness=2.0)),
        {"block": Rigid(20.0)}, {"joint": JointLaw(0.9)},
        loads=(Load("weight", (0, -1)), Load("weight", (-1, 0), group="live")),
    )  # fmt: skip
    deep = Model(
        (Polyhedron.box("ground", (-5, -5, -1), (5, 5, 0), kind="fixed"),
         Polyhedron.box("wall", (-0.2, -1.0, 0.0), (0.2, 1.0, 3.0), kind="rigid")),
        {"block": Rigid(20.0)}, {"joint": JointLaw(0.9)},
        loads=(Load("weight", (0, 0, -1)), Load("weight", (-1, 0, 0), group="live")),
    )  # fmt: skip
    measure = Measure("buttress", ("wall",), side="left", height=3.0)
    found = [concio.limit(measure.applied(m, 0.6), path=False, search=False).associated.multiplier
             for m in (flat, deep)]  # fmt: skip
    bare = concio.limit(flat, path=False, search=False).associated.multiplier
    assert found[1] == pytest.approx(found[0], rel=1e-6)
    assert found[0] > 1.5 * bare


def test_a_buttress_in_the_plane_has_no_side_along_y() -> None:
    with pytest.raises(InputError, match="no side '-y' in the plane"):
        Measure("buttress", ("c1",), side="-y").applied(pillar(0.0), 0.3)


@pytest.mark.parametrize("side", ["-x", "+x", "-y", "+y"])
def test_a_buttress_in_space_stands_on_the_ground_that_is_under_all_of_it(side: str) -> None:
    """A wall of 2 x 0.3 x 3 m away from the origin: the body added, and the ground that it needs on every side."""

    def on(low: tuple[float, ...], high: tuple[float, ...]) -> concio.Model:
        bodies = (
            concio.Polyhedron.box("ground", (*low, -1.0), (*high, 0.0), kind="fixed"),
            concio.Polyhedron.box("wall", (1.0, 5.0, 0.0), (3.0, 5.3, 3.0), kind="rigid"),
        )
        return concio.Model(bodies, {"block": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.6)})

    axis, sense = "xy".index(side[1]), 1.0 if side[0] == "+" else -1.0
    made = with_buttress(on((-4.0, 0.0), (8.0, 9.0)), [1], side, 2.0, 0.5, 18.0).bodies[-1]
    low, high = np.array([1.0, 5.0, 0.0]), np.array([3.0, 5.3, 2.0])
    low[axis], high[axis] = (high[axis], high[axis] + 0.5) if sense > 0 else (low[axis] - 0.5, low[axis])
    np.testing.assert_allclose((made.vertices.min(0), made.vertices.max(0)), (low, high))
    for k in (0, 1):
        for end in (0, 1):  # ground that ends 0.1 m short of the buttress on one of its four sides
            span = [[-4.0, 0.0], [8.0, 9.0]]
            span[end][k] = (low[k] + 0.1, high[k] - 0.1)[end]
            with pytest.raises(concio.InputError, match="has no ground under it"):
                with_buttress(on(tuple(span[0]), tuple(span[1])), [1], side, 2.0, 0.5, 18.0)
