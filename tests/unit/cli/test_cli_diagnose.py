"""``concio diagnose``: the survey of a file, tables of measurements, what is printed and written, bad input."""

from __future__ import annotations

import json
import math
import re
import shutil
import tomllib
from importlib.resources import files
from pathlib import Path

import pytest

import concio
from commands import run
from concio.analysis.cracks.diagnosis_asked import read_measurements, read_survey

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "cracked_arch.toml"
TABLE = """name,kind,value [mm],error [mm],body_a,body_b,x,y
K1,opening,9.7,0.3,v03,v04,0,0
K2,opening,0.55 cm,0.3,v01,left abutment,-0.7091911,0.3
K3,closed,,0.3,v02,v03,,
L1,level,-10,1,v03,,0,0.3
T1,tilt,-16 mrad,1 mrad,v02,,,
"""


def head() -> str:
    """The example without its measurements."""
    text = EXAMPLE.read_text()
    return text[: text.index("[[survey.measurements]]")] + "{}" + text[text.index("[[survey.candidates]]") :]


@pytest.fixture
def tabled(tmp_path: Path) -> Path:
    (tmp_path / "cracks.csv").write_text(TABLE)
    file = tmp_path / "arch.toml"
    file.write_text(head().format('measurements_file = "cracks.csv"\n'))
    return file


def test_the_command_prints_one_object_with_the_verdict() -> None:
    code, out, _ = run("diagnose", EXAMPLE, "--json")
    told = json.loads(out)
    assert code == told["verdict"]["exit_code"] == 0
    assert told["status"] == "one_cause"
    assert told["causes"][0]["motions"][0]["name"] == "left abutment gives way"
    assert told["future"]["stands"] is True


@pytest.mark.long
def test_the_command_writes_report_figures_and_numbers(tmp_path: Path) -> None:
    place = tmp_path / "out"
    code, out, err = run("diagnose", EXAMPLE, "--out", place, "--language", "it")
    assert code == 0, err
    page = (place / "report.html").read_text()
    assert 'lang="it"' in page
    assert "Una sola causa spiega le misure" in page
    assert "misurato | previsto" in page
    assert "Una sola causa" in out
    assert json.loads((place / "summary.json").read_text())["status"] == "one_cause"
    assert (place / "cracks.png").stat().st_size > 10_000
    table = re.sub(r"<svg.*?</svg>|<style.*?</style>|<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"\bconstant\b|\balong\b|self-weight", table)
    assert not re.search(r"\d\.\d", table.split("<footer>")[0])
    for name in ("causes", "cracks", "readings"):
        texts = re.findall(r"<!-- (.*?) -->", (place / f"{name}.svg").read_text())
        assert texts
        assert not [t for t in texts if re.search(r"\d\.\d", t)]
    assert (place / "measurements.csv").read_text().startswith("name,kind,")


def test_a_table_of_measurements_is_read_with_its_units(tabled: Path) -> None:
    survey = read_survey(tabled)
    assert [m.name for m in survey.measurements] == ["K1", "K2", "K3", "L1", "T1"]
    values = [m.value for m in survey.measurements]
    assert values == pytest.approx([9.7e-3, 5.5e-3, 0.0, -0.01, -0.016])
    assert [m.error for m in survey.measurements] == pytest.approx([3e-4, 3e-4, 3e-4, 1e-3, 1e-3])
    assert survey.measurements[1].joint == ("v01", "left abutment")
    assert survey.measurements[3].body == "v03"


@pytest.mark.long
def test_a_file_asks_for_what_python_asks_for() -> None:
    survey = read_survey(EXAMPLE)
    found = concio.diagnose(survey.model, survey.measurements, survey.candidates, **{**survey.options, "large": False})
    assert found.most == 2
    assert survey.candidates[0].low == 0.0
    assert math.isinf(survey.candidates[2].low)
    code, out, _ = run("diagnose", EXAMPLE, "--json")
    assert code == 0
    assert json.loads(out)["causes"][0]["motions"][0]["motion"] == found.best.motion[0]


def test_units_of_a_file_are_those_of_its_survey(tmp_path: Path) -> None:
    text = head().format('[[survey.measurements]]\nname = "a"\njoint = ["v01", "v02"]\nvalue = 3\n')
    text = text.replace("[arch]", '[units]\nlength = "mm"\n\n[arch]').replace("span = 1.2", "span = 1200")
    text = text.replace("ring = 0.3", "ring = 300").replace('error = "0.3 mm"', "error = 0.2")
    file = tmp_path / "a.toml"
    file.write_text(text)
    found = read_survey(file).measurements[0]
    assert (found.value, found.error) == pytest.approx((3e-3, 2e-4))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("body_a", "block", "unknown column 'block'"),
        ("name,", "kind,", "is there twice"),
        ("value [mm]", "value (mm)", "units stand in square brackets: value [mm]"),
        ("9.7", "9,7", "values were expected"),
        ("9.7", "nine", "line 2, value: 'nine' is not a number"),
        ("9.7", "9.7 kN", "is not a length"),
        ("-16 mrad", "-16", "line 6, value"),
        ("opening,9.7", "opening,-9.7", "less than nothing"),
        ("opening,9.7", "opening,", "the value is missing"),
        ("opening,9.7", "opening,9.7 m", "no opening of a structure that stands"),
        ("opening,9.7", "crack,9.7", "unknown kind"),
        ("0,0.3\nT1", "0,\nT1", "only x of a point"),
        ("v03,v04", "v03,v99", "no body called 'v99'"),
    ],
)
def test_a_table_with_a_fault_is_refused_in_one_message(tabled: Path, old: str, new: str, words: str) -> None:
    table = tabled.with_name("cracks.csv")
    assert old in TABLE
    table.write_text(TABLE.replace(old, new, 1))
    code, out, err = run("diagnose", tabled)
    assert code == 2, out
    assert words in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[survey]", "[survey]\ncolour = 1", "colour"),
        ('error = "0.3 mm"', 'error = "0.3 kN"', "survey"),
        ("most = 2 ", "most = 0 ", "most"),
        ('kind = "closed"', 'kind = "shut"', "kind"),
        ('error = "0.3 mm"', "", "error is missing"),
        ('value = "9.7 mm"', "", "value is missing"),
        ('value = "9.7 mm"', "value = 9.7", "give the unit"),
        ('body = "right abutment"\nrotation', 'body = "v02"\nrotation', "is not fixed"),
        ("low = 0.0", "low = 1.0", "allowed to be zero"),
    ],
)
def test_a_survey_with_a_fault_is_refused_in_one_message(tmp_path: Path, old: str, new: str, words: str) -> None:
    text = EXAMPLE.read_text()
    assert old in text
    file = tmp_path / "a.toml"
    file.write_text(text.replace(old, new, 1))
    code, _, err = run("diagnose", file)
    assert code == 2
    assert words in err
    assert "Traceback" not in err


def test_files_without_a_survey_say_what_is_missing(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text(EXAMPLE.read_text().split("[survey]")[0])
    code, _, err = run("diagnose", file)
    assert code == 2
    assert "no table [survey]" in err
    code, _, err = run("diagnose", EXAMPLE, "--language", "de")
    assert code == 2
    assert "'de'" in err


def test_other_commands_read_a_file_with_a_survey(tmp_path: Path) -> None:
    file = shutil.copy(EXAMPLE, tmp_path / "a.toml")
    assert run("check", file)[0] == 0


def test_a_missing_table_is_named(tabled: Path) -> None:
    tabled.with_name("cracks.csv").unlink()
    code, _, err = run("diagnose", tabled)
    assert code == 2
    assert "cracks.csv" in err
    with pytest.raises(concio.InputError, match="no such file"):
        read_measurements(tabled.with_name("none.csv"))


def test_reports_have_the_same_words_in_both_languages() -> None:
    words = tomllib.loads((files("concio.report") / "diagnosis_words.toml").read_text(encoding="utf-8"))
    assert {*words["en"]} == {*words["it"]}


def test_directions_of_measurements_and_candidates_are_those_of_the_file(tmp_path: Path) -> None:
    told = 'name = "D"\nkind = "level"\nbody = "v03"\nat = [0.0, 0.3]\ndirection = [0.6, 0.8]\nvalue = "2 mm"\n'
    file = tmp_path / "a.toml"
    file.write_text(head().format(f"[[survey.measurements]]\n{told}"))
    survey = read_survey(file)
    assert survey.measurements[0].direction == (0.6, 0.8)
    asked = tomllib.loads(file.read_text())["survey"]["candidates"]
    assert [list(c.direction) for c in survey.candidates] == [c.get("direction", []) for c in asked]
    assert any("direction" in c for c in asked)
