"""Blocks that move in space: models for the tests of large displacements and dynamics, and the plane extruded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import concio
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.stepper import Stepper
from concio.contact.reference import Reference
from motion_models import G

STILL = Drive(np.zeros(3), np.zeros(3), {})


def blocks(*boxes, friction=0.6, floor=((-5.0, -5.0, -0.5), (5.0, 5.0, 0.0)), turn=None):
    """Rigid boxes over a floor under their weight, all of it turned by a rotation matrix."""
    turn = np.eye(3) if turn is None else turn
    bodies = [concio.Polyhedron.box("floor", *floor, kind="fixed")]
    bodies += [concio.Polyhedron.box(f"b{i}", *box, kind="rigid") for i, box in enumerate(boxes)]
    return concio.Model(
        tuple(replace(b, vertices=b.vertices @ turn.T) for b in bodies), {"block": concio.Rigid(unit_weight=20.0)},
        {"joint": concio.JointLaw(friction)}, loads=(concio.Load("weight", tuple(turn @ np.array([0.0, 0.0, -1.0]))),),
    )  # fmt: skip


def extruded(model, depth, turn):
    """A plane model as a solid of some depth, x and y becoming x and z, then turned."""
    bodies = []
    for body in model.bodies:
        ring, far = body.outline, 0.5 * (depth if body.kind != "fixed" else 8.0)
        n = len(ring)
        sides = [np.column_stack([ring[:, 0], np.full(n, y), ring[:, 1]]) for y in (-far, far)]
        round_ = [(i + n, (i + 1) % n + n, (i + 1) % n, i) for i in range(n)]
        faces = (tuple(range(n)), tuple(range(2 * n - 1, n - 1, -1)), *round_)
        vertices = np.concatenate(sides) @ turn.T
        bodies.append(concio.Polyhedron(body.name, vertices, faces, kind=body.kind, material=body.material))
    return concio.Model(
        tuple(bodies), dict(model.materials), dict(model.laws),
        loads=tuple(replace(load, value=placed(load.value, turn)) for load in model.loads),
        ties=tuple(replace(t, at_a=placed(t.at_a, turn), at_b=placed(t.at_b, turn)) for t in model.ties),
        supports=tuple(_support(support, turn) for support in model.supports),
    )  # fmt: skip


def placed(vector, turn):
    """A vector of the plane as one in space: x and y become x and z, then it is turned."""
    return tuple((turn @ np.array([vector[0], 0.0, vector[1]])).tolist())


def _support(support, turn):
    """A fixed body that is moved; anticlockwise in the plane is about -y."""
    moved = placed(support.displacement, turn) if support.displacement else ()
    return replace(support, displacement=moved, rotation=tuple(turn @ np.array([0.0, -support.rotation, 0.0])))


def stepper_of(model, sag=1.0, scheme=None):
    """A stepper and its first state, joints sinking in by a share of what they do otherwise."""
    stepper = Stepper(Reference.of(model, G), scheme or Scheme())
    for joints in (stepper.maker.joints, stepper.certificate.joints):
        joints.lent, joints.sag = sag * joints.lent, sag * joints.sag
    return stepper, stepper.located(MotionState.at_rest(stepper.reference))
