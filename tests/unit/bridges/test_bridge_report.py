"""The report of a bridge in both languages, its files, and figures."""

from __future__ import annotations

import csv
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from test_bridge_assessment import small, written

import concio
from commands import run
from concio.analysis.bridges.mexe import mexe
from concio.model.plausibility import implausible
from concio.model.road.spread import spread_rules
from concio.model.road.vehicles import vehicles
from concio.report.bridge_page import BridgeReport
from concio.verdict.bridge_verdict import bridge_lines
from concio.verdict.italian import catalogue


@pytest.fixture(scope="module")
def found() -> concio.BridgeResult:
    """Return an assessment of a small bridge."""
    return concio.assess_bridge(small(), step=0.5, fine=0.2, worst=1, checked=2, settled={"right abutment": 0.002})


@pytest.fixture(scope="module")
def page_in(found: concio.BridgeResult) -> Callable[[str], str]:
    """Return what makes the report in a language, once."""

    @cache
    def made(language: str) -> str:
        return BridgeReport(found, language).html()  # type: ignore[arg-type]

    return made


class Balanced(HTMLParser):
    """Counts elements that were opened and not closed."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in ("meta", "link", "img", "input", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.long
@pytest.mark.parametrize(("language", "words"), [("en", "What matters most"), ("it", "Conta di più")])
def test_the_datum_that_matters_most_is_told_in_a_sentence(
    language: str, words: str, found: concio.BridgeResult, page_in: Callable[[str], str]
) -> None:
    sentence = re.search(rf"<p>({words}[^<]*)</p>", page_in(language))
    assert sentence is not None
    most = max(found.changes, key=lambda c: abs(c.at_high - c.at_low))
    numbers = [float(n.replace(",", ".")) for n in re.findall(r" (\d+(?:[.,]\d+)?)(?=[ :;.])", sentence[1])]
    assert numbers[:4] == pytest.approx([most.low, most.high, most.at_low, most.at_high], rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("language", ["en", "it"])
def test_the_report_holds_the_verdict_and_every_section(language: str, page_in: Callable[[str], str]) -> None:
    page = page_in(language)
    parser = Balanced()
    parser.feed(page)
    assert not parser.open
    for key in ("verdict", "summary", "model", "curve", "mechanism", "built", "sensitivity", "service", "film"):
        assert f"<section id={key}>" in page
    assert page.count("<img") >= 4 + 2
    assert ("not checked" in page.lower()) == (language == "en")
    assert ("non verificato" in page.lower()) == (language == "it")
    text = re.sub(r"data:[^\"]*", "", page)
    assert ("due to the pressure of the soil" in text) == (language == "en")
    assert ("dovuto alla spinta del terreno" in text) == (language == "it")


def test_what_limits_an_answer_is_in_the_language_of_the_report() -> None:
    law = concio.JointLaw(0.6, compressive_strength=5000.0)
    crushes = concio.assess_bridge(small(friction=law), step=1.5, fine=0.5, worst=1, checked=0, sensitivity=False)
    for language, words in (("en", "joints of rigid blocks that crush"), ("it", "i giunti di conci rigidi che si")):
        top = BridgeReport(crushes, language).top()  # type: ignore[arg-type]
        assert words in top
        assert ("joints of rigid blocks" in top) == (language == "en")


def test_what_a_permissible_axle_includes_is_said(found: concio.BridgeResult) -> None:
    factored = replace(found, model=replace(found.model, vehicle=replace(found.vehicle, dynamic=1.5)))
    for shown, whether in ((found, False), (factored, True)):
        line = next(line for line in bridge_lines(shown) if line.startswith("  permissible"))
        assert ("without dynamic and partial factors" in line) == whether
    summary = BridgeReport(factored, "it").summary()
    assert "con coefficienti dinamico e parziale" in summary
    assert "senza coefficienti dinamico e parziale" in summary


@pytest.mark.long  # its figures are drawn
def test_the_report_tells_every_datum_that_was_given_and_has_no_english_in_italian(
    found: concio.BridgeResult, page_in: Callable[[str], str]
) -> None:
    """All of geometry, materials and soil is in the table of data; the film begins where the vehicle is worst."""
    page = page_in("it")
    text = re.sub(r"<[^>]*>", " ", re.sub(r"data:[^\"]*|<style>.*?</style>", "", page))
    for datum in ("luci nette 3 m", "frecce 0,75 m", "0,215 m", "conci di un anello 12", "blocchi rigidi, 22 kN/m3",
                  "ricoprimento in chiave 0,3 m", "riempimento 20 kN/m3", "costante; peso proprio, "):  # fmt: skip
        assert datum in re.sub(r"\s+", " ", text), datum
    for english in ("self-weight", "constant;", "the whole width", "fill unit weight", "no_equilibrium",
                    "are taken as", "to each side"):
        assert english not in text
    film = page[page.index("<section id=film>") :]
    begin = int(re.findall(r'<input [^>]*value="(\d+)"', film)[0])
    shown = [k for k, tag in enumerate(re.findall(r"<img[^>]*?src", film)) if " hidden " not in tag]
    assert shown == [begin]
    place = re.findall(r'alt="x = ([-\d,]+) m"', film)[begin]
    assert float(place.replace(",", ".")) == pytest.approx(found.worst.position, abs=1e-2)


@pytest.mark.long
def test_a_vehicle_without_axles_is_told_by_its_load_along_the_road() -> None:
    model = concio.with_vehicle(small(), concio.find_vehicle("SW/0"))
    found = concio.assess_bridge(model, step=1.0, fine=1.0, worst=1, checked=1, sensitivity=False)
    told = " ".join(bridge_lines(found))
    assert "133 kN/m along the road, no axles" in told
    assert "1995" not in told
    assert found.summary()["axle"] is None
    assert found.summary()["vehicle"]["uniform_load"] == pytest.approx(133.0)


def test_what_the_library_and_the_formula_say_is_known_in_italian() -> None:
    """Sources that cite a code stay as they are."""
    said = [v.assumed for v in vehicles().values() if v.assumed]
    said += [rule.source for name, rule in spread_rules().items() if name in ("none", "uniform 1:2")]
    said += [line for span, rise, ring, depth in ((1.0, 0.1, 0.4, 0.4), (6.0, 2.0, 1.0, 1.0), (6.0, 2.0, 0.4, 0.4))
             for line in mexe(span, rise, 0.7 * rise, ring, depth).limits]  # fmt: skip
    axles = concio.Axle(0.0, 11.5), concio.Axle(900.0, 1.0)
    crowded = concio.with_vehicle(small(), concio.Vehicle("x", axles, width=3.0))
    heavy = concio.with_vehicle(small(), concio.Vehicle("x", (concio.Axle(0.0, 9000.0),)))
    lane = concio.with_vehicle(small(), replace(concio.find_vehicle("LM71"), position=1.0), whole=False)
    said += [line for model in (crowded, heavy, lane) for line in implausible(model)]
    assert len(said) > 15
    for text in said:
        assert catalogue("concio.verdict").whole(text) is not None, text


def test_both_languages_have_the_same_words() -> None:
    table = tomllib.loads((files("concio.report") / "bridge_words.toml").read_text(encoding="utf-8"))
    assert set(table["en"]) == set(table["it"])


def test_a_support_that_settles_opens_joints(found: concio.BridgeResult) -> None:
    assert found.settled is not None
    assert found.settled.open_joints > found.service.open_joints


def test_soil_at_its_largest_pressure_is_no_joint_that_crushes(found: concio.BridgeResult) -> None:
    """Joints without strength never crush; soil that the arch is pushed into presses with all that it can."""
    assert found.settled is not None
    state = found.settled.result
    pressed = state.ties.tension
    caps = np.array([t.yield_force for t in state.model.ties])
    assert (pressed > caps * (1 - 1e-9)).any()
    assert found.settled.crushed == 0


@pytest.mark.long
def test_the_command_writes_report_curve_and_numbers(tmp_path: Path) -> None:
    out = tmp_path / "result"
    code, _, err = run("bridge", written(tmp_path), "--step", "0.8 m", "--fine", "0.4 m", "--checked", "2", "--worst",
                       "1", "--no-sensitivity", "--out", out, "--language", "it")  # fmt: skip
    assert code == 0, err
    assert {"report.html", "summary.json", "curve.csv", "curve.png", "mechanism.png"} <= {p.name for p in out.iterdir()}
    with (out / "curve.csv").open() as handle:
        rows = list(csv.DictReader(handle))
    assert len(rows) > 4
    assert 'lang="it"' in (out / "report.html").read_text(encoding="utf-8")
