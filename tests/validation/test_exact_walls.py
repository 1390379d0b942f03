"""Walls 1 to 5 of Ferris and Tin-Loi, and arches, as fractions.

Source: M. C. Ferris and F. Tin-Loi, Int. J. Mech. Sci. 43 (2001) 209-224, five digits. The fraction of wall 1 was also
found by an exact solver of another kind (elimination in whole numbers), from the same coordinates in fortieths of a
metre.
"""

from __future__ import annotations

from fractions import Fraction

import pytest
from validation_cases.ferris_tin_loi import model

import concio
from concio.proof import verify
from concio.proof.exact_certificate import prove_limit
from rigid_walls import BLOCK, MU, TALLER

WALL_1 = Fraction(666061409848, 1036092527933)


@pytest.mark.parametrize(("name", "published"), [("wall 1", 0.64286), ("wall 2", 0.58000), ("wall 3", 0.40369)])
def test_multipliers_are_fractions(name: str, published: float) -> None:
    made = prove_limit(concio.assemble(model(name)), numbers="decimal")
    assert made["lower"] == made["upper"]
    assert float(Fraction(made["lower"])) == pytest.approx(published, abs=5e-6)
    if name == "wall 1":
        assert Fraction(made["lower"]) == WALL_1


@pytest.mark.parametrize(("name", "published"), [("wall 4", 0.33195), ("wall 5", 0.23964)])
def test_walls_with_two_openings_are_fractions(name: str, published: float) -> None:
    wall = concio.wall_of_courses(
        TALLER[name], block_size=BLOCK, friction=MU, block=concio.Rigid(unit_weight=1.0), horizontal=1.0
    )
    made = prove_limit(concio.assemble(wall), numbers="decimal")
    assert made["lower"] == made["upper"]
    assert float(Fraction(made["lower"])) == pytest.approx(published, abs=5e-6)


@pytest.mark.long  # test_arches_are_fractions
def test_wall_six_is_a_fraction_of_two_hundred_digits() -> None:
    """146 blocks with four openings; the linear programme in floating point is the only other number we have."""
    wall = concio.wall_of_courses(
        TALLER["wall 6"], block_size=BLOCK, friction=MU, block=concio.Rigid(unit_weight=1.0), horizontal=1.0
    )
    assert len(wall.free_bodies) == 146
    found = concio.limit(wall, path=False, steps=False, search=False)
    made = found.proof(numbers="decimal")
    assert made["lower"] == made["upper"]
    assert float(Fraction(made["lower"])) == pytest.approx(found.associated.multiplier, rel=1e-10)
    assert "proved exactly" in verify.check(made)


@pytest.mark.parametrize("voussoirs", [9, 27])
def test_arches_are_fractions(voussoirs: int) -> None:
    """An arch is symmetric to rounding: its last corner has several bases, and a few pivots in fractions decide."""
    arch = concio.arch(
        span=4.0, ring=0.5, voussoirs=voussoirs, friction=0.7, crown_load=2.0, unit_weight=25.0, block="rigid"
    )
    found = concio.limit(arch, path=False, steps=False, search=False)
    made = found.proof()
    assert made["lower"] == made["upper"]
    assert "proved exactly" in verify.check(made)
    assert float(Fraction(made["lower"])) == pytest.approx(found.associated.multiplier, rel=1e-7)
