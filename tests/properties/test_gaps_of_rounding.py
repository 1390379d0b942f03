"""A slab that leans on the corner of a pillar touches it there at any slope, whatever rounding makes of the gap."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio import Body, Elastic, JointLaw, Load, Model, Rigid, Stage
from models import mirrored, turned

ANGLES = [0.95, 1.0, 1.05, 1.1, 1.15, 1.2, 1.25, 1.278]


def leaning(slope: float, kind: str, law: JointLaw) -> Model:
    """A pillar 0.4 m x 1.4 m, and a slab of 0.25 m whose lower face goes through its upper right corner."""
    along, across = np.array([-np.cos(slope), np.sin(slope)]), np.array([np.sin(slope), np.cos(slope)])
    foot = np.array([0.4 + 1.4 / np.tan(slope), 0.0])
    top = foot + 1.05 * 1.4 / np.sin(slope) * along
    slab = np.array([foot, foot + 0.25 * across, top + 0.25 * across, top])
    bodies = (
        Body("floor", np.array([(-6, -0.5), (6, -0.5), (6, 0), (-6, 0)], dtype=float), kind="fixed"),
        Body("pillar", np.array([(0, 0), (0.4, 0), (0.4, 1.4), (0, 1.4)], dtype=float), "stone", kind=kind),
        Body("slab", slab, "stone", kind=kind),
    )
    stone = Rigid(20.0) if kind == "rigid" else Elastic(1e6, 0.2, 20.0)
    return Model(bodies, {"stone": stone}, {"joint": law}, loads=(Load("weight", (0.0, -1.0)),), mesh_size=0.4)


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
@pytest.mark.parametrize("slope", ANGLES)
def test_a_path_from_rest_ends_where_a_load_step_does(slope: float, kind: str) -> None:
    model = leaning(slope, kind, JointLaw(0.8))
    assert concio.solve(model).verdict.holds
    path = concio.run_path(model, [Stage("dead", {"dead": 1.0})])
    assert path.verdict.holds, path.verdict.sentence


@pytest.mark.parametrize("slope", ANGLES)
def test_what_touches_and_is_bonded_does_not_depend_on_where_a_model_stands(slope: float) -> None:
    law = JointLaw(0.8, cohesion=5.0, tensile_strength=2.0)
    for kind in ("rigid", "elastic"):  # the meshes of turned bodies are others
        model = leaning(slope, kind, law)
        first = concio.assemble(model)
        lean = first.pairs.interface == first.pairs.interface.max()
        assert np.count_nonzero(first.pairs.gap[lean] == 0) == 1
        places = [turned(model, 0.0, (12.3, -4.5)), turned(model, 0.0, (5e5, 5e6))]
        if kind == "rigid":
            places += [mirrored(model), turned(model, 0.7), turned(model, 2.0, (12.3, -4.5))]
        for other in places:
            again = concio.assemble(other)
            assert np.count_nonzero(again.pairs.gap == 0) == np.count_nonzero(first.pairs.gap == 0)
            np.testing.assert_allclose(np.sort(again.laws.cohesion), np.sort(first.laws.cohesion), atol=1e-7)
