"""Associated limit multipliers of walls 1 to 3 of Ferris and Tin-Loi.

Source: M. C. Ferris and F. Tin-Loi, Limit analysis of frictional block assemblies as a mathematical program with
complementarity constraints, Int. J. Mech. Sci. 43 (2001) 209-224. Rigid blocks 0.4 x 0.175, friction 0.65, self-weight
and a horizontal force lambda times the weight on each block. Values to the five digits that are quoted.
"""

from __future__ import annotations

import numpy as np
import pytest

from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.existence import find_mechanism
from concio.solvers.statics.mechanism import verify_mechanism
from rigid_walls import FERRIS_TIN_LOI, MU, running_bond, wall


@pytest.mark.parametrize(
    ("name", "blocks", "interfaces", "wanted"),
    [("wall 1", 33, 83, 0.64286), ("wall 2", 55, 141, 0.58000), ("wall 3", 46, 102, 0.40369)],
)
def test_associated_multiplier(name, blocks, interfaces, wanted):
    a = wall(FERRIS_TIN_LOI[name])
    assert (a.blocks, len(a.points) // 2) == (blocks, interfaces)
    found = associated_limit(a.problem(MU, a.load(0, -1)), a.load(1, 0))
    assert found.multiplier == pytest.approx(wanted, abs=5e-6)
    assert found.checked
    assert found.residual <= 1e-12
    assert found.gap <= 1e-10


def test_multiplier_does_not_depend_on_units_numbering_or_mirror():
    a = wall(FERRIS_TIN_LOI["wall 2"])
    base = associated_limit(a.problem(MU, a.load(0, -1)), a.load(1, 0)).multiplier
    heavy = associated_limit(a.problem(MU, a.load(0, -1e4)), a.load(1e4, 0)).multiplier
    mirrored = associated_limit(a.problem(MU, a.load(0, -1)), a.load(-1, 0)).multiplier
    small = wall(FERRIS_TIN_LOI["wall 2"], (400.0, 175.0))
    millimetres = associated_limit(small.problem(MU, small.load(0, -1)), small.load(1, 0)).multiplier
    assert np.array([heavy, mirrored, millimetres]) == pytest.approx(base, rel=1e-9)


def test_2446_pairs():
    """A wall of 434 blocks: forces and motion bound the multiplier from both sides."""
    a = running_bond(30, 14)
    found = associated_limit(a.problem(0.6, a.load(0, -1)), a.load(1, 0))
    assert found.checked
    assert 0.4 < found.multiplier < 0.6


@pytest.mark.long  # the walls of the paper have the same proofs
def test_10458_pairs():
    """1,785 blocks: both proofs to rounding, and a tenth above the limit a mechanism that proves it."""
    a = running_bond(42, 42)
    p, live = a.problem(0.6, a.load(0, -1)), a.load(1, 0)
    assert p.pairs == 10_458
    found = associated_limit(p, live)
    assert found.residual <= 1e-10
    assert found.mechanism is not None
    assert found.mechanism.violation <= 1e-10
    assert found.gap <= 1e-9
    above = p.with_loads(p.f + 1.1 * found.multiplier * live)
    mechanism = find_mechanism(above)
    assert mechanism is not None
    assert mechanism.violation <= 1e-9
    again = verify_mechanism(above, mechanism.velocity)
    assert again.power == pytest.approx(mechanism.power, rel=1e-12)
    assert again.power > 0
