"""What a result says in space: the same words mean the same as in the plane, or are refused."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio import Body, Load, Model, Rigid
from concio.analysis.thrust import course_resultants, hinges


def test_every_attribute_means_the_same_in_space_or_refuses() -> None:
    """Two blocks under an eccentric push, in the plane and extruded by 1 m: joint by joint the same, or an error."""
    block = {"block": Rigid(unit_weight=20.0)}
    bodies = (
        Body("g", [(-1, -1), (2, -1), (2, 0), (-1, 0)], kind="fixed"),
        Body("a", [(0, 0), (0.4, 0), (0.4, 0.5), (0, 0.5)], kind="rigid"),
        Body("b", [(0.1, 0.5), (0.5, 0.5), (0.5, 1), (0.1, 1)], kind="rigid"),
    )
    loads = (Load("weight", (0.0, -1.0)), Load("point", (1.0, 0.0), bodies=("b",), at=(0.1, 0.8)))
    model = Model(bodies, block, {"joint": concio.JointLaw(0.5)}, loads=loads)
    plane, space = concio.solve(model), concio.solve(concio.extrude(model, 1.0))
    p, s = plane.joints, space.joints_in_space
    assert pytest.approx(p.N) == s.N
    assert s.middle[:, [0, 2]] == pytest.approx(p.middle)
    assert s.middle[:, 1] == pytest.approx(0.0)
    assert s.normal[:, [0, 2]] == pytest.approx(p.normal)
    assert s.V[:, [0, 2]] == pytest.approx(p.V[:, None] * p.tangent)
    assert s.point[:, [0, 2]] == pytest.approx(p.middle + p.eccentricity[:, None] * p.tangent)
    assert s.open_share.tolist() == p.open_share.tolist()
    assert s.slipping.tolist() == p.slipping.tolist()
    assert [face.width for face in space.assembly.detection.patches] == pytest.approx(p.length)
    for wrong in (lambda: space.joints, lambda: space.contacts.pairs.tangent, lambda: hinges(space),
                  lambda: course_resultants(space), lambda: concio.thrust_line(space)):  # fmt: skip
        with pytest.raises(concio.InputError, match=r"in space ha(ve|s)"):
            wrong()
    assert np.isnan(space.contacts.pairs.length).all()
    for name in ("forces", "pressure", "principal", "slip", "thrust"):
        with pytest.raises(concio.InputError, match=rf"plot\.{name}\(\) is a figure of the plane"):
            getattr(space.plot, name)()
    of_plane, of_space = plane.tables.joints(), space.tables.joints()
    for name in of_plane.keys() & of_space.keys():
        a, b = of_plane[name], of_space["z".join(name.rsplit("y", 1)) if name[-1] == "y" else name]
        assert (a == b).all() if a.dtype.kind in "Ub" else a == pytest.approx(b, abs=1e-12)
    assert "shear_force" not in of_space
    with pytest.warns(DeprecationWarning, match="shear_size"):
        assert of_space["shear_force"] == pytest.approx(np.abs(of_plane["shear_force"]))


def test_a_summary_of_elastic_blocks_in_space_whose_meshes_do_not_match() -> None:
    model = concio.extrude(concio.wall(length=0.5, height=0.25, friction=0.6), 0.2)
    result = concio.solve(model)
    assert "dual mortar" in result.assembly.pairs.contact_model
    assert result.summary()["outline_gap_difference"] is None


def test_the_width_of_a_patch_does_not_depend_on_how_it_is_turned() -> None:
    wall = concio.extrude(concio.wall(length=0.5, height=0.25, block="rigid"), 0.1)
    turn = concio.place(wall, turn=37.0, axis=(1.0, 2.0, 3.0))
    for patch in concio.assemble(turn).detection.patches:
        assert patch.width == pytest.approx(0.1, rel=1e-9)
