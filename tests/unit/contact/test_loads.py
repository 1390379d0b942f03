"""Consistent nodal forces: resultants and moments of every kind of load, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from concio.contact.edge_loads import loaded_faces
from concio.contact.loads import load_vectors
from concio.errors import InputError
from concio.fem.discretisation import RIGID, discretise
from concio.fem.elements import FAMILIES
from concio.model.materials import Elastic, Rigid
from concio.model.model import Load
from models import box, model_of, on_ground, turned

ELASTIC, STONE = {"mesh_size": 0.3, "thickness": 0.5}, {"kind": "rigid", "material": "stone", "thickness": 0.5}


def resultant(disc, f, about=(0.0, 0.0)):
    """Force and moment (3,) of nodal forces."""
    total = np.zeros(3)
    for b, s in enumerate(disc.shape_of):
        own = f[disc.offsets[b] : disc.offsets[b + 1]]
        if s == RIGID:
            x, y = disc.centroids[b] - about
            total += [own[0], own[1], x * own[1] - y * own[0] + own[2] * disc.reach[b]]
        elif s >= 0:
            x, y = (disc.nodes(b) - about).T
            fx, fy = own.reshape(-1, 2).T
            total += [fx.sum(), fy.sum(), (x * fy - y * fx).sum()]
    return total


def wrench(force, at):
    return np.array([force[0], force[1], at[0] * force[1] - at[1] * force[0]])


@pytest.mark.parametrize("apart", [0.0, 1e-3, 1e3])
@pytest.mark.parametrize("first", [True, False])
def test_a_line_lies_on_an_edge_by_the_size_of_its_structure(apart, first):
    """A millionth of it: a structure far away, of whatever size, changes nothing."""
    here = (box("g", -1, 3, -1, 0, kind="fixed"), box("a", 0, 2, 0, 1, **STONE))
    at, size = 4.0 + 2 * apart, apart or 1.0
    far = (box("h", at, at + size, -size, 0, kind="fixed"), box("b", at, at + size, 0, size, **STONE))
    bodies = here if not apart else (*far, *here) if first else (*here, *far)
    for off, wanted in ((2e-6, 1), (6e-6, 0), (1e-4, 0)):
        line = ((0.0, 1.0 + off), (2.0, 1.0 + off))
        model = model_of(*bodies, materials={"stone": Rigid(20.0)}, loads=(Load("pressure", (1.0,), edge=line),))
        if wanted:
            assert [model.bodies[f.body].name for f in loaded_faces(model, model.loads[0])] == ["a"]
        else:
            with pytest.raises(InputError, match="lies on no edge"):
                loaded_faces(model, model.loads[0])


def loaded(load, kind, element="Q4", **options):
    disc = discretise(on_ground(box("a", 0, 2, 0, 1, **kind), loads=(load,), element=element, **options))
    (f,) = load_vectors(disc).values()
    return disc, f


kinds = pytest.mark.parametrize("kind", [ELASTIC, STONE], ids=["elastic", "rigid"])


@kinds
@pytest.mark.parametrize("element", list(FAMILIES))
@pytest.mark.parametrize(
    ("load", "force", "at"),
    [
        (Load("weight", (0.1, -1.0)), np.array([0.1, -1.0]) * 20 * 2 * 0.5, (1.0, 0.5)),
        (Load("body", (3.0, 4.0)), np.array([3.0, 4.0]) * 2 * 0.5, (1.0, 0.5)),
        (Load("pressure", (8.0,), edge=((0, 1), (2, 1))), (0.0, -8.0 * 2 * 0.5), (1.0, 1.0)),
        (Load("pressure", (8.0,), edge=((2, -1), (2, 5))), (-8.0 * 1 * 0.5, 0.0), (2.0, 0.5)),
        (Load("pressure", (8.0,), edge=((1.7, 1), (0.4, 1))), (0.0, -8.0 * 1.3 * 0.5), (1.05, 1.0)),
        (Load("traction", (2.0, 5.0), edge=((0.4, 1), (1.7, 1))), np.array([2.0, 5.0]) * 1.3 * 0.5, (1.05, 1.0)),
        (Load("point", (2.0, -7.0), bodies=("a",), at=(1.234, 0.77)), (2.0, -7.0), (1.234, 0.77)),
        (Load("point", (2.0, -7.0), bodies=("a",), at=(2.0, 1.0)), (2.0, -7.0), (2.0, 1.0)),
    ],
    ids=["weight", "body", "pressure", "side pressure", "part", "traction", "point", "corner"],
)
def test_resultants(load, force, at, element, kind):
    disc, f = loaded(load, kind, element)
    np.testing.assert_allclose(resultant(disc, f), wrench(force, at), atol=1e-12)


@kinds
def test_a_turned_and_distant_wall_is_loaded_in_the_same_places(kind):
    """Two edges 0.05 apart, a kilometre from the origin: only the one on the line is loaded."""
    model = on_ground(
        box("a", 0, 2, 0, 1, **kind), box("b", 2, 4, 0, 1.05, **kind),
        loads=(Load("pressure", (8.0,), edge=((0, 1), (4, 1))),),
    )  # fmt: skip
    disc = discretise(turned(model, 0.7, (1e5, -3e5)))
    (f,) = load_vectors(disc).values()
    force = resultant(disc, f, about=(1e5, -3e5))
    direction = np.array([np.sin(0.7), -np.cos(0.7)])
    middle = np.array([np.cos(0.7) - np.sin(0.7), np.sin(0.7) + np.cos(0.7)])
    np.testing.assert_allclose(force, wrench(8.0 * direction, middle), atol=1e-8)


def test_quadratic_edges_get_simpsons_weights():
    disc, f = loaded(
        Load("traction", (6.0, 0.0), edge=((0, 1), (2, 1))), {"mesh_size": 5.0, "thickness": 0.5}, element="Q9"
    )
    top = np.abs(disc.nodes(1)[:, 1] - 1) < 1e-9
    x = f[::2][top][np.argsort(disc.nodes(1)[top, 0])]
    np.testing.assert_allclose(x, [1, 4, 1], rtol=1e-12)


def test_groups_bodies_and_roles():
    model = on_ground(
        box("a", 0, 1, 0, 1), box("b", 1, 2, 0, 1, role="lintel"), box("c", 2, 3, 0, 1, layer="top"),
        loads=(
            Load("weight", (0, -1.0)),
            Load("weight", (1.0, 0), bodies=("lintel",), group="live"),
            Load("weight", (1.0, 0), bodies=("top", "c", "a"), group="wind"),
            Load("body", (0, -1.0), bodies=("b",)),
        ),
    )  # fmt: skip
    vectors = load_vectors(discretise(model))
    assert list(vectors) == ["dead", "live", "wind"]
    totals = {k: v.reshape(-1, 2).sum(0).tolist() for k, v in vectors.items()}
    assert totals["dead"] == pytest.approx([0, -61])
    assert totals["live"] == pytest.approx([20, 0])
    assert totals["wind"] == pytest.approx([40, 0])  # named twice, loaded once


@pytest.mark.parametrize(
    ("load", "message"),
    [
        (Load("weight", (0, np.nan)), "not finite"),
        (Load("weight", (0, -1.0), bodies=("x",)), "'x'.*no free body"),
        (Load("weight", (0, -1.0), bodies=("ground",)), "'ground'.*no free body"),
        (Load("pressure", (1.0,)), "needs an edge"),
        (Load("pressure", (1.0,), edge=((1, 1), (1, 1))), "no length"),
        (Load("pressure", (1.0,), edge=((0, 0.5), (2, 0.5))), "lies on no edge"),
        (Load("pressure", (1.0,), edge=((3, 1), (4, 1))), "lies on no edge"),
        (Load("point", (1.0, 0.0), bodies=("a",)), "one body and a point"),
        (Load("point", (1.0, 0.0), at=(0, 0)), "one body and a point"),
        (Load("point", (1.0, 0.0), bodies=("a",), at=(9, 0)), "outside"),
        (Load("thunder", (1.0, 0.0)), "unknown load kind"),  # type: ignore[arg-type]
        (Load("weight", (1.0,)), "two components"),
        (Load("pressure", (1.0, 2.0), edge=((0, 1), (2, 1))), "one value"),
    ],
)
def test_refused(load, message):
    with pytest.raises(InputError, match=message):
        loaded(load, ELASTIC)


@kinds
def test_weight_of_weightless_bodies_is_not_a_silent_zero(kind):
    with pytest.raises(InputError, match=r"without weight.*unit_weight"):
        loaded(Load("weight", (0, -1.0)), kind, materials={"block": Elastic(1.0), "stone": Rigid()})
