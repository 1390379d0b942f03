"""Spectra, floor spectra and sites: numbers of the worked example, limits of the formulas, refused input."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from concio.analysis.seismic.code import find_code
from concio.analysis.seismic.floor import FloorSpectrum, Mode, Storeys
from concio.analysis.seismic.site import Hazard, Site
from concio.analysis.seismic.variations import _way_of
from concio.errors import InputError

SLV = {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}


def site(**more: object) -> Site:
    return Site(**{"hazard": {"SLV": SLV}, "soil": "B", **more})  # type: ignore[arg-type]


def test_spectrum_of_the_worked_example() -> None:
    spectrum = site().spectrum(site().at("SLV"))
    assert pytest.approx(1.2) == spectrum.S
    assert pytest.approx(0.147364, abs=5e-7) == spectrum.T_B
    assert pytest.approx(0.442092, abs=5e-7) == spectrum.T_C
    assert pytest.approx(2.4) == spectrum.T_D
    assert float(spectrum.displacement(2.85835, 8.0)) == pytest.approx(0.135969, abs=5e-7)
    assert float(spectrum.acceleration(0.25, 10.0)) == pytest.approx(4.709781, abs=5e-7)


def test_floor_spectrum_of_the_worked_example() -> None:
    place = site(building={"height": 6.0, "storeys": 2, "T1": 0.25, "xi": 10.0})
    floor = place.at_height(place.spectrum(place.at("SLV")), 3.0)
    assert floor is not None
    mode = floor.modes[0]
    assert mode.participation == pytest.approx(1.2)
    assert floor.peak(mode) == pytest.approx(2.881832, abs=5e-7)
    assert floor.amplification(mode, 8.0) == pytest.approx(3.0509, abs=5e-5)
    assert float(floor.filtered(0.25, 8.0)) == pytest.approx(8.792040, abs=5e-6)
    assert float(floor.filtered(1.0, 8.0)) == pytest.approx(1.162418, abs=5e-7)


def test_at_period_zero_the_floor_moves_with_its_modes() -> None:
    ground = site().spectrum(site().at("SLV"))
    floor = FloorSpectrum(ground, (Mode(0.25, 1.2, 0.5, 10.0),), find_code("ntc2018").tables["floor"])
    assert float(floor.acceleration(0.0)) == pytest.approx(floor.peak(floor.modes[0]))


def test_period_of_a_regular_building_from_its_height() -> None:
    rules = find_code("ntc2018").tables["floor"]
    assert pytest.approx(0.05 * 8.0) == Storeys(height=16.0, storeys=4).mode(8.0, rules).T


@given(st.floats(0.01, 0.6), st.sampled_from("ABCDE"), st.sampled_from(["ntc2018", "en1998"]), st.floats(0.0, 20.0))
def test_spectra_are_continuous_and_not_negative(a_g: float, soil: str, code: str, T: float) -> None:
    place = Site(hazard={"SLV": {"a_g": a_g}}, soil=soil, code=code)
    spectrum = place.spectrum(place.at("SLV"))
    for kind in (spectrum.acceleration, spectrum.displacement):
        assert float(kind(T, 8.0)) >= 0
    corners = np.array([spectrum.T_B, spectrum.T_C, spectrum.T_D, spectrum.T_F])
    for kind in (spectrum.acceleration, spectrum.displacement):
        assert kind(corners * (1 - 1e-9)) == pytest.approx(kind(corners * (1 + 1e-9)), rel=1e-6)
    # at T_E the code itself jumps: the ground moves by 0.025 a_g S T_C T_D, where 1/(4 pi^2) would be continuous
    before, after = spectrum.displacement(spectrum.T_E * np.array([1 - 1e-9, 1 + 1e-9]))
    assert after / before == pytest.approx(0.025 * 4 * math.pi**2, rel=1e-6)


def test_return_periods_of_an_ordinary_building() -> None:
    rules = find_code("ntc2018")
    assert rules.reference_life(50.0, "II") == 50.0
    assert rules.reference_life(20.0, "I") == 35.0
    assert [round(rules.return_period(level, 50.0)) for level in ("SLD", "SLV", "SLC")] == [50, 475, 975]


def test_hazard_between_two_return_periods_is_linear_in_the_logarithms() -> None:
    table = [{"T_R": 30, "a_g": 0.05, "F0": 2.4, "Tc": 0.27}, {"T_R": 475, "a_g": 0.20, "F0": 2.45, "Tc": 0.32}]
    middle = Site(hazard=table).interpolated(math.sqrt(30 * 475))
    assert middle.a_g == pytest.approx(math.sqrt(0.05 * 0.20))
    assert pytest.approx(2.45) == Site(hazard=table).interpolated(475.0).F0


def test_eurocode_spectrum_type_1_soil_c() -> None:
    place = Site(hazard={"SLV": {"a_g": 0.25}}, soil="C", code="en1998")
    spectrum = place.spectrum(place.at("SLV"))
    assert (spectrum.S, spectrum.T_B, spectrum.T_C, spectrum.T_D) == (1.15, 0.20, 0.6, 2.0)
    assert float(spectrum.acceleration(0.3)) == pytest.approx(0.25 * 9.81 * 1.15 * 2.5)


def test_a_code_of_ones_own_stands_on_another(tmp_path: Path) -> None:
    own = tmp_path / "region.toml"
    own.write_text("base = 'ntc2018'\nname = 'Region'\n[topography]\nclause = 'own'\nT1 = 1.5\n", encoding="utf-8")
    place = site(code=str(own))
    assert place.rules.name == "Region"
    assert pytest.approx(1.2 * 1.5) == place.spectrum(place.at("SLV")).S


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"soil": "F"}, "no soil 'F'"),
        ({"topography": "T9"}, "no topography 'T9'"),
        ({"hazard": {"SLV": {"a_g": 1.962}}}, "was 1.962 m/s2 meant"),
        ({"hazard": {"SLX": SLV}}, "no limit state 'SLX'"),
        ({"hazard": {"SLV": {"a_g": 0.2, "Tcc": 0.3}}}, "unknown key 'Tcc'"),
        ({"hazard": {"SLV": {"F0": 2.4}}}, "a_g is missing"),
        ({"hazard": [SLV]}, "needs a return period"),
        ({"use_class": "V"}, "no class of use 'V'"),
        ({"code": "ntc2008"}, "no code 'ntc2008'"),
        ({"building": {"height": 6.0, "storys": 2}}, "unknown key 'storys'"),
        ({"building": {"T": 0.3}}, "not complete"),
    ],
)
def test_bad_sites_are_refused_in_a_sentence(change: dict[str, object], said: str) -> None:
    with pytest.raises(InputError) as error:
        site(**change)
    assert said in str(error.value)


@pytest.mark.parametrize("a_g", ["1.962 m/s2", "196.2 cm/s2", "0.2 g", "0.2g", 0.2])
@pytest.mark.parametrize("Tc", ["0.32 s", "320 ms", 0.32])
def test_acceleration_and_period_may_be_given_with_their_unit(a_g: float | str, Tc: float | str) -> None:
    place = site(hazard={"SLV": {"a_g": a_g, "F0": 2.45, "Tc": Tc}})
    assert place.at("SLV").a_g == pytest.approx(0.20)
    assert place.at("SLV").T_star == pytest.approx(0.32)
    assert Hazard(475.0, 0.2).F0 == 2.5


def test_the_one_direction_of_an_assessment_is_asked_for_again_as_it_was() -> None:
    """Its name has three digits; where a mechanism and a locked part were pushed along two, names tell which."""
    way = (0.61234567, 0.79059847)
    pushed = [SimpleNamespace(direction="(0.612, 0.791)")]
    found = SimpleNamespace(mechanisms=pushed, locked=[], arguments={"direction": way})
    assert _way_of(found, "(0.612, 0.791)") == way
    assert _way_of(SimpleNamespace(mechanisms=pushed, locked=pushed, arguments={"direction": way}), "") == way
    two = SimpleNamespace(mechanisms=pushed, locked=[SimpleNamespace(direction="+x")], arguments={"direction": None})
    assert _way_of(two, "(0.612, 0.791)") == (0.612, 0.791)
    assert _way_of(two, "+x") == "+x"
