"""Stages of a load path in a model file: read, written back, followed, and what is wrong with them."""

from __future__ import annotations

import pytest

import concio
from concio.errors import InputError

WALL = """
[wall]
length = 1.0
height = 0.5
friction = 0.6
mesh_size = 0.25
horizontal = 1.0
"""
STAGES = """
[[stages]]
name = "weight"
factors = { dead = 1.0 }
steps = 1

[[stages]]
name = "push"
factors = { live = 0.5 }
control = { body = "c04-b01", at = [0.0, "50 cm"] }
until = "0.002 mm"
"""


def test_stages_are_read_written_and_followed():
    model = concio.loads(WALL + STAGES)
    point = concio.ControlPoint("c04-b01", (0.0, 0.5))
    weight, push = model.stages
    assert weight == concio.Stage("weight", {"dead": 1.0}, steps=1)
    assert push.until == pytest.approx(2e-6)
    assert push == concio.Stage("push", {"live": 0.5}, point, push.until)
    again = concio.loads(concio.dumps(model))
    assert again.stages == model.stages
    found = concio.run_path(model)
    assert found.stages == model.stages
    motion, _ = found.curve(point, stage=1)
    assert motion[-1] - motion[0] == pytest.approx(2e-6, rel=1e-9)  # just before the blocks slide


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("c04-b01", "c04-b99"), "no body called 'c04-b99'"),
        (('until = "0.002 mm"', ""), "one of the two is missing"),
        (("steps = 1", "steps = 0"), "steps"),
        (("steps = 1", "stepz = 1"), "stepz"),
    ],
)
def test_what_is_wrong_is_named(change, message):
    with pytest.raises(InputError, match=message):
        concio.loads(WALL + STAGES.replace(*change))
