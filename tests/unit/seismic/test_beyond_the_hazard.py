"""zeta_E beyond the largest acceleration of a site, and limit states beyond the end of a table of return periods."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.seismic.checks import capacity_acceleration
from concio.errors import InputError
from concio.verdict.assessment_notes import assessment_notes as attention
from samples import sample

PLACE = {"F0": 2.45, "Tc": 0.32}


def site(a_g: float, *, table: bool) -> concio.Site:
    """Return a site on rock, where the spectrum is proportional to a_g; of a table with one shape of spectrum."""
    if not table:
        return concio.Site({"SLV": {"a_g": a_g, **PLACE}})
    rows = [{"T_R": T_R, "a_g": a_g * share, **PLACE} for T_R, share in ((30, 0.3), (475, 1.0), (2475, 1.6))]
    return concio.Site(rows)


@given(st.booleans(), st.floats(0.02, 0.6), st.floats(0.05, 200.0), st.floats(0.0, 0.3))
def test_the_acceleration_that_is_borne_is_the_share_of_demand_and_capacity(
    table: bool, a_g: float, ratio: float, period: float
) -> None:
    """On rock at short periods the spectrum is a_g times a shape: beyond 1 g, or the table, it was infinite."""
    place = site(a_g, table=table)
    hazard = place.at("SLV")

    def demand(h: object) -> float:
        return float(place.spectrum(h).acceleration(period))

    borne = capacity_acceleration(place, hazard, ratio * demand(hazard), demand)
    assert borne == pytest.approx(ratio * hazard.a_g, rel=1e-6)


@settings(max_examples=sample(2, 6, 20), deadline=None)
@given(st.booleans(), st.floats(0.8, 1.9), st.floats(0.1, 0.5))
def test_a_wide_block_has_a_finite_zeta(table: bool, slender: float, a_g: float) -> None:
    """Width over height times g over the confidence factor, over the acceleration of the ground over q."""
    block = concio.column(
        width=slender, height=1.0, blocks=1, block="rigid", friction=100.0, unit_weight=20.0, thickness=50.0
    )
    found = concio.assess(block, site=site(a_g, table=table), levels=["SLV"], direction="right", knowledge="LC3", q=2.0)
    (check,) = (c for c in found.worst.checks if c.kind == "linear")
    assert found.worst.multiplier == pytest.approx(slender)
    assert check.zeta == pytest.approx(2.0 * slender / found.confidence / a_g, rel=1e-3)
    assert math.isfinite(found.zeta)


@given(st.floats(40.0, 3000.0), st.sampled_from(["I", "II", "III", "IV"]), st.floats(20.0, 100.0))
def test_a_table_says_nothing_of_return_periods_beyond_its_end(last: float, use: str, nominal: float) -> None:
    """The acceleration of 200 years stood for that of 475, and walls were verified."""
    rows = [{"T_R": 30.0, "a_g": 0.05, **PLACE}, {"T_R": last, "a_g": 0.2, **PLACE}]
    place = concio.Site(rows, nominal_life=nominal, use_class=use)
    for level in ("SLD", "SLV", "SLC"):
        period = min(place.rules.return_period(level, place.life), 2475.0)
        if period > 1.01 * last:
            assert level not in place.levels
            with pytest.raises(InputError, match="ends at"):
                place.at(level)
        elif period <= last:
            assert level in place.levels
            assert place.at(level).a_g == pytest.approx(0.2 if period >= last else place.interpolated(period).a_g)


@settings(max_examples=sample(2, 6, 20), deadline=None)
@given(st.sampled_from(["I", "II", "III", "IV"]), st.floats(50.0, 2000.0), st.sampled_from(["en", "it"]))
def test_a_hazard_of_another_return_period_is_said(use: str, given_period: float, language: str) -> None:
    """The acceleration of 200 years, stated as such for SLV, was taken for that of 475 without a word."""
    place = concio.Site({"SLV": {"a_g": 0.1, "T_R": given_period, **PLACE}}, use_class=use)
    block = concio.column(width=1.0, height=2.0, blocks=1, block="rigid", unit_weight=20.0, thickness=50.0)
    found = concio.assess(block, site=place, levels=["SLV"], direction="right")
    own = -place.life / math.log(0.9)
    lines = [line for line in attention(found, language) if ("return period" in line or "periodo di ritorno" in line)]
    assert bool(lines) == (abs(given_period - own) > 0.01 * own)
