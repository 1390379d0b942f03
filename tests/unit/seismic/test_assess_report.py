"""Assessments from files: command line, report in two languages, ties that are sized, anchors, sensitivity."""

from __future__ import annotations

import json
import math
import re
import tomllib
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest

import concio
from commands import run
from concio.analysis.seismic.anchors import Anchor
from concio.analysis.seismic.assessment_asked import Head, read_asked
from concio.analysis.seismic.variations import tie_force, variations
from concio.cli.assess_command import mechanism_lines
from concio.errors import InputError
from concio.report.assessment_page import AssessmentReport
from concio.report.language import words_of
from seismic_walls import overturning, site

TEMPLATE = (files("concio.model") / "templates" / "assessment.toml").read_text(encoding="utf-8")
TIE = concio.Tie("tie", "c1", (0.0, 5.5), "", (5.0, 5.5), stiffness=5000.0, yield_force=2.0)


def edited(folder: Path, *changes: tuple[str, str]) -> Path:
    text = TEMPLATE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "strip.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["assessment_words.toml", "annex_words.toml"])
def test_the_languages_have_the_same_keys_and_places(name: str) -> None:
    table = tomllib.loads((files("concio.report") / name).read_text(encoding="utf-8"))
    assert set(table) == {"en", "it"}
    assert list(table["en"]) == list(table["it"])
    for key, text in table["en"].items():
        assert set(re.findall(r"\{(\w+)\}", text)) == set(re.findall(r"\{(\w+)\}", table["it"][key])), key
    with pytest.raises(InputError, match="language 'fr'"):
        words_of("assessment_words", "fr")


@pytest.mark.long
@pytest.mark.parametrize("language", ["en", "it"])
def test_report_holds_what_was_computed_and_never_verified_without_a_ratio(language: str) -> None:
    found = concio.assess(overturning(), site=site(), direction="left", control=("c1", (0.0, 6.0)))
    text = AssessmentReport(found, head=Head(project="Casa & torre", author="NN"), language=language).html()
    assert f'<html lang="{language}">' in text
    assert "Casa &amp; torre" in text
    decimal = "," if language == "it" else "."
    for number in ("0.101106", "0.945572", "0.776996", "0.136736"):
        assert number.replace(".", decimal) in text
    word = {"en": "verified", "it": "verificato"}[language]
    plain = re.sub(r"<[^>]*>", "|", text)
    for hit in re.finditer(rf"(?i){word}", plain):
        assert re.match(rf"(?i){word}(, \d|: )", plain[hit.start() :]), plain[hit.start() - 40 : hit.start() + 40]
    assert "Circolare, C8.7.1.2.1.8" in text
    assert text.count("<figure") == 1 + 3 * len(found.mechanisms)
    assert "http" not in re.sub(r"data:[^\"]*", "", text)


def test_a_result_writes_its_own_report(tmp_path: Path) -> None:
    found = concio.assess(overturning(), site=site(), direction="left", levels=["SLD"])
    assert "ζ<sub>E</sub>" in found.report(tmp_path / "r.html", language="it").read_text(encoding="utf-8")


@pytest.mark.long
def test_command_writes_report_numbers_and_curves(tmp_path: Path) -> None:
    size = 'size_tie = "roof tie"                 # find the force that brings zeta_E to one\n'
    path = edited(tmp_path, (size, ""), ("[assessment]\n", '[assessment]\nlevels = ["SLV"]\n'))
    code, shown, errors = run("assess", path, "--out", tmp_path / "out", "--language", "it")
    assert code == 3, errors  # it is not verified
    assert "zeta_E" in shown
    assert sorted(p.name for p in (tmp_path / "out").iterdir() if p.suffix in (".html", ".csv")) == [
        "curves.csv", "report.html",
    ]  # fmt: skip
    told = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert told["mechanisms"][0]["alpha0"] == pytest.approx(0.110748, abs=1e-6)
    assert told["levels"] == ["SLV"]
    assert 'lang="it"' in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('soil = "B"', 'soil = "F"', "no soil 'F'"),
        ('soil = "B"', 'sole = "B"', "did you mean 'soil'"),
        ("a_g = 0.205", "a_g = 2.01", "was 2.01 m/s2 meant"),
        ('knowledge = "LC2"', 'knowledge = "LC9"', "no level of knowledge 'LC9'"),
        ('tie = "roof tie"', 'tie = "roof"', "no tie called 'roof'"),
        ('size_tie = "roof tie"', 'size_tie = "tie"', "no tie called 'tie'"),
        ('"upper storey" = { above = 3.5 }', '"upper storey" = { over = 3.5 }', "over"),
        ("[site]", "[sites]", "did you mean 'site'"),
        ("yield_force = 8.0", "yield_force = -1.0", "yield_force"),
    ],
)
def test_bad_files_are_refused_in_a_sentence(tmp_path: Path, old: str, new: str, said: str) -> None:
    code, _, errors = run("assess", edited(tmp_path, (old, new)), "--out", tmp_path / "out")
    assert code == 2
    assert said in errors
    assert "Traceback" not in errors
    assert not (tmp_path / "out").exists()


def test_a_file_without_a_site_says_what_to_add(tmp_path: Path) -> None:
    path = tmp_path / "wall.toml"
    path.write_text(TEMPLATE[: TEMPLATE.index("[site]")], encoding="utf-8")
    with pytest.raises(InputError, match=r"no table \[site\]"):
        read_asked(path)


@pytest.mark.long
def test_the_tie_force_that_is_needed_is_the_least_that_does() -> None:
    model = overturning(ties=(TIE,))
    arguments = {"site": site(), "direction": "left", "levels": ["SLD"]}
    found = tie_force(model, "tie", zeta=1.0, **arguments)
    # SLD: a_0* = 0.07 x 1.2 x 9.81 m/s2 needs alpha_0, and the tie's work gives it
    alpha = 0.07 * 9.81 * 1.2 * found.assessment.worst.e_star * 1.35 / 9.81  # type: ignore[union-attr]
    assert found.force == pytest.approx((alpha * 271.2 - 27.42) / 5.5, rel=2e-3)
    assert 1.0 <= found.reached < 1.002
    strong = tie_force(model, "tie", zeta=1.0, site=site(hazard={"SLD": {"a_g": 0.01}}), direction="left")
    assert strong.force == 0.0
    never = tie_force(model, "tie", zeta=1.0, largest=0.2, **arguments)
    assert math.isinf(never.force)
    with pytest.raises(InputError, match="no tie called 'ties'"):
        tie_force(model, "ties", **arguments)


def test_anchor_formulas() -> None:
    anchor = Anchor("tie", steel_area=314e-6, steel_strength=224e3, plate=(0.3, 0.2), wall_thickness=0.45,
                    shear_strength=50.0, bearing_strength=1000.0, depth=0.4, hole=0.05)  # fmt: skip
    assert anchor.capacities == pytest.approx(
        {
            "steel": 70.336, "punching": 2 * (0.75 + 0.65) * 0.45 * 50.0, "bearing": 60.0,
            "cone": math.pi * 0.4 * 0.45 * 50.0,
        }
    )  # fmt: skip
    steel = anchor.checks(80.0)[0]
    assert not steel.holds
    assert steel.ratio == pytest.approx(70.336 / 80.0)


def test_sensitivity_to_set_back_and_friction() -> None:
    found = concio.assess(overturning(strength=2000.0), site=site(), direction="left", levels=["SLV"])
    varied = {(v.what, v.factor): v.multiplier for v in variations(found)}
    assert varied["friction", 0.8] == pytest.approx(found.worst.multiplier)  # type: ignore[union-attr]
    assert varied["strength", 0.5] == pytest.approx((27.42 - 84.4**2 / (2 * 1000.0)) / 271.2)


WALL = """
[walls]
lines = [[[0.0, 0.0], [1.0, 0.0]]]
height = 0.5
block_size = [1.0, 0.25, 0.5]
block = "rigid"
unit_weight = 18.0
friction = {friction}

[assessment]
direction = "+y"
levels = ["SLV"]
sensitivity = {asked}

[site]
soil = "B"
building = {{ height = 6.0, storeys = 2 }}

[site.hazard.SLV]
a_g = 0.2
F0 = 2.45
Tc = 0.32
"""


@pytest.mark.long  # test_sensitivity and test_coulomb_sensitivity look at the numbers
def test_the_console_says_what_alpha_0_depends_on_or_why_it_has_no_derivatives(tmp_path: Path) -> None:
    """A block in space: it slides under pressure at alpha_0 = friction, or tips at width over height."""
    path, lines = tmp_path / "wall.toml", {}
    for friction, asked in ((0.05, "true"), (0.9, "true"), (0.05, "false")):
        path.write_text(WALL.format(friction=friction, asked=asked), encoding="utf-8")
        shown = run("assess", path)[1]
        assert f"alpha_0            {min(friction, 0.5):g}" in shown
        lines[friction, asked] = [line.split(maxsplit=2)[2] for line in shown.splitlines() if "  depends on " in line]
    (refused,), (told,) = lines[0.05, "true"], lines[0.9, "true"]
    assert refused.startswith("no derivatives: in the weakest mechanism joints slide under pressure in space")
    start = "One per cent more of each changes the multiplier by: all lengths along y +1 %, all lengths along z -1 %"
    assert told.startswith(start)
    assert lines[0.05, "false"] == []


LOW = {"SLV": {"a_g": 0.01, "F0": 2.5, "Tc": 0.3}}


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({}, ["verified", "on the ground"]),
        ({"elsewhere": ("height",)}, ["verified", "verified"]),
        ({"curve": "straight"}, ["verified", "on the ground"]),
    ],
)
def test_a_row_is_verified_where_everything_of_it_was_checked(more: dict[str, object], said: list[str]) -> None:
    """A part that starts at 3 m is not, without the building that amplifies the motion there, whatever its zeta_E."""
    high = {"upper": ["c3", "c4"]}
    found = concio.assess(overturning(4), site=site(hazard=LOW), direction="left", mechanisms=high, **more)
    rows = re.findall(r"<tr><td>(?:(?!</tr>).)*</tr>", AssessmentReport(found).search())
    assert [m.level for m in found.mechanisms] == [0.0, 3.0]
    assert [m.at_its_height for m in found.mechanisms] == [True, False]
    for row, m, words in zip(rows, found.mechanisms, said, strict=True):
        assert row.split("<td")[-1].count(words) == 1, row
        assert f"{m.least:.4g}" in row.split("<td")[-1]
    lines = [mechanism_lines(m)[-1] for m in found.mechanisms]
    assert ["not checked: all of this is as on the ground" in line for line in lines] == [False, True]
    assert [m["at_its_height"] for m in found.summary()["mechanisms"]] == [True, False]


def test_a_row_without_a_curve_is_not_checked() -> None:
    """Whatever was verified at other limit states; what fails at one fails."""
    found = concio.assess(overturning(4), site=site(hazard=LOW), direction="left", levels=["SLV"])
    (m,) = found.mechanisms
    text = AssessmentReport(found)
    assert "verified" in text.outcome_of(m, found)
    without = replace(m, checks=())
    assert not without.complete
    assert text.outcome_of(without, found) == "not checked"
    fails = replace(m, periods={"SLV": replace(m.periods["SLV"], a_g=0.9)})
    assert fails.least < 1
    assert "not verified" in text.outcome_of(fails, found)


def test_the_first_mechanism_is_printed_in_detail_and_decides_at_every_order_of_the_names() -> None:
    """Its number, its name and its zeta_E are those of the headline; all are printed on request."""
    parts = {"top": ["c4"], "upper": ["c3", "c4"]}
    for names in (list(parts), list(parts)[::-1]):
        found = concio.assess(overturning(4), site=site(building={"height": 6.0, "storeys": 2, "T1": 0.25, "xi": 10}),
                              direction="left", mechanisms={name: parts[name] for name in names})  # fmt: skip
        assert found.mechanisms[0].zeta == found.zeta == min(m.zeta for m in found.mechanisms)
        short, full = (AssessmentReport(found, head=Head(full=full)).mechanisms() for full in (False, True))
        assert short[0] == full[0]
        assert [one == other for one, other in zip(short[1:3], full[1:3], strict=True)] == [False, False]
