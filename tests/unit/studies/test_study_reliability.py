"""The reliability index that a study gives beside its sample, of the multiplier that its file requires."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from typer.testing import CliRunner

import concio
from concio import InputError
from concio.cli.main import app
from concio.report.study_page import study_html

WIDTH, HEIGHT = (0.5, 0.05), 2.0
PILLAR = {"column": {"width": 0.5, "height": HEIGHT, "blocks": 1, "block": {"kind": "rigid", "unit_weight": 20},
                     "friction": 0.9, "horizontal": 1.0}}  # fmt: skip
STUDY = """
[column]
width = 0.5
height = 2.0
blocks = 1
block = { kind = "rigid", unit_weight = 20 }
friction = 0.9
horizontal = 1.0

[study]
outputs = ["associated_multiplier"]
size = 40
required = 0.2
[[study.variables]]
name = "width"
keys = "column.width"
unit = "cm"
distribution = "normal"
mean = 50
sd = 5
"""


def width(**more: object) -> concio.Variable:
    return concio.variable("width", "normal", keys="column.width", mean=WIDTH[0], sd=WIDTH[1], **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(("required", "weight"), [(0.2, 1.0), (0.22, 1.0), (0.3, 1.0), (0.2, 2.0)])
def test_the_index_is_that_of_a_pillar_that_tips(required: float, weight: float) -> None:
    """lambda = width / height, times what the weight has over what pushes: a plane limit state."""
    found = concio.study(PILLAR, [width()], "associated_multiplier", size=4, required=required,
                         factors={"dead": weight})  # fmt: skip
    asked = found.required
    assert asked is not None
    assert asked.index is not None
    needed = required / weight * HEIGHT
    assert asked.index.beta == pytest.approx((WIDTH[0] - needed) / WIDTH[1], abs=1e-8)
    assert asked.index.point["width"] == pytest.approx(needed, rel=1e-8)
    assert "is required. Reliability index" in found.verdict.answer
    assert found.verdict.outcome.name == "HOLDS"


@pytest.mark.long
def test_a_file_asks_for_it_and_report_console_and_numbers_have_it(tmp_path: Path) -> None:
    path = tmp_path / "pillar.toml"
    path.write_text(STUDY, encoding="utf-8")
    told = json.loads(CliRunner().invoke(app, ["study", str(path), "--json"]).stdout)["required"]
    assert told["beta"] == pytest.approx(2.0, abs=1e-8)
    assert told["design_point"]["width"] == pytest.approx(40.0, rel=1e-8)
    found = concio.study(path)
    share = found.probability("associated_multiplier", below=0.2)
    assert share.low <= told["probability"] <= share.high
    for language, words in (("en", ("Reliability index 2 (first order)", "value at the design point")),
                            ("it", ("Indice di affidabilità 2 (primo ordine)", "valore nel punto di progetto",
                                    "È richiesto un moltiplicatore 0,2"))):  # fmt: skip
        page = study_html(found, figures=False, language=language)  # type: ignore[arg-type]
        assert all(word in page for word in words)
        assert '<span lang="en">' not in page[page.index("id=reliability"):page.index("id=failed")]


@pytest.mark.parametrize(("variables", "correlation", "why"), [
    ([width(), concio.variable("mu", "choice", keys="column.friction", values=(0.8, 0.9))], None, "continuous"),
    ([width(), concio.variable("mu", "normal", keys="column.friction", mean=0.9, sd=0.05)], {("width", "mu"): 0.5},
     "correlated"),
])  # fmt: skip
def test_an_index_that_does_not_exist_leaves_the_study_open(
    variables: list[concio.Variable], correlation: dict[tuple[str, str], float] | None, why: str
) -> None:
    found = concio.study(PILLAR, variables, "associated_multiplier", size=3, required=0.2, correlation=correlation)
    assert found.required is not None
    assert found.required.index is None
    assert any("reliability index" in line and why in line for line in found.verdict.unchecked)
    assert found.verdict.outcome.name == "INCOMPLETE"
    assert found.summary()["required"]["beta"] is None


def test_what_is_no_requirement_is_refused() -> None:
    with pytest.raises(InputError, match="must be a number"):
        concio.study(PILLAR, [width()], "associated_multiplier", size=3, required=math.nan)
    with pytest.raises(InputError, match="needs a model file"):
        concio.study(lambda _: concio.column(width=0.5, height=2.0, blocks=1), [concio.variable("x", low=0, high=1)],
                     "stands", size=3, required=0.2)  # fmt: skip


def test_the_terminal_states_the_index_that_was_asked_for(tmp_path: Path) -> None:
    """It stood in the report and in --json alone."""
    (tmp_path / "pillar.toml").write_text(STUDY.replace("size = 40", "size = 3"))
    asked = ["study", str(tmp_path / "pillar.toml"), "--no-figures", "--out", str(tmp_path / "o")]
    out = CliRunner().invoke(app, asked)
    assert "Reliability index 2 (first order)" in out.output


def test_a_multiplier_without_derivative_is_told_and_not_a_traceback() -> None:
    """Blocks that come and go beside the model have no rows of derivatives."""

    def model(values: dict[str, float]) -> concio.Model:
        count = 2 if values["n"] == 2.0 else 3
        return concio.column(width=0.5, height=2.0, blocks=count, block="rigid", horizontal=1.0)

    with pytest.raises(InputError, match="no derivative with respect to 'n'"):
        concio.multiplier_over(model)({"n": 2.0})


def test_correlations_that_contradict_each_other_are_refused(tmp_path: Path) -> None:
    """The last one counted."""
    variables = [width(), concio.variable("mu", "normal", keys="column.friction", mean=0.9, sd=0.05)]
    with pytest.raises(InputError, match=r"'width' and 'mu' is 0\.5, and of 'mu' and 'width' -0\.5"):
        concio.study(PILLAR, variables, "stands", size=3, correlation={("width", "mu"): 0.5, ("mu", "width"): -0.5})
    text = STUDY + 'distribution = "normal"\n'.join(["[[study.variables]]\nname = \"mu\"\nkeys = \"column.friction\"\n",
                                                     "mean = 0.9\nsd = 0.05\n"])  # fmt: skip
    for pair in (["width", "mu"], ["mu", "width"]):
        text += f"[[study.correlation]]\nbetween = {json.dumps(pair)}\nrank = 0.5\n"
    (tmp_path / "pillar.toml").write_text(text)
    out = CliRunner().invoke(app, ["study", str(tmp_path / "pillar.toml"), "--out", str(tmp_path / "o")])
    assert out.exit_code == 2
    assert "is stated twice" in out.output


@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_a_factor_of_what_is_multiplied_does_not_act_and_is_told(factor: float) -> None:
    """The same multipliers with and without a factor of the live group, and not a word of it."""
    found = concio.study(PILLAR, [width()], "associated_multiplier", size=3, factors={"live": factor})
    assert found.values("associated_multiplier") == pytest.approx(found.values("width") / HEIGHT, rel=1e-9)
    told = [line for line in found.verdict.limits if "does not act on associated_multiplier" in line]
    assert len(told) == (factor != 1.0)
