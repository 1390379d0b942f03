"""What an assessment says of its search, its hazard and the author's decisions."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

import concio
from concio.analysis.seismic.assessment_asked import Head, read_asked
from concio.analysis.seismic.hazard_grid import hazard_at
from concio.cli.main import app
from concio.errors import InputError
from concio.plot.assessment_figures import curve_figure, model_figure
from concio.plot.figure_language import in_language
from concio.report.assessment_page import AssessmentReport
from samples import sample
from seismic_walls import bending, overturning, site

PERIODS = (30, 475, 2475)


def grid_file(path: Path, value: object, mark: str = ";", tenths: bool = False) -> Path:
    """Write a grid of 5 x 4 nodes whose values are a function of longitude, latitude and return period."""
    names = [f"{word}{T}" for T in PERIODS for word in (("ag10_" if tenths else "ag"), "F0", "Tc")]
    lines = [mark.join(["id", "lon", "lat", *names])]
    for k, (x, y) in enumerate((x, y) for y in np.arange(41.0, 41.2, 0.05) for x in np.arange(14.0, 14.25, 0.05)):
        numbers = [v for T in PERIODS for v in value(x, y, T)]  # type: ignore[operator]
        cells = [str(k), f"{x:.6f}", f"{y:.6f}", *(f"{v * (10 if tenths and j % 3 == 0 else 1):.12g}"
                                                  for j, v in enumerate(numbers))]  # fmt: skip
        lines.append(mark.join(cells))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def rising(x: float, y: float, T: int) -> tuple[float, float, float]:
    return 0.02 * np.log10(T) * (1 + 0.3 * (x - 14)), 2.4 + 0.1 * (y - 41), 0.3 + 0.0 * T


@settings(max_examples=sample(4, 20), deadline=None)
@given(st.floats(14.01, 14.19), st.floats(41.01, 41.14), st.booleans())
def test_a_place_lies_between_its_four_nodes(
    tmp_path_factory: pytest.TempPathFactory, x: float, y: float, tenths: bool
) -> None:
    path = grid_file(tmp_path_factory.mktemp("grid") / "g.csv", rising, tenths=tenths)
    rows = hazard_at(path, (x, y))
    assert [r["T_R"] for r in rows] == list(PERIODS)
    for row, T in zip(rows, PERIODS, strict=True):
        west, east = 14 + 0.05 * np.floor((x - 14) / 0.05 - 1e-9), 14 + 0.05 * np.ceil((x - 14) / 0.05 + 1e-9)
        low, high = rising(west, y, T)[0], rising(east, y, T)[0]
        assert low - 1e-12 <= row["a_g"] <= high + 1e-12
        assert row["Tc"] == pytest.approx(0.3, rel=1e-12)


def test_nodes_middles_and_weights_of_a_grid(tmp_path: Path) -> None:
    path = grid_file(tmp_path / "g.csv", rising, mark=",")
    assert hazard_at(path, (14.1, 41.05))[1]["a_g"] == pytest.approx(rising(14.1, 41.05, 475)[0], rel=1e-9)
    middle = hazard_at(path, (14.125, 41.05 + 1e-9))[1]["a_g"]
    assert middle == pytest.approx(rising(14.125, 41.05, 475)[0], rel=1e-4)
    found = concio.Site(hazard_at(path, (14.13, 41.07)), soil="B", source="a grid")
    assert pytest.approx(475, rel=1e-2) == found.at("SLV").T_R
    for place in ((13.0, 41.05), (14.1, 45.0), (14.2001, 41.05)):
        with pytest.raises(InputError, match="four nodes"):
            hazard_at(path, place)
    (tmp_path / "bad.csv").write_text("lon;lat;ag475;F0475\n1;2;3;4\n", encoding="utf-8")
    with pytest.raises(InputError, match="lacks a_g, F0 or Tc"):
        hazard_at(tmp_path / "bad.csv", (1, 2))


MODEL = """
[materials.wall]
kind = "rigid"
unit_weight = 19.0
[joints.bed]
friction = 0.7
[[blocks]]
name = "ground"
kind = "fixed"
rectangle = [[-1.0, -0.5], [2.0, 0.0]]
[[blocks]]
name = "wall"
material = "wall"
rectangle = [[0.0, 0.0], [0.6, 4.0]]
[[loads]]
kind = "weight"
value = [0, -1]
[assessment]
direction = "left"
levels = ["SLV"]
accept_linear = true
[assessment.reasons]
levels = "asked for by the client"
"""


def test_a_file_may_take_its_hazard_from_a_grid(tmp_path: Path) -> None:
    grid_file(tmp_path / "g.csv", rising)
    path = tmp_path / "m.toml"
    path.write_text(MODEL + '[site]\ngrid = "g.csv"\ncoordinates = [14.13, 41.07]\nsoil = "C"\n', encoding="utf-8")
    asked = read_asked(path)
    place = asked.arguments["site"]
    assert "g.csv" in place.source
    assert "14.13" in place.source
    assert place.assumed == ("topography", "nominal_life", "use_class")
    found = concio.assess(asked.model, **asked.arguments)
    assert any("class of use II" in line for line in found.verdict.attention)
    text = AssessmentReport(found, head=asked.head, language="it").html()
    assert "asked for by the client" in text
    assert "Fonte della pericolosità: g.csv" in text
    assert "Non dati, e assunti" in text
    for wrong in ('[site]\nsoil = "C"\n', '[site]\ngrid = "g.csv"\n'):
        path.write_text(MODEL + wrong, encoding="utf-8")
        with pytest.raises(InputError, match="hazard is"):
            read_asked(path)


def test_a_linear_check_that_is_met_decides_only_where_the_author_accepts_it() -> None:
    quiet = concio.Site({"SLV": {"a_g": 0.12, "F0": 2.45, "Tc": 0.32}}, soil="A")
    asked = {"site": quiet, "direction": "left", "levels": ["SLV"]}
    strict = concio.assess(overturning(), **asked).worst  # type: ignore[arg-type]
    free = concio.assess(overturning(), accept_linear=True, **asked).worst  # type: ignore[arg-type]
    assert strict is not None
    assert free is not None
    linear, moved = strict.checks
    assert (linear.kind, linear.holds, moved.kind) == ("linear", True, "displacement")
    assert strict.zeta == max(moved.a_g, moved.least) / 0.12
    assert free.zeta == max(strict.zeta, linear.zeta)
    assert free.decided_by(free.checks[0])
    assert not strict.decided_by(strict.checks[0])
    strong = concio.assess(overturning(), site=site(), direction="left", levels=["SLV"], accept_linear=True).worst
    assert strong is not None
    assert not strong.checks[0].holds
    assert not strong.decided_by(strong.checks[0])


@pytest.mark.long
def test_revision_and_date_have_a_place_where_they_are_not_given() -> None:
    found = concio.assess(overturning(2), site=site(), direction="left", levels=["SLD"])
    for head, cells in ((Head(), ["_" * 16] * 2), (Head(revision="B", date="1 May"), ["B", "1 May"])):
        page = AssessmentReport(found, head=head).html()
        rows = dict(re.findall(r"<tr><th>(revision|date)</th><td>([^<]*)</td>", page.partition("</header>")[0]))
        assert [rows["revision"], rows["date"]] == cells


@pytest.mark.long
def test_what_was_covered_is_counted_and_named() -> None:
    found = concio.assess(overturning(4), site=site(), mechanisms={"top": ["c4"]})
    rows = {c.kind: c for c in found.covered}
    assert rows["whole"].searches == 2
    assert rows["named"].searches == 2
    assert (rows["levels"].sought, rows["levels"].there) == (6, 6)
    assert sum(c.searches for c in found.covered) == found.sought
    assert min(c.multiplier for c in found.covered) == pytest.approx(found.worst.multiplier, rel=1e-9)  # type: ignore[union-attr]
    assert rows["whole"].motions == ("overturning",)
    bent = concio.assess(bending(4), site=site(), direction="right", live="live")
    assert next(c for c in bent.covered if c.kind == "whole").motions == ("bending",)
    slid = concio.assess(overturning(friction=0.05), site=site(), direction="left", levels=["SLV"])
    assert next(c for c in slid.covered if c.kind == "whole").motions == ("sliding",)
    first = AssessmentReport(found, head=Head(), language="en").html().split("<section id=site")[0]
    assert re.search(r"above levels.*6 / 6", first)
    assert found.summary()["covered"][0]["kind"] == "whole"


@pytest.mark.long
def test_the_report_as_docx_holds_its_headings_tables_and_pictures(tmp_path: Path) -> None:
    docx = pytest.importorskip("docx")
    found = concio.assess(overturning(2), site=site(), direction="left")
    path = found.report(tmp_path / "r.docx", language="it", head=Head(project="Casa"))
    read = docx.Document(str(path))
    page = AssessmentReport(found, language="it", head=Head(project="Casa")).html()
    titles = [p.text for p in read.paragraphs if p.style.name.startswith("Heading")]
    assert titles[0] == "Casa"
    assert len(titles) == len(re.findall(r"<h[123]>|<h[123] ", page))
    assert len(read.tables) == page.count("<table")
    assert len(read.inline_shapes) == page.count("<figure")
    words = " ".join(cell.text for table in read.tables for row in table.rows for cell in row.cells)
    assert "0,101106" in words


def test_without_the_library_docx_is_refused_in_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "docx", None)
    found = concio.assess(overturning(2), site=site(), direction="left", levels=["SLD"])
    with pytest.raises(InputError, match="python-docx"):
        found.report(tmp_path / "r.docx")
    path = tmp_path / "m.toml"
    path.write_text(MODEL + "[site.hazard.SLV]\na_g = 0.2\n", encoding="utf-8")
    monkeypatch.setattr(concio, "assess", None)  # it is refused before anything is computed
    for more, said in (["--out", str(tmp_path / "out")], "python-docx"), ([], "python-docx"):
        result = CliRunner().invoke(app, ["assess", str(path), "--docx", *more])
        assert result.exit_code == 2
        assert said in result.stderr
    monkeypatch.undo()


def test_a_docx_file_needs_a_directory(tmp_path: Path) -> None:
    pytest.importorskip("docx")
    path = tmp_path / "m.toml"
    path.write_text(MODEL + "[site.hazard.SLV]\na_g = 0.2\n", encoding="utf-8")
    result = CliRunner().invoke(app, ["assess", str(path), "--docx"])
    assert (result.exit_code, "give one with --out" in result.stderr) == (2, True)


@pytest.mark.parametrize(("language", "mark"), [("en", "."), ("it", ",")])
def test_figures_speak_the_language_of_the_report(language: str, mark: str) -> None:
    found = concio.assess(overturning(2), site=site(), direction="left")
    worst = found.worst
    assert worst is not None
    words = AssessmentReport(found, language=language).words
    ax = in_language(curve_figure(worst, words), language)
    figure = ax.get_figure(root=True)
    assert figure is not None
    figure.canvas.draw()
    labels = [t.get_text() for t in ax.get_xticklabels()]
    assert any(mark in text for text in labels)
    assert not any({"en": ",", "it": "."}[language] in text for text in labels)
    assert "$d_{\\mathrm{C}}$" in ax.get_xlabel()


def test_the_picture_of_the_model_has_its_dimensions() -> None:
    found = concio.assess(overturning(2), site=site(), direction="left", levels=["SLD"])
    texts = [t.get_text() for t in model_figure(found).texts]
    assert "0.6 m" in texts
    assert "6 m" in texts
    assert "c1" in texts


def test_sources_of_validation_are_those_of_the_book_and_translated() -> None:
    """The Italian annex named its sources in English; the English words are those of the validation book."""
    from concio.report.assessment_annex import validation_rows
    from concio.report.language import words_of

    en, it = (words_of("annex_words", language) for language in ("en", "it"))
    own = {key.removeprefix("source_"): text for key, text in en.items() if key.startswith("source_")}
    assert {case: validation_rows()[case]["source"] for case in own} == own
    assert all(it[f"source_{case}"] != text for case, text in own.items())


@pytest.mark.long
def test_what_was_assumed_is_told_in_the_language_of_the_report() -> None:
    found = concio.assess(overturning(), site=concio.Site({"SLV": {"a_g": 0.2, "F0": 2.4, "Tc": 0.3}}, assumed=(
        "soil", "nominal_life")), direction="left", levels=["SLV"])  # fmt: skip
    page = AssessmentReport(found, language="it").html()
    assert "nominal_life" not in page
    assert "50.0" not in page
    assert "vita nominale 50 anni" in page
    assert any("nominal life 50 years" in line for line in found.verdict.attention)
