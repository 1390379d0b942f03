"""The running-bond panel: counts, names, films, supports, loads, and refusals."""

from __future__ import annotations

import numpy as np
import pytest

from concio.contact.assembly import assemble
from concio.errors import InputError
from concio.model.generate.panel import running_bond_panel
from concio.model.materials import Elastic, Rigid


def area(model, role):
    return sum(b.area for b in model.bodies if b.role == role)


def test_dry_panel_fills_its_rectangle():
    model = running_bond_panel(courses=4, blocks=5)
    assert sum(b.role == "block" for b in model.bodies) == 5 + 6 + 5 + 6
    assert area(model, "block") == pytest.approx(5 * 0.2 * 4 * 0.1)
    assert {b.name for b in model.bodies if b.kind == "fixed"} == {"base", "left wall", "right wall"}
    assembly = assemble(model)
    assert not assembly.detection.report()
    # pairs of the theory page: 10 x 10 dry 935
    assert len(assemble(running_bond_panel(courses=10, blocks=10)).pairs) == 935


@pytest.mark.parametrize("bed", ["continuous", "cut"])
def test_mortar_panel_fills_its_rectangle_too(bed):
    model = running_bond_panel(courses=3, blocks=3, joint=0.02, bed_mortar=bed)
    width, height = 3 * 0.22 - 0.02, 3 * 0.1 + 2 * 0.02
    assert area(model, "block") + area(model, "mortar") == pytest.approx(width * height)
    beds = [b for b in model.bodies if b.name.startswith("bed")]
    heads = [b for b in model.bodies if b.role == "mortar" and b not in beds]
    assert len(heads) == 2 + 3 + 2
    assert len(beds) == (2 if bed == "continuous" else 2 * 6)
    assert not assemble(model).detection.report()
    if bed == "continuous":  # block nodes of the reference: 0, .045, .09, .11, .155, .2
        whole = next(b for b in model.bodies if b.name.startswith("c1-b") and np.ptp(b.outline[:, 0]) > 0.19)
        np.testing.assert_allclose(whole.grid[0], [0, 0.045, 0.09, 0.11, 0.155, 0.2], atol=1e-12)
        assert len(assemble(running_bond_panel(courses=10, blocks=10, joint=0.02)).pairs) == 2166


@pytest.mark.parametrize("joint", [0.0, 0.02])
def test_all_meshes_match(joint):
    """Every contact pair is one node on one node or on an obstacle."""
    assembly = assemble(running_bond_panel(courses=3, blocks=3, joint=joint, refinement=2))
    entries = np.diff(assembly.pairs.C_n.indptr)
    assert set(entries.tolist()) <= {1, 2}


def test_supports_of_the_panel():
    bearings = running_bond_panel(courses=2, blocks=4, base="bearings")
    left, right = (bearings.body(n).outline[:, 0] for n in ("left bearing", "right bearing"))
    assert (left.min(), left.max()) == pytest.approx((0.0, 0.2))
    assert (right.min(), right.max()) == pytest.approx((0.6, 0.8))
    hung = running_bond_panel(courses=2, blocks=4, base="none")
    assert {b.name for b in hung.bodies if b.kind == "fixed"} == {"left wall", "right wall"}
    gap = assemble(running_bond_panel(courses=2, blocks=2, side_gap="1 mm")).pairs
    assert set(np.round(gap.gap, 9).tolist()) == {0.0, 1e-3}
    names = running_bond_panel(courses=1, blocks=1, wall_friction=0.1, base_friction=0.2, friction=0.3)
    laws = assemble(names).laws.friction
    assert set(laws.tolist()) == {0.1, 0.2}


def test_loads_of_the_panel():
    model = running_bond_panel(courses=2, blocks=2, unit_weight=20.0, horizontal=0.1, top_pressure=10.0, thickness=0.3)
    assembly = assemble(model)
    total = {g: f.reshape(-1, 2).sum(0) for g, f in assembly.loads.items()}
    weight = 20 * 0.4 * 0.2 * 0.3
    np.testing.assert_allclose(total["dead"], [0, -weight])
    np.testing.assert_allclose(total["live"], [0.1 * weight, 0], atol=1e-15)
    np.testing.assert_allclose(total["top"], [0, -10 * 0.4 * 0.3], atol=1e-15)


def test_rigid_blocks():
    model = running_bond_panel(courses=2, blocks=2, block=Rigid(20.0))
    assert {b.kind for b in model.free_bodies} == {"rigid"}
    assert assemble(model).disc.unknowns == 3 * 5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"courses": 0}, "courses = 0"),
        ({"courses": 2.5}, "courses = 2.5"),
        ({"courses": True}, "courses = True"),
        ({"blocks": -1}, "blocks = -1"),
        ({"block_size": 0.2}, "block_size"),
        ({"block_size": (0.2, 0.0)}, "block height = 0"),
        ({"block_size": (0.2, 0.1, 0.1)}, "two values"),
        ({"block_size": ("20 kN", 0.1)}, "block_size"),
        ({"thickness": -0.1}, "thickness = -0.1"),
        ({"joint": -0.01}, "joint = -0.01"),
        ({"joint": 0.2}, "not thinner"),
        ({"side_gap": -1.0}, "side_gap"),
        ({"top_pressure": np.nan}, "top_pressure"),
        ({"base": "sand"}, "base 'sand'"),
        ({"bed_mortar": "thin"}, "bed_mortar 'thin'"),
        ({"base": "none", "side_walls": False}, "nothing holds"),
        ({"horizontal": 0.1}, "unit_weight"),
        ({"friction": -0.1}, "friction"),
        ({"block": Rigid(), "joint": 0.01}, "rigid blocks"),
        ({"elements_per_block": (4,)}, "elements_per_block"),
        ({"courses": 10**4, "blocks": 10**4}, "more than"),
    ],
)
def test_refused(options, message):
    with pytest.raises(InputError, match=message):
        running_bond_panel(**options)


def test_odd_joint_against_half_blocks():
    """A half block is half a block less half a joint; both patterns have the same width."""
    model = running_bond_panel(courses=2, blocks=2, joint=0.03, mortar=Elastic(1e4))
    right = [max(b.outline[:, 0].max() for b in model.free_bodies if b.name.startswith(c)) for c in ("c1-", "c2-")]
    assert right == pytest.approx([0.43, 0.43])
