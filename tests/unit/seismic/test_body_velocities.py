"""The rigid motion of bodies of every kind in a velocity of all unknowns."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.seismic.macro_blocks import body_velocities, carried
from models import box, on_ground


@pytest.mark.parametrize("dim", [2, 3])
def test_elastic_and_rigid_bodies_move_alike(dim: int) -> None:
    """Far from the origin of coordinates, of no symmetry; the fixed one stays."""
    rng = np.random.default_rng(5)
    flat = on_ground(
        box("soft", 2.0, 3.0, 0.0, 2.5, material="block"),
        box("hard", 3.0, 4.5, 0.0, 1.0, kind="rigid", material="stone"),
    )
    assembly = concio.assemble(flat if dim == 2 else concio.extrude(flat, 0.7))
    disc = assembly.disc
    wanted = rng.uniform(-1.0, 1.0, (3, 3 if dim == 2 else 6))
    wanted[0] = 0.0
    velocity = np.zeros(disc.unknowns)
    for b in (1, 2):
        own = slice(disc.offsets[b], disc.offsets[b + 1])
        if b == 2:
            velocity[own] = np.concatenate([wanted[b, :dim], wanted[b, dim:] * disc.reach[b]])
        else:
            arm = disc.nodes(b) - disc.centroids[b]
            turn = wanted[b, dim:]
            swept = turn * np.column_stack([-arm[:, 1], arm[:, 0]]) if dim == 2 else np.cross(turn, arm)
            velocity[own] = (wanted[b, :dim] + swept).ravel()
            assert carried(wanted[b], arm) == pytest.approx(wanted[b, :dim] + swept)
    assert body_velocities(assembly, velocity) == pytest.approx(wanted, abs=1e-12)
