"""What the author decides beside the code, behaviour factor and participating mass, and what is told of them."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio import InputError
from concio.analysis.seismic.assessment_asked import Head, read_asked
from concio.report.assessment_page import AssessmentReport
from samples import sample
from seismic_walls import overturning, site


@settings(max_examples=sample(3, 6, 12), deadline=None)
@given(st.floats(1.0, 4.0), st.floats(0.5, 1.0))
def test_onset_goes_with_the_share_of_the_mass_and_the_linear_demand_with_q(q: float, share: float) -> None:
    """a_0* = alpha_0 g / (e* FC), and the linear check compares it with a_max S / q."""
    asked = {"site": site(), "direction": "left", "levels": ["SLV"], "confidence": 1.35}
    plain = concio.assess(overturning(), **asked).worst  # type: ignore[arg-type]
    decided = concio.assess(overturning(), q=q, participation=share, **asked).worst  # type: ignore[arg-type]
    assert plain is not None
    assert decided is not None
    assert decided.e_star == share
    assert decided.onset == pytest.approx(plain.multiplier * 9.81 / (share * 1.35), rel=1e-9)
    assert decided.checks[0].demand == pytest.approx(plain.checks[0].demand * 2.0 / q, rel=1e-12)
    assert decided.limits["SLV"].d == pytest.approx(plain.limits["SLV"].d, rel=1e-12)
    assert decided.limits["SLV"].a == pytest.approx(plain.limits["SLV"].a * plain.e_star / share, rel=1e-12)


@pytest.mark.parametrize(("given", "notes"), [
    ({"q": 3.0}, ["q of 3 was given by the author; that of the code is 2"]),
    ({"q": 1.5}, []),
    ({"participation": 1.0}, []),
    ({"participation": 0.6}, ["e* = 0.6, was given by the author; that of a mechanism is 0.9456"]),
])  # fmt: skip
def test_what_is_less_safe_than_the_code_asks_for_attention(given: dict[str, float], notes: list[str]) -> None:
    found = concio.assess(overturning(), site=site(), direction="left", **given)  # type: ignore[arg-type]
    own = [line for line in found.notes if "author" in line]
    assert len(own) == len(notes)
    assert all(part in line for part, line in zip(notes, own, strict=True))
    assert all(line in found.verdict.attention for line in own)


@pytest.mark.long
def test_decisions_stand_in_the_report_with_their_reasons_in_its_language(tmp_path: Path) -> None:
    found = concio.assess(overturning(), site=site(), direction="left", q=1.5, participation=0.5, confidence=1.1)
    head = Head(reasons={"q": "carichi verticali elevati", "participation": "scelta di prova"})
    page = AssessmentReport(found, head=head, language="it").html()
    for words in ("carichi verticali elevati", "scelta di prova", "= 0,5 per ogni meccanismo", "indicata dall'autore",
                  "1,1 è indicato dall"):  # fmt: skip
        assert words in page.replace("&#x27;", "'"), words
    assert "was given by the author" not in page
    path = tmp_path / "m.toml"
    path.write_text('[column]\nwidth = 0.5\nheight = 2.0\nblocks = 1\n[site.hazard.SLV]\na_g = 0.2\n'
                    '[assessment]\nq = 1.5\nparticipation = 1.0\n', encoding="utf-8")  # fmt: skip
    arguments = read_asked(path).arguments
    assert (arguments["q"], arguments["participation"]) == (1.5, 1.0)


@pytest.mark.parametrize(("given", "said"), [
    ({"q": 0.9}, "must be at least 1"), ({"q": float("nan")}, "must be at least 1"),
    ({"participation": 0.0}, "must lie above 0"), ({"participation": 1.01}, "not above 1"),
])  # fmt: skip
def test_what_no_code_knows_is_refused(given: dict[str, float], said: str) -> None:
    with pytest.raises(InputError, match=said):
        concio.assess(overturning(), site=site(), direction="left", **given)  # type: ignore[arg-type]


def test_attention_to_the_model_is_told_in_italian() -> None:
    """A joint without friction worth the name: the sentence is that of every command, in the language of the report."""
    found = concio.assess(overturning(friction=2.5), site=site(), direction="left", levels=["SLV"])
    english = [line for line in found.verdict.attention if "friction" in line]
    assert english
    told = AssessmentReport(found, language="it").told.attention
    assert not set(english) & set(told)
    assert any("attrito" in line for line in told)
