"""Numbers as people write them, in units of their choice."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

import concio
from concio.cli.lines import result_lines
from concio.cli.main import app
from concio.display import Units, number
from concio.report.page import report_html


@pytest.mark.parametrize(
    ("value", "size", "text"),
    [
        (0.0, 0.0, "0"),
        (-0.0, 0.0, "0"),
        (-4.49e-12, 10.0, "0"),
        (-4.49e-12, 0.0, "-4.49e-12"),
        (12.3456, 0.0, "12.3"),
        (-0.5, 0.0, "-0.5"),
        (99.97, 0.0, "100"),
        (999.7, 0.0, "1000"),
        (1234.5, 0.0, "1234"),
        (123456.0, 0.0, "123,500"),
        (0.000123, 0.0, "0.000123"),
        (1.2e-7, 0.0, "1.2e-7"),
        (math.inf, 0.0, "unlimited"),
        (math.nan, 0.0, "–"),
    ],
)
def test_number(value: float, size: float, text: str) -> None:
    assert number(value, size=size) == text


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        ("force", 12.34, "12.3 kN"),
        ("motion", -0.00123, "-1.23 mm"),
        ("motion", 5.56e-8, "0.0556 µm"),
        ("motion", 0.0, "0 mm"),
        ("length", 0.004, "4 mm"),
        ("length", 1.25, "1.25 m"),
        ("stress", 12.0, "12 kN/m2"),
        ("stress", -3.4e3, "-3.4 MPa"),
        ("modulus", 5e6, "5 GPa"),
        ("modulus", 1e5, "100 MPa"),
        ("unit weight", 20.0, "20 kN/m3"),
        ("moment", 3.0, "3 kN m"),
        ("rotation", 0.00021, "0.21 mrad"),
        ("compliance", 1e-6, "0.001 mm/kN"),
        ("number", 0.6, "0.6"),
    ],
)
def test_default_units(kind: str, value: float, text: str) -> None:
    assert Units().text(kind, value) == text


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        ("force", 12.34, "12,340 N"),
        ("length", 1.25, "1250 mm"),
        ("motion", -0.00123, "-1.23 mm"),
        ("stress", 12.0, "0.012 N/mm2"),
        ("modulus", 5e6, "5000 N/mm2"),
        ("unit weight", 20.0, "0.00002 N/mm3"),
        ("moment", 3.0, "3,000,000 N mm"),
    ],
)
def test_chosen_units(kind: str, value: float, text: str) -> None:
    units = Units.parse("N, mm, N/mm2")
    assert units == Units(force="N", length="mm", stress="N/mm2")
    told = units.text(kind, value)
    assert told == text or (kind == "unit weight" and told == "2e-5 N/mm3")


def test_signs_and_sizes() -> None:
    units = Units()
    assert units.text("force", 3.0, sign=True) == "+3 kN"
    assert units.text("force", 1e-12, size=5.0, sign=True) == "0 kN"
    assert units.text("stress", 10.0, size=5e3) == "0.01 MPa", "one unit for all that stand together"


def test_a_column_has_one_unit_and_equal_decimals() -> None:
    texts, symbol = Units().column("force", [12.3456, -0.1, 4.49e-12, math.nan])
    assert (texts, symbol) == (["12.35", "-0.10", "0", "–"], "kN")
    assert Units().column("stress", [1500.0, -20.0]) == (["1.500", "-0.020"], "MPa")
    assert Units().column("force", [0.0, -0.0]) == (["0", "0"], "kN")
    assert Units().column("force", [123456.7]) == (["123,457"], "kN")
    assert Units().column("force", [5.0, -0.0004])[0] == ["5.000", "0"], "no minus zero after rounding"


def test_units_that_are_none() -> None:
    with pytest.raises(concio.InputError, match=r"'lb' is not a unit of force for reports \(one of: kN, N"):
        Units(force="lb")
    with pytest.raises(concio.InputError, match=r"'MPA' is not a unit for reports \(did you mean 'MPa'"):
        Units.parse("kN, MPA")
    assert Units.parse("force = N, motion = cm") == Units(force="N", motion="cm")


PANEL = """
[panel]
courses = 2
blocks = 3
joint = 0.02
base = "bearings"
top_pressure = 10.0
[report]
force = "N"
length = "mm"
stress = "MPa"
"""


def test_a_file_chooses_the_units_of_its_reports_and_keeps_them() -> None:
    model = concio.loads(PANEL)
    assert model.report == Units(force="N", length="mm", stress="MPa")
    assert concio.loads(concio.dumps(model)).report == model.report
    with pytest.raises(concio.InputError, match=r"\[report\].*'lbs' is not one of 'kN', 'N'"):
        concio.loads("[panel]\ncourses = 2\n[report]\nforce = 'lbs'\n")


def test_texts_figures_and_reports_speak_the_same_units() -> None:
    result = concio.solve(concio.loads(PANEL))
    total = f"{-1e3 * result.total_load[1]:.0f} N"
    lines = "\n".join(result_lines(result))
    assert f"-{total} along y" in lines
    assert "kN" not in lines
    page = report_html(result, figures=False)
    assert f"-{total} along y" in page
    assert "largest stress [MPa]" in page
    assert "length [mm]" in page
    told = re.sub(r'title="[^"]*"', "", page.partition("<footer")[0])
    assert not re.search(r"\d kN", told), "no second system of units"
    axes = result.plot.principal()
    assert axes.get_xlabel() == "x [mm]"
    figure = axes.get_figure(root=True)
    figure.canvas.draw()
    assert axes.get_xticklabels()[-1].get_text() == "800"
    other = result.in_units("MN, cm")
    assert other.plot.principal().get_xlabel() == "x [cm]"
    assert other.solution is result.solution


def test_no_dust_is_told() -> None:
    """The horizontal reaction of a symmetric panel's bearings is rounding: it is 0, without a sign."""
    result = concio.solve(concio.running_bond_panel(courses=1, blocks=1, side_walls=False, top_pressure=10.0))
    x, _ = result.reactions["base"]
    assert x == 0.0 or abs(x) < 1e-9
    line = next(line for line in result_lines(result) if "reactions" in line)
    assert " 0 kN along x" in line
    assert "e-" not in line
    tables = report_html(result, figures=False).partition("Reactions</h2>")[2].partition("</section>")[0]
    assert "e-1" not in re.sub(r'title="[^"]*"', "", tables)


def test_units_on_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "panel.toml"
    file.write_text(PANEL, encoding="utf-8")
    for command in ("run", "check", "path", "limit"):
        done = CliRunner().invoke(app, [command, str(file), "--units", "MN, furlong"])
        assert done.exit_code == 2
        assert "--units: 'furlong' is not a unit for reports" in done.output
    done = CliRunner().invoke(app, ["run", str(file), "--units", "MN"])
    assert done.exit_code == 0
    assert " MN along y" in done.output


def test_every_unit_that_may_be_chosen_is_told_in_reports(tmp_path: Path) -> None:
    """1 kgf/cm2 is 98.0665 kN/m2, and every choice of the table converts, by itself and from the command line."""
    from concio.display import CHOICES

    assert Units(stress="kgf/cm2").text("stress", 98.0665) == "1 kgf/cm2"
    assert Units(stress="tf/m2").text("stress", 9.80665) == "1 tf/m2"
    for unit in CHOICES["stress"][1:]:
        assert Units.parse(unit).stress == unit
        assert Units.parse(unit).text("stress", 50.0).endswith(unit)
    path = tmp_path / "c.toml"
    path.write_text("[column]\nwidth = 1.0\nheight = 1.0\nblocks = 1\n")
    assert CliRunner().invoke(app, ["run", str(path), "--units", "kgf/cm2"]).exit_code == 0
