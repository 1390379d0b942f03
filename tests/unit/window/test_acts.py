"""What will act, in words and kN, before a question runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import concio
from concio.window.acts import acts

ROOT = Path(__file__).resolve().parents[3]
TEMPLATES = Path(concio.__file__).parent / "model" / "templates"


def told(file: Path, question: str, **options: Any) -> list[str]:
    request = {"text": file.read_text(encoding="utf-8"), "base": str(file.parent), "folder": str(file.parent),
               "name": file.name, "question": question, "options": options}  # fmt: skip
    return list(acts(request, lambda *_: None)["lines"])


def test_a_limit_load_multiplies_the_chosen_groups_alone() -> None:
    model = concio.load(TEMPLATES / "arch.toml")
    asked = concio.limit(model, "live", path=False, steps=False, search=False).verdict.question.loads(model.report)
    lines = told(TEMPLATES / "arch.toml", "limit", groups=["live"])
    assert lines[0] == asked[0]
    assert lines[1].split("; at factor 1 ")[1] == asked[1].split("; at factor 1 ")[1]
    assert "live: constant" in " ".join(told(TEMPLATES / "arch.toml", "limit", groups=["dead"]))


def test_factors_of_a_run_are_those_of_its_field() -> None:
    assert "live x 1.5: constant" in " ".join(told(TEMPLATES / "arch.toml", "run", factor="live=1.5"))
    assert "live: not applied" in " ".join(told(TEMPLATES / "arch.toml", "run", factor="live=0"))
    assert "live: constant" in " ".join(told(TEMPLATES / "arch.toml", "run", factor="live=1."))


def test_a_push_of_the_weights_tells_what_its_verdict_tells(tmp_path: Path) -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=2, block="rigid", unit_weight=20.0)
    concio.save(pillar, tmp_path / "pillar.toml")
    lines = told(tmp_path / "pillar.toml", "push")
    found = concio.push(pillar, until=0.001).verdict.question.acting[-1]
    weight = float(sum(v * v for v in found.force)) ** 0.5
    assert weight == pytest.approx(20.0)
    assert "a horizontal share of all weights: multiplied; at factor 1 20 kN along x" in lines
    assert any("20 kN along -x" in line for line in told(tmp_path / "pillar.toml", "push", direction="-x"))


def test_a_settlement_tells_how_far_supports_go_and_multiplies_them_alone() -> None:
    file = ROOT / "examples" / "spreading_arch.toml"
    lines = told(file, "settle", moving="settlement", amount="2.5")
    assert "'right abutment' moves by 10 mm along x (support 'spreading')" in lines
    assert any(line.startswith("settlement: multiplied") for line in lines)
    assert any(line.startswith("dead: constant") for line in lines)
    assert "'right abutment' moves by 4 mm along x (support 'spreading')" in told(file, "settle", amount="2 m")
    assert "'right abutment' moves by 8 mm along x (support 'spreading')" in told(file, "run", factor="settlement=2")
    assert not [line for line in told(file, "run", factor="settlement=0") if "moves by" in line]


@pytest.mark.parametrize(
    ("file", "question", "word"),
    [
        (TEMPLATES / "bridge.toml", "bridge", "multiplied at every position"),
        (TEMPLATES / "assessment.toml", "assess", "mechanism by mechanism"),
        (TEMPLATES / "motion.toml", "shake", "the ground moves as the file states"),
        (ROOT / "examples" / "load_stages.toml", "path", "stage 1:"),
        (ROOT / "examples" / "spreading_arch.toml", "settle", "moves by 4 mm along x (support 'spreading')"),
        (ROOT / "examples" / "cracked_arch.toml", "diagnose", "supports are moved"),
        (ROOT / "examples" / "study_of_an_arch.toml", "study", "each run"),
    ],
)
def test_every_question_tells_what_it_adds(file: Path, question: str, word: str) -> None:
    lines = told(file, question)
    assert any(word in line for line in lines)
    assert any("kN" in line for line in lines)
