"""Verdicts in Italian: the same numbers, the same names, and never a sentence that is not known whole."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import concio
from concio import Body, JointLaw, Model, Rigid
from concio.analysis.path import _finite_steps
from concio.contact.detection import Detection, detect
from concio.problem.solution import Status
from concio.report.italian_page import told_pieces
from concio.solvers.path.record import Event, Outcome
from concio.verdict import dynamics_verdict, path_verdict, push_verdict
from concio.verdict.attention import joints_not_made, without_area
from concio.verdict.italian import GAP, NUMBER, in_italian, italian
from concio.verdict.step_words import WORDS

TABLE = tomllib.loads((Path(concio.__file__).parent / "verdict" / "italian.toml").read_text(encoding="utf-8"))
ENTRIES = list(TABLE["sentences"].items())
WHOLE = [e for e in ENTRIES if not re.search("!(s|p|a|w)", e[0])]


@pytest.mark.parametrize(("english", "said"), ENTRIES, ids=lambda text: text[:40])
def test_both_languages_of_an_entry_have_the_same_gaps_once_each(english: str, said: str) -> None:
    gaps, own = [m[1] for m in GAP.finditer(english)], [m[1] for m in GAP.finditer(said)]
    assert sorted(gaps) == sorted(own)
    assert len(set(gaps)) == len(gaps)
    assert sorted(NUMBER.findall(english)) == sorted(NUMBER.findall(said))
    assert english.endswith(".") == said.endswith(".")


NO = re.compile(
    r"\b(no|not|nowhere|unlike|nothing|none|never|neither|undecided|without|cannot|withstands|locked?s?)\b", re.I
)
NON = re.compile(r"\b(no|non|nessun\w*|nulla|mai|né|indecis\w*|senza|bloccat\w*|blocca|resiste|illimitat\w*)\b", re.I)


@pytest.mark.parametrize(("english", "said"), ENTRIES, ids=lambda text: text[:40])
def test_what_is_denied_in_english_is_denied_in_italian(english: str, said: str) -> None:
    assert bool(NO.search(english)) == bool(NON.search(said))


@given(st.sampled_from(WHOLE), st.lists(st.floats(1e-3, 1e6), min_size=6, max_size=6))
def test_numbers_stay_as_they_are(entry: tuple[str, str], numbers: list[float]) -> None:
    values = iter(f"{v:.6g}" for v in numbers)
    text = GAP.sub(lambda _: next(values), entry[0])
    found = italian(text)
    assert [piece.language for piece in found] == ["it"], text
    assert sorted(NUMBER.findall(found[0].text)) == sorted(NUMBER.findall(text))


@given(st.text(alphabet="abc 'd.-1", min_size=1, max_size=60))
def test_what_is_not_known_stays_english_letter_by_letter(text: str) -> None:
    found = italian(text)
    assert all(piece.language == "en" for piece in found)
    assert " ".join(piece.text for piece in found).split() == text.split()


def test_every_outcome_of_a_step_a_path_a_push_and_a_motion_has_its_italian() -> None:
    heads = [w.headline for w in WORDS.values()] + [s.value for s in Status]
    for module in (path_verdict, push_verdict, dynamics_verdict):
        heads += list(module.HEADLINES.values())
    for head in heads:
        assert [piece.language for piece in italian(head)] == ["it"], head


def test_verdicts_that_were_reached_are_said_in_italian_with_their_numbers() -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=2, block="rigid", unit_weight=20.0, horizontal=1.0)
    found = concio.limit(pillar)
    said = italian(found.verdict.sentence)
    assert {piece.language for piece in said} == {"it"}
    assert f"{found.design:.6g} volte 'live'" in said[0].text
    step = italian(concio.solve(pillar, on_failure="return").verdict.sentence)
    assert step[0].text == TABLE["sentences"][Status.NO_EQUILIBRIUM.value]


FALLS = (
    "'r3' has sunk by 0.413 m below where it stood",
    "'a b' has turned by 60.3 degrees; 'r3' has turned by 60.2 degrees",
    "'r3' has sunk by 0.413 m below where it stood, and 3 more", "'a' has fallen by 3 m, below everything in the model",
    "'a' leans beyond its own equilibrium, at 12 degrees, and goes on",
)  # fmt: skip


@pytest.mark.parametrize("what", FALLS)
def test_how_blocks_fall_is_said_in_one_language(what: str) -> None:
    (said,) = italian(f"At 4.578 s it has fallen: {what}.")
    assert said.language == "it"
    assert said.text.startswith("A 4.578 s è caduta: '")
    assert not re.search(r"\b(has|by|and|the|it|more)\b", said.text)
    pieces = told_pieces(f"At 4.578 s it has fallen: {what}. Nobody knows this sentence.")
    assert pieces[0][0].startswith("A 4,578 s è caduta: '")


def test_a_sentence_is_not_translated_where_a_gap_would_reach_over_its_end() -> None:
    text = "The strength is lost. Nothing more is known at 3 mm."
    assert [piece.language for piece in italian(text)] == ["en"]


def test_sentences_of_the_window_have_decimal_commas_where_they_are_known() -> None:
    assert in_italian("The loads are carried. Nobody knows 0.5 of this.") == [
        ["La struttura sostiene i carichi.", "it"], ["Nobody knows 0.5 of this.", "en"]]  # fmt: skip
    seen = 0
    for english, said in WHOLE:
        pieces = in_italian(GAP.sub("12.5 m", english))
        if english.endswith(".") and GAP.search(english) and [language for _, language in pieces] == ["it"]:
            seen += 1
            assert pieces[0][0] == GAP.sub("12,5 m", said).replace("'12,5 m'", "'12.5 m'")
    assert seen > 50


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("kind", ["jumps", "restarts"])
def test_notes_of_finite_steps_and_of_stages_that_ended_are_known(kind: str, count: int) -> None:
    events = [Event(0.25, 0.0, 0, kind, 0, 1)] * count
    exact = SimpleNamespace(events=events, jumps=[e for e in events if e.kind == "jumps"])
    notes = _finite_steps(concio.Stage("wind", {"live": 1.0}), exact)  # type: ignore[arg-type]
    notes += [f"stage 'wind' ended at 0.25 of its load. {end.value}" for end in Outcome]
    assert len(notes) == 1 + len(Outcome)
    assert [note for note in notes if {p.language for p in italian(note)} != {"it"}] == []


def test_places_without_a_joint_are_said_in_one_language() -> None:
    """Five blocks over the ground and one on its tip: kinds, places, and how many more."""
    outlines = [[(2 * k, 3e-3), (2 * k + 1, 3e-3), (2 * k + 1, 1), (2 * k, 1)] for k in range(5)]
    rows = [Body(f"a{k}", outline, kind="rigid") for k, outline in enumerate(outlines)]
    rows += [Body("tip", [(12, 0), (12.5, 1), (11.5, 1)], kind="rigid")]
    ground = Body("ground", [(-1, -1), (20, -1), (20, 0), (-1, 0)], kind="fixed")
    for strength in (None, 1e3):
        law = JointLaw(0.6, compressive_strength=strength)
        model = Model((ground, *rows), {"block": Rigid(20.0)}, {"joint": law})
        said_of(detect(model), model)


def said_of(found: Detection, model: Model) -> None:
    """Check every sentence on places of a detection."""
    lines = (*joints_not_made(found), *without_area(model, found))
    assert len(lines) == len(found.point_contacts) + 1
    for line in lines:
        (said,) = italian(line)
        assert said.language == "it", line
        assert not re.search(r"\b(and|at|more|gap|corner|edge|partial|sliver|angle)\b", said.text), said.text
