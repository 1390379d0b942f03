"""Points that are followed: where they lie, along what they are measured, what is no point of the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import ControlPoint, InputError
from motion_models import G, standing
from space_motions import blocks

FAR = np.array([3e5, -4e6])
BAD = [
    ({"body": "nobody", "at": (0.0, 0.5)}, "no body called 'nobody'"),
    ({"at": (0.0, 0.5, 0.0)}, "is not 2 finite numbers"),
    ({"at": (0.0, np.nan)}, "is not 2 finite numbers"),
    ({"at": (0.0, 0.5), "direction": (0.0, 0.0)}, "has no length"),
    ({"at": (0.0, 0.5), "direction": (0.0, 0.0, 1.0)}, "is not 2 numbers"),
    ({"at": (0.0, 5.0)}, r"the point \(0, 5\) m does not lie on"),
]


@pytest.mark.parametrize(("given", "words"), BAD)
@pytest.mark.parametrize("kind", ["dynamics", "push", "path"])
def test_what_is_no_point_is_refused(given, words, kind):
    """A point 5 m up was followed as if the block reached there, one of three numbers ended in a traceback."""
    model, point = standing(), ControlPoint(**{"body": "block", **given})
    asked = {
        "dynamics": lambda: concio.dynamics(model, None, 0.01, points=(point,), gravity=G),
        "push": lambda: concio.push(model, control=point),
        "path": lambda: concio.run_path(model, [concio.Stage("push", {"dead": 1.0}, control=point, until=0.001)]),
    }[kind]
    with pytest.raises(InputError, match=words):
        asked()


def test_a_point_far_away_is_told_where_it_is():
    model = standing()
    far = replace(model, bodies=tuple(replace(b, outline=b.outline + FAR) for b in model.bodies))
    with pytest.raises(InputError, match=r"the point \(300000, -3999995\) m does not lie"):
        concio.dynamics(far, None, 0.01, points=(ControlPoint("block", (3e5, -4e6 + 5.0)),), gravity=G)


def test_a_direction_of_the_plane_is_horizontal_in_space():
    """A push in space along the direction that points have by default ended in a traceback."""
    model = blocks(((-0.2, -0.2, 0.0), (0.2, 0.2, 1.0)), friction=1.0)
    found = [concio.push(model, control=ControlPoint("b0", (0.0, 0.0, 1.0), way), until=0.01)
             for way in ((1.0, 0.0), (1.0, 0.0, 0.0))]  # fmt: skip
    assert found[0].peak == pytest.approx(found[1].peak, rel=1e-12)
