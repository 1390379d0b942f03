"""What interlocked blocks hold of a facade, beside the formula of the Circolare for a comb-shaped crack."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import concio
from concio import Body, JointLaw, Load, Model, Rigid
from seismic_walls import site

HB, OVERLAP, T, TS, MU, W, WIDTH = 0.25, 0.25, 0.25, 0.25, 0.577, 18.0, 1.0
"""Course, overlap, thickness of facade and return, friction, unit weight, width of facade for one return."""


def toothed(n: int, mu: float = MU) -> Model:
    """Return the elevation of a return wall whose every other course holds a tooth of the facade, left of x = T."""
    base = np.array([[-1.0, -0.3], [3.0, -0.3], [3.0, 0.0], [-1.0, 0.0]])
    bodies = [Body("base", base, kind="fixed", thickness=TS)]
    teeth = [f"f{k}" for k in range(n)]
    loads = [Load("weight", (0, -1)), Load("weight", (-1, 0), bodies=tuple(teeth), group="live")]
    rest = (WIDTH - TS) * T * HB * W  # what of the facade stands beside the return
    for k in range(n):
        edges = [0.0, T + (OVERLAP if k % 2 else 0.0)]
        while edges[-1] < 2.0 - 1e-9:
            edges.append(min(edges[-1] + 2 * OVERLAP, 2.0))
        for j, (x0, x1) in enumerate(pairwise(edges)):
            corners = np.array([[x0, k * HB], [x1, k * HB], [x1, (k + 1) * HB], [x0, (k + 1) * HB]])
            bodies.append(Body(f"r{k}.{j}" if j else f"f{k}", corners, kind="rigid", thickness=TS))
        at = (T / 2, (k + 0.5) * HB)
        loads += [Load("point", (0, -rest), bodies=(f"f{k}",), at=at),
                  Load("point", (-rest, 0), bodies=(f"f{k}",), at=at, group="live")]  # fmt: skip
    return Model(tuple(bodies), {"block": Rigid(W)}, {"joint": JointLaw(mu)}, loads=tuple(loads))


def by_formula(n: int, share: float) -> float:
    """Return the least alpha_0 of overturning with F = share n (n + 1) Phi mu l^2 t_s w at a third of the height."""
    found = []
    for k in range(1, n + 1):
        h = k * HB
        F = share * k * (k + 1) * (HB / OVERLAP) * MU * OVERLAP**2 * TS * W
        weight = WIDTH * T * h * W
        found.append((weight * T / 2 + F * h / 3) / (weight * h / 2))
    return min(found)


@pytest.mark.long
def test_interlocked_blocks_hold_what_the_full_weight_above_their_joints_does() -> None:
    """Joint k of a comb carries k courses, n (n + 1)/2 in all: the Circolare counts 0.4 of it in place of 0.5."""
    found = concio.assess(toothed(6), site=site(), levels=["SLD"], direction="right", live="live")
    worst = next(m for m in found.mechanisms if m.name == "weakest of all")
    assert worst.found.flow == "Coulomb"
    assert by_formula(6, 0.0) == pytest.approx(T / 1.5)  # no friction: one facade that topples alone
    assert by_formula(6, 0.4) < worst.multiplier < worst.found.associated.multiplier
    assert worst.multiplier == pytest.approx(by_formula(6, 0.5), rel=0.04)
    assert worst.multiplier == pytest.approx(0.5042, abs=1e-4)
