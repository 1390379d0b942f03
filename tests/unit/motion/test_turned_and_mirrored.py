"""Motions in space that are turned with their gravity, or mirrored, are the turned and the mirrored motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import concio
from concio.analysis.motion.scheme import Drive, Scheme
from samples import sample
from space_motions import STILL, blocks, stepper_of

MIRROR = np.diag([1.0, -1.0, 1.0])


def scene(turn, mirrored=False):
    """A tilted cube that falls beside a block which another one stands on, askew; all of it turned, or mirrored."""
    model = blocks(
        ((-0.2, -0.2, 0.3), (0.2, 0.2, 0.7)), ((0.6, -0.3, 0.0), (1.0, 0.3, 0.3)),
        ((0.7, -0.1, 0.3), (0.95, 0.25, 0.8)), friction=0.4,
    )  # fmt: skip
    lean = Rotation.from_rotvec([0.5, 0.3, 0.2]).as_matrix()
    cube = model.bodies[1]
    fallen = cube.vertices - cube.centroid
    fallen = fallen @ lean.T
    fallen += np.array([0.0, 0.0, 0.004 - fallen[:, 2].min()])  # a corner hits the floor after 29 ms
    bodies = [model.bodies[0], replace(cube, vertices=fallen), *model.bodies[2:]]
    way = turn @ MIRROR if mirrored else turn
    placed = []
    for body in bodies:
        faces = tuple(face[::-1] for face in body.faces) if mirrored else body.faces
        at = body.vertices @ way.T
        placed.append(concio.Polyhedron(body.name, at, faces, kind=body.kind, material=body.material))
    return replace(model, bodies=tuple(placed), loads=(concio.Load("weight", tuple(way @ np.array([0.0, 0.0, -1.0]))),))


def motion(model, way, steps, restitution=0.3):
    """Places and velocities after steps on a base that accelerates along a direction of its own."""
    stepper, state = stepper_of(model, scheme=Scheme(restitution=restitution))
    ground = Drive(way @ np.array([2.0, 1.0, 0.5]), np.zeros(3), {})
    for k in range(steps):
        state, report = stepper.step(state, 1e-3, ground if k < steps // 2 else STILL)
        assert report.solution.residual < 1e-9
    return state


def steps_of(kind):
    return {"flight": 20, "impacts": 60}[kind]


@pytest.mark.long
@pytest.mark.parametrize("kind", ["flight", "impacts"])
@pytest.mark.parametrize("seed", range(sample(1, 4)))
def test_a_motion_that_is_turned_with_its_gravity_is_turned(kind, seed):
    turn = Rotation.random(random_state=seed).as_matrix()
    plain, other = (motion(scene(way), way, steps_of(kind)) for way in (np.eye(3), turn))
    assert other.centre @ turn == pytest.approx(plain.centre, abs=1e-10)
    assert other.velocity @ turn == pytest.approx(plain.velocity, abs=1e-9)
    assert turn.T @ other.rotation @ turn == pytest.approx(plain.rotation, abs=1e-10)
    assert (np.abs(plain.spin[1]).max() > 0.1) == (kind == "impacts")


@pytest.mark.parametrize("kind", ["flight", "impacts"])
def test_a_motion_that_is_mirrored_is_mirrored(kind):
    plain = motion(scene(np.eye(3)), np.eye(3), steps_of(kind))
    other = motion(scene(np.eye(3), mirrored=True), MIRROR, steps_of(kind))
    assert other.centre @ MIRROR == pytest.approx(plain.centre, abs=1e-10)
    assert MIRROR @ other.rotation @ MIRROR == pytest.approx(plain.rotation, abs=1e-10)
    assert -other.spin @ MIRROR == pytest.approx(plain.spin, abs=1e-8)  # spins are axial
