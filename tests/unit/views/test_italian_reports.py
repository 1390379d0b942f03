"""Reports in Italian: no page in two languages, names as they were given, numbers as Italian writes them."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from html import unescape
from importlib.resources import files
from pathlib import Path

import pytest

import concio
from commands import run
from concio.motion import Pulse
from concio.plot.figures import suitable_figures
from concio.report.italian_page import figure_in, in_italian, plain_italian, report_catalogue
from concio.report.limit_page import limit_html
from concio.report.motion_page import motion_html
from concio.report.page import report_html
from concio.report.path_page import path_html
from concio.report.study_page import study_html
from concio.studies.variables import variable
from concio.verdict.italian import GAP, NUMBER
from concio.verdict.italian_numbers import commas

TABLE = tomllib.loads((files("concio.report") / "italian.toml").read_text(encoding="utf-8"))
ENGLISH = re.compile(
    r"\b(the|of|is|are|was|were|and|with|without|under|which|that|this|from|between|not|yes|at most|each|every|"
    r"block|blocks|joint|joints|load|loads|force|forces|step|steps|friction|equilibrium|found|carried|largest|"
    r"smallest|model|mean|runs?|view|colour|weight|support|supports|motion|certified|checked|asked|acts)\b",
    re.I,
)
"""Words of English that no Italian sentence has."""


def visible(page: str) -> str:
    """Return the text of a page that its reader sees, without the log of the solver and without names."""
    page = re.sub(r"<(script|style|ol lang)\b.*?</(script|style|ol)>", " ", page, flags=re.DOTALL)
    page = re.sub(r"<(\w+)\b[^>]*translate=no[^>]*>[^<]*</\1>", " ", page)
    marks = " ".join(re.findall(r'(?:alt|aria-label)="([^"]*)"', page))
    bare = re.sub(r"«[^»]*»|(?<!\w)'[^']*'(?!\w)", " ", unescape(re.sub(r"<[^>]*>", " ", page) + " " + marks))
    return re.sub(r"\b(Play|concio (run|path|limit|check|push|shake))\b", " ", bare)


def pillar(**more: float) -> concio.Model:
    return concio.column(width=0.5, height=2.0, blocks=2, block="rigid", unit_weight=20.0, horizontal=1.0, **more)


def arch() -> concio.Model:
    return concio.arch(span=3.0, ring=0.4, voussoirs=9, friction=0.6, crown_load=2.0, unit_weight=25)


def in_space() -> concio.Model:
    return concio.load(Path(str(files("concio.model") / "templates" / "drums.toml")))


def one_step(language: str) -> str:
    return report_html(concio.solve(arch()), language=language)  # type: ignore[arg-type]


def falls(language: str) -> str:
    return report_html(concio.solve(pillar(), on_failure="return"), language=language)  # type: ignore[arg-type]


def step_in_space(language: str) -> str:
    return report_html(concio.solve(in_space()), figures=False, language=language)  # type: ignore[arg-type]


def a_path(language: str) -> str:
    stages = [concio.Stage("peso", {"dead": 1.0}), concio.Stage("spinta", {"live": 5.0})]
    return path_html(concio.run_path(concio.assemble(pillar()), stages), language=language)  # type: ignore[arg-type]


def a_push(language: str) -> str:
    return motion_html(concio.push(pillar(), until=0.1), language)  # type: ignore[arg-type]


def a_motion(language: str) -> str:
    ground = Pulse("half sine", 0.5, 0.2)
    return motion_html(concio.dynamics(pillar(), ground, duration=0.3), language)  # type: ignore[arg-type]


def a_limit(language: str) -> str:
    return limit_html(concio.limit(pillar()), language)  # type: ignore[arg-type]


def drawn(values: dict[str, float]) -> concio.Model:
    wide = values["larghezza"]
    return concio.column(width=wide, height=2.0, blocks=2, block="rigid", unit_weight=20.0, horizontal=0.1)


def a_study(language: str) -> str:
    wide = variable("larghezza", "normal", mean=0.5, sd=0.02, unit="m")
    made = concio.study(drawn, [wide], ["associated_multiplier", "stands"], "latin-hypercube", size=6, seed=3)
    return study_html(made, title="Studio", language=language)  # type: ignore[arg-type]


PAGES = [one_step, falls, step_in_space, a_path, a_push, a_motion, a_limit, a_study]


@pytest.mark.long
@pytest.mark.parametrize("made", PAGES, ids=lambda made: made.__name__)
def test_no_page_is_in_two_languages(made: Callable[[str], str]) -> None:
    page = made("it")
    assert '<html lang="it">' in page
    assert re.findall(r'<span lang="en">(.*?)</span>', page) == []
    found = [m[0] for m in ENGLISH.finditer(visible(page))]
    assert not re.search(r"<(ul|ol|tbody)[^>]*>\s*</", page), "a heading with nothing below it"
    assert not re.search(r"\bstress\b", visible(page)), "tensione"
    assert found == [], [visible(page)[m.start() - 30 : m.end() + 30] for m in ENGLISH.finditer(visible(page))][:5]


def test_the_words_that_are_looked_for_stand_in_english_pages() -> None:
    assert len({m[0] for m in ENGLISH.finditer(visible(falls("en")))}) > 20


@pytest.mark.parametrize(("english", "said"), TABLE["sentences"].items(), ids=lambda text: text[:40])
def test_both_languages_have_the_same_gaps_and_numbers(english: str, said: str) -> None:
    assert sorted(m[1] for m in GAP.finditer(english)) == sorted(m[1] for m in GAP.finditer(said))
    assert sorted(NUMBER.findall(english)) == sorted(NUMBER.findall(said))
    assert english.endswith(".") == said.endswith(".")


def test_every_word_of_the_scripts_has_its_italian_and_no_other() -> None:
    scripts = "".join(
        (files("concio.report") / name).read_text(encoding="utf-8")
        for name in ("view_base.js", "view.js", "space_view.js", "motion.js", "motion_space.js")
    )
    quoted = set(re.findall(r'"([^"\n]*)"', scripts))
    said = set(re.findall(r'say\("([^"]*)"\)', scripts)) | set(re.findall(r'row\("([^"]*)"', scripts))
    said |= set(re.findall(r'item\([\w.]+, "([^"]*)"', scripts)) | {"open", "sticks", "slips", "is crushed"}
    assert said <= set(TABLE["scripts"])
    kinds = {"elastic", "rigid", "fixed"}  # of blocks, which come with the data
    assert set(TABLE["scripts"]) <= quoted | kinds


def test_figures_speak_the_language_of_the_page() -> None:
    for result in (concio.solve(arch()), concio.solve(pillar(), on_failure="return")):
        for name, draw in suitable_figures(result).items():
            for axes in (figure_in(draw(), "it"),):
                legend = axes.get_legend()
                texts = [axes.get_title(loc="left"), axes.get_xlabel(), axes.get_ylabel()]
                texts += [t.get_text() for t in (legend.get_texts() if legend else [])]
                found = [t for t in texts if t != result.model.title and ENGLISH.search(t)]
                assert found == [], name


def test_names_stay_as_they_were_given() -> None:
    model = pillar()
    bodies = tuple(replace(b, name={"b01": "open", "b02": "Blocks 1.5"}.get(b.name, b.name)) for b in model.bodies)
    page = report_html(concio.solve(replace(model, bodies=bodies, title="The model"), factors={"live": 0.0}),
                       figures=False, language="it")  # fmt: skip
    assert "<td translate=no>open</td>" in page
    assert "<td translate=no>Blocks 1.5</td>" in page
    assert "<h1 translate=no>The model</h1>" in page


@pytest.mark.parametrize(
    ("english", "said"),
    [
        ("1,024 at (0.5, 2) m", "1\u2009024 at (0,5; 2) m"),
        ("'b1.2' by 3.25 mm", "'b1.2' by 3,25 mm"),
        ("to 1.5e-12 of 2.", "to 1,5e-12 of 2."),
        ("concio 1.0", "concio 1.0"),
        ("version 0.9.1", "version 0.9.1"),
        ("dell'arco 'a' di 0.3", "dell'arco 'a' di 0,3"),
    ],
)
def test_numbers_have_commas_and_names_do_not(english: str, said: str) -> None:
    assert commas(english) == said


def test_what_is_not_known_is_marked() -> None:
    assert in_italian("<p>The loads are carried. Nobody knows this.</p>") == (
        '<p>La struttura sostiene i carichi. <span lang="en">Nobody knows this.</span></p>'
    )
    assert report_catalogue().whole("Nobody knows this.") is None
    assert plain_italian("0.5 kN") == "0,5 kN"


def test_limit_writes_a_report_in_the_language_asked_for(tmp_path: Path) -> None:
    file = tmp_path / "pillar.toml"
    concio.save(pillar(), file)
    code, _, errors = run("limit", file, "--quick", "--out", tmp_path / "out", "--language", "it")
    assert code == 0, errors
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "limite associato" in page
    told = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert f"{told['associated_multiplier']:.6g}".replace(".", ",") in page
    assert run("limit", file, "--language", "fr")[0] == 2
