"""Spectra, limits of displacement and lines of checks, against the formulas of the code written out case by case."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

import concio
from concio.analysis.seismic.checks import Check, limit_of
from concio.analysis.seismic.curve import CapacityCurve
from concio.analysis.seismic.floor import FloorSpectrum, Mode, Storeys
from concio.analysis.seismic.spectrum import Spectrum
from concio.errors import InputError

ONE = Spectrum(a_g=1.7, S=1.25, F0=2.6, T_B=0.13, T_C=0.41, T_D=2.3, T_E=5.5, T_F=9.0)
OTHER = Spectrum(a_g=3.1, S=1.4, F0=2.2, T_B=0.2, T_C=0.7, T_D=1.6, T_E=4.5, T_F=10.0, damping=(10.0, 5.0, 0.55))


def acceleration(s: Spectrum, T: float, xi: float) -> float:
    """NTC 2018 (3.2.2)."""
    eta = max(math.sqrt(10.0 / (5.0 + xi)), 0.55)
    plateau = s.a_g * s.S * eta * s.F0
    if s.T_B > T:
        return plateau * (T / s.T_B + 1.0 / (eta * s.F0) * (1.0 - T / s.T_B))
    if s.T_C > T:
        return plateau
    return plateau * s.T_C / T if s.T_D > T else plateau * s.T_C * s.T_D / T**2


def displacement(s: Spectrum, T: float, xi: float) -> float:
    """NTC 2018 (3.2.3.2.3): d_g = 0.025 a_g S T_C T_D, reached at T_F."""
    eta = max(math.sqrt(10.0 / (5.0 + xi)), 0.55)
    d_g = 0.025 * s.a_g * s.S * s.T_C * s.T_D
    if s.T_E >= T:
        return acceleration(s, T, xi) * (T / (2 * math.pi)) ** 2
    if s.T_F >= T:
        return d_g * (s.F0 * eta + (1 - s.F0 * eta) * (T - s.T_E) / (s.T_F - s.T_E))
    return d_g


@pytest.mark.parametrize("spectrum", [ONE, OTHER])
@pytest.mark.parametrize("xi", [0.0, 2.0, 5.0, 12.0, 28.0, 60.0])
def test_spectra_are_those_of_the_code_on_every_branch(spectrum: Spectrum, xi: float) -> None:
    T = np.concatenate([[1e-6], np.linspace(0.01, 12.0, 400)])
    assert spectrum.acceleration(T, xi) == pytest.approx([acceleration(spectrum, t, xi) for t in T], rel=1e-12)
    assert spectrum.displacement(T, xi) == pytest.approx([displacement(spectrum, t, xi) for t in T], rel=1e-12)
    assert float(spectrum.acceleration(0.0, xi)) == pytest.approx(spectrum.a_g * spectrum.S)
    for at in (spectrum.T_B, spectrum.T_C, spectrum.T_D):
        near = spectrum.acceleration(np.array([at - 1e-9, at + 1e-9]), xi)
        assert near[0] == pytest.approx(near[1], rel=1e-7)
    far = spectrum.displacement(np.array([spectrum.T_F - 1e-9, spectrum.T_F + 1e-9]), xi)
    assert far[0] == pytest.approx(far[1], rel=1e-7)


def test_damping_has_the_least_of_the_code() -> None:
    assert ONE.eta() == 1.0
    assert ONE.eta(0.0) == pytest.approx(math.sqrt(2.0))
    assert ONE.eta(28.06) == pytest.approx(0.55, abs=1e-4)
    assert ONE.eta(1000.0) == 0.55


ALPHA, AT = np.array([0.30, 0.24, 0.12, 0.0]), np.array([0.0, 0.2, 0.2, 0.8])
CURVE = CapacityCurve("followed", AT, ALPHA, 0.8, "falls", (0.2,))
RULE = {"share": 0.4, "period": 1.68, "damping": 8.0}


def test_a_limit_of_displacement_is_the_least_of_share_ties_and_what_was_given() -> None:
    """At 0.32 m alpha is 0.12 (0.8 - 0.32) / 0.6 = 0.096; spectral quantities by their factors 0.9 and 11."""
    found = limit_of("SLV", RULE, CURVE, 0.9, 11.0)
    assert (found.control, found.why, found.xi, found.level) == (pytest.approx(0.32), "share", 8.0, "SLV")
    assert found.d == pytest.approx(0.9 * 0.32)
    assert found.a == pytest.approx(11.0 * 0.096)
    assert pytest.approx(1.68 * math.pi * math.sqrt(0.288 / 1.056)) == found.T
    ties = limit_of("SLV", {**RULE, "mark": "ties"}, CURVE, 0.9, 11.0)
    assert (ties.control, ties.why) == (pytest.approx(0.2), "ties")
    assert ties.a == pytest.approx(11.0 * 0.12)
    given = limit_of("SLV", {**RULE, "mark": "ties"}, CURVE, 0.9, 11.0, given=0.1)
    assert (given.control, given.why) == (pytest.approx(0.1), "given")
    assert given.a == pytest.approx(11.0 * 0.27)
    assert limit_of("SLV", RULE, CURVE, 0.9, 11.0, given=0.5).why == "share"
    assert math.isinf(limit_of("SLC", {**RULE, "share": 1.0}, CURVE, 0.9, 11.0).T)
    for stiffness, a in ((3.0, 3.0 * 0.288), (4.0, 11.0 * 0.096)):
        branch = SimpleNamespace(stiffness=stiffness)
        found = limit_of("SLV", RULE, CURVE, 0.9, 11.0, branch=branch)
        assert found.a == pytest.approx(a), "an element that is free to vibrate is no stiffer than its branch"
        assert pytest.approx(1.68 * math.pi * math.sqrt(0.288 / a)) == found.T


def test_a_line_holds_where_capacity_meets_demand_or_nothing_moves() -> None:
    plain = {"level": "SLV", "place": "ground", "a_g": 0.2, "zeta": 0.8, "clause": ""}
    for capacity, demand, holds in ((2.0, 1.9, True), (2.0, 2.0, True), (2.0, 2.1, False)):
        for kind in ("onset", "linear", "displacement"):
            check = Check(kind=kind, capacity=capacity, demand=demand, **plain)
            assert (check.holds, check.at_rest) == (holds, False)
            assert check.ratio == pytest.approx(capacity / demand)
            assert check.unit == ("m" if kind == "displacement" else "m/s2")
    assert Check(kind="onset", capacity=2.0, demand=0.0, **plain).ratio == math.inf
    for least, rest in ((0.19, False), (0.2, True), (0.21, True)):
        moved = Check(kind="displacement", capacity=1.0, demand=3.0, least=least, site_a_g=0.2, **plain)
        assert (moved.at_rest, moved.holds) == (rest, rest)
        assert not Check(kind="linear", capacity=1.0, demand=3.0, least=least, site_a_g=0.2, **plain).at_rest


RULES = {
    "amplification": {"factor": 1.1, "power": -0.5}, "velocity_damping": 0.0004, "lower": {"share": 0.8, "power": 1.6},
    "upper": {"share": 1.1, "power": 1.2}, "height": {"b": 1.1}, "period": {"factor": 0.05, "power": 0.75},
}  # fmt: skip
MODES = (Mode(0.62, 1.25, 0.2, 8.0), Mode(0.21, -0.4, 0.6, 6.0))


def at_height(T: float, xi: float) -> float:
    """Circolare 7/2019, C7.2.3, of two modes."""
    eta, squares = max(math.sqrt(10.0 / (5.0 + xi)), 0.55), 0.0
    for mode in MODES:
        a_Z = acceleration(ONE, mode.T, mode.xi) * abs(mode.participation * mode.shape)
        a_Z *= math.sqrt(1 + 0.0004 * mode.xi**2)
        K, a, b = 1.1 * (mode.xi / 100) ** -0.5 * eta, 0.8, 1.1
        if a * mode.T > T:
            own = K * a_Z / (1 + (K - 1) * (1 - T / (a * mode.T)) ** 1.6)
        elif b * mode.T >= T:
            own = K * a_Z
        else:
            own = K * a_Z / (1 + (K - 1) * (T / (b * mode.T) - 1) ** 1.2)
        squares += own**2
    return math.sqrt(squares)


@pytest.mark.parametrize("xi", [2.0, 5.0, 11.0])
def test_floor_spectra_are_those_of_the_code_for_two_modes(xi: float) -> None:
    floor = FloorSpectrum(ONE, MODES, RULES)
    T = np.linspace(0.01, 6.0, 300)
    wanted = np.array([at_height(t, xi) for t in T])
    assert floor.filtered(T, xi) == pytest.approx(wanted, rel=1e-12)
    ground = np.array([acceleration(ONE, t, xi) for t in T])
    least = np.where(T > 0.62, np.maximum(wanted, ground), wanted)
    assert (least > wanted).any(), "on the ground it is more than what the modes bring, at long periods"
    assert floor.acceleration(T, xi) == pytest.approx(least, rel=1e-12)
    plain = least * (T / (2 * math.pi)) ** 2
    at = at_height(0.62, xi) * (1.1 * 0.62 / (2 * math.pi)) ** 2
    assert floor.displacement(T, xi) == pytest.approx(np.where(T > 1.1 * 0.62, np.maximum(plain, at), plain), rel=1e-12)


@pytest.mark.parametrize(("z", "shape"), [(-2.0, 0.0), (1.0, 0.0), (5.0, 0.5), (9.0, 1.0), (30.0, 1.0)])
def test_the_first_mode_grows_from_the_base_to_the_top(z: float, shape: float) -> None:
    building = Storeys(height=8.0, storeys=3, xi=4.0, base=1.0)
    mode = building.mode(z, RULES)
    assert (mode.participation, mode.shape, mode.xi) == pytest.approx((9.0 / 7.0, shape, 4.0))
    assert pytest.approx(0.05 * 8.0**0.75) == mode.T
    assert Storeys(height=8.0, T1=0.3).mode(z, RULES).T == 0.3
    assert Storeys(height=8.0).mode(z, RULES).participation == pytest.approx(1.0)


@pytest.mark.parametrize("wrong", [
    {"height": 0.0}, {"height": -3.0}, {"height": math.inf}, {"height": 3.0, "storeys": 0},
    {"height": 3.0, "storeys": 1.5}, {"height": 3.0, "T1": 0.0}, {"height": 3.0, "xi": -1.0},
    {"height": 3.0, "xi": math.inf},
])  # fmt: skip
def test_a_building_of_no_height_or_of_part_of_a_storey_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError):
        Storeys(**wrong)


@pytest.mark.parametrize("where", ["ground", "height"])
def test_one_period_at_a_time_gives_what_all_at_once_give(where: str) -> None:
    place = concio.Site({"SLV": {"a_g": 0.2, "F0": 2.45, "Tc": 0.32}}, soil="B", building={"height": 6.5, "storeys": 2})
    ground = place.spectrum(place.at("SLV"))
    spectrum = ground if where == "ground" else place.at_height(ground, 4.0)
    assert spectrum is not None
    periods = np.linspace(0.0, 12.0, 4001)
    for xi in (5.0, 8.0):
        for of in (spectrum.acceleration, spectrum.displacement):
            assert [float(of(float(T), xi)) for T in periods] == pytest.approx(of(periods, xi), rel=1e-14, abs=1e-300)
