"""Walls 1 to 3 of Ferris and Tin-Loi as fractions.

Source: M. C. Ferris and F. Tin-Loi, Int. J. Mech. Sci. 43 (2001) 209-224, five digits. The fraction of wall 1 was also
found by an exact solver of another kind (elimination in whole numbers), from the same coordinates in fortieths of a
metre.
"""

from __future__ import annotations

from fractions import Fraction

import pytest
from validation_cases.ferris_tin_loi import model

import concio
from concio.proof.certificate import prove_limit

WALL_1 = Fraction(666061409848, 1036092527933)


@pytest.mark.parametrize(("name", "published"), [("wall 1", 0.64286), ("wall 2", 0.58000), ("wall 3", 0.40369)])
def test_multipliers_are_fractions(name: str, published: float) -> None:
    made = prove_limit(concio.assemble(model(name)), numbers="decimal")
    assert made["lower"] == made["upper"]
    assert float(Fraction(made["lower"])) == pytest.approx(published, abs=5e-6)
    if name == "wall 1":
        assert Fraction(made["lower"]) == WALL_1
