"""A bridge under its working axle: joints that open, slip or crush, pressure, deflection; a support that settles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.result import Result
from concio.analysis.step import solve
from concio.errors import InputError
from concio.model.actions import Support
from concio.model.model import Model
from concio.problem.pair_state import PairState
from concio.problem.solution import Status
from concio.representation import short_repr

OPEN = 1e-3
"""A joint is reported to be open where more than this share of its length is."""
CLEAR = 1e-6
"""Openings and slips of rigid blocks below this are those of vanishing compliance, and are reported as none [m]."""


SETTLED = 0.05
"""Settlements above this share of the size of a bridge are refused: mostly millimetres."""
EDGE = 0.01
"""A joint whose loaded part is shorter than this share of its length is pressed at its edge alone."""


@short_repr
@dataclass(frozen=True, eq=False)
class ServiceState:
    """One load step of the bridge with the vehicle where it is worst, at its own weight.

    Parameters
    ----------
    status : Status
    result : Result
    open_joints, slipping, crushed : int
        Joints that are open over a part of their length, that slip, and pairs of joints at their strength;
        soil that presses with all that it can is none of them.
    largest_pressure : float
        Largest mean pressure on the loaded part of a joint, N / (2 (l/2 - |e|) b) [kN/m2]; ``inf`` where a joint is
        pressed at its edge alone, which only joints with a strength can tell.
    deflection : float
        Largest downward displacement that the vehicle adds [m]; nan where blocks and joints are rigid.
    soil : float
        Sum of the pressure of the soil on the masonry [kN].
    """

    status: Status
    result: Result
    open_joints: int
    slipping: int
    crushed: int
    largest_pressure: float
    deflection: float
    soil: float


def service_state(model: Model, settled: Mapping[str, float] | None = None) -> ServiceState:
    """Return the state of a model under all of its loads at factor 1.

    Parameters
    ----------
    model : Model
        With the vehicle on it.
    settled : mapping of str to float, optional
        Downward settlement of fixed bodies by name [m].

    Raises
    ------
    InputError
        A body that is to settle is not a fixed one of the model.
    """
    model = with_settlement(model, settled or {})
    found = solve(model, on_failure="return")
    if not found.solved:
        return ServiceState(found.status, found, 0, 0, 0, float("nan"), float("nan"), float("nan"))
    joints = found.joints
    loaded = 1e-9 * float(np.abs(joints.N).max(initial=0.0)) < joints.N
    e = np.where(loaded, np.abs(np.nan_to_num(joints.eccentricity)), 0.0)
    thickness = np.array([b.thickness for b in model.bodies])
    width = np.minimum(thickness[joints.body_a], thickness[joints.body_b])
    strip = 2 * (0.5 * joints.length - e)
    edge = strip < EDGE * joints.length
    pressure = np.where(loaded, np.where(edge, np.inf, joints.N / np.where(edge, 1.0, strip * width)), 0.0)
    ties = found.ties
    soil = float(sum(ties.tension[k] for k, t in enumerate(model.ties) if t.kind == "soil"))
    of_joints = found.assembly.pairs.interface >= 0
    crushed = int((found.contacts.states.code[of_joints] == PairState.CRUSHED).sum())
    return ServiceState(
        found.status, found, int((joints.open_share > OPEN).sum()), int(joints.slipping.sum()),
        crushed, float(pressure.max(initial=0.0)), _deflection(model, found), soil,
    )  # fmt: skip


def with_settlement(model: Model, settled: Mapping[str, float]) -> Model:
    """Return a model in which fixed bodies have moved down.

    Raises
    ------
    InputError
        There is no fixed body of that name, or it would settle by a part of the size of the bridge.
    """
    fixed = {b.name for b in model.bodies if b.kind == "fixed"}
    for name in settled:
        if name not in fixed:
            msg = f"'{name}' is not a fixed body that could settle"
            raise InputError(msg, hint="one of " + ", ".join(sorted(fixed)))
        if not abs(settled[name]) <= SETTLED * model.size:
            msg = f"'{name}' would settle by {settled[name]:g} m, on a bridge of {model.size:.3g} m"
            raise InputError(msg, hint="a bare number is in m: write '10 mm' where it is in millimetres")
    moved = tuple(
        Support(f"{name} settles", name, displacement=(0.0, -float(d)), group="settlement")
        for name, d in settled.items()
    )
    return replace(model, supports=(*model.supports, *moved))


def _deflection(model: Model, found: Result) -> float:
    """Return the largest downward displacement that the vehicle adds [m]."""
    vehicle = model.vehicle
    deforms = any(b.kind == "elastic" for b in model.bodies)
    deforms |= all(law.normal_stiffness is not None for law in model.laws.values())
    if vehicle is None or vehicle.group not in found.assembly.groups or not deforms:
        return float("nan")
    before = solve(found.assembly, factors={vehicle.group: 0.0}, on_failure="return")
    if not before.solved:
        return float("nan")
    most = 0.0
    for body in model.free_bodies:
        down = before.node_displacement(body.name)[:, 1] - found.node_displacement(body.name)[:, 1]
        most = max(most, float(down.max()))
    return most
