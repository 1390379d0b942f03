"""Journeys through the window in a real browser: what an engineer does, with the mouse or by keyboard alone.

    make journeys

They are no part of `pytest tests`, because they need Chromium; `.ci/run` makes them and tells loudly where it cannot.
"""

from __future__ import annotations

import base64
import dataclasses
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest
from matplotlib.image import imsave

import concio
from browser import Browser, browser
from concio.post.force_lines import force_chains
from concio.verdict.limit_words import bound_lines
from ifc_files import IfcText
from rendered import rendered
from windows import LATE, Client
from windows import window as served

ROOT = Path(__file__).resolve().parents[2]
TEMPLATES = Path(concio.__file__).parent / "model" / "templates"
PILLAR = """title = "pillar"   # a comment that stays
[column]
width = 0.5
height = 2.0
blocks = 4
block = "rigid"
unit_weight = 20.0
[[loads]]
kind = "point"
value = [1.0, 0.0]
bodies = ["b04"]
at = [-0.25, 2.0]
group = "live"
"""
DRAWN = "window.concio && window.concio.pictured()"
ANSWERED = "document.querySelector('#running').hidden && document.querySelector('#verdict-text .sentence')"
SETTLED = "window.concio.pictured().startsWith(window.concio.state().document.hash)"
SAID = "document.querySelector('#verdict-text summary')"
AUDIT = (Path(__file__).parent / "audit.js").read_text(encoding="utf-8")


def test_the_audit_sees_what_is_wrong(page: Browser, client: Client) -> None:
    opened(page, client)
    assert page.js(AUDIT) == []
    page.js("""(() => { const p = document.createElement('p'); p.textContent = 'faint'; p.style.color = '#999';
        p.style.background = '#fff'; document.querySelector('main section').append(p, document.createElement('input'));
        const b = document.createElement('button'); b.id = 'undo'; document.querySelector('header').append(b); })()""")
    assert [line.split(":")[0].split(" ")[0] for line in page.js(AUDIT)] == ["no", "contrast", "no", "twice"]
    page.js("""(() => { document.querySelector('main section > input').style.borderColor = '#ccc';
        document.querySelector('#picture text').style.fill = '#bbb'; })()""")
    found = page.js(AUDIT)
    assert "in the picture" in found[0]
    assert sum(line.startswith("rim") for line in found) == 1


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with browser() as found:
        THERE[:] = [found]
        yield found


THERE: list[Browser] = []


@contextmanager
def window(folder: Path, file: Path | None = None) -> Iterator[Client]:
    """Give a client of a window; the page is left before the window closes: it asks for its state every second."""
    with served(folder, file) as found:
        yield found
        for one in THERE:
            one.go("about:blank")
            one.until("location.href === 'about:blank'")


@pytest.fixture
def page(chromium: Browser) -> Iterator[Browser]:
    """A browser with nothing kept; after the journey: no complaint, and no request left the machine."""
    chromium.events.clear()
    yield chromium
    assert chromium.complaints == []
    assert [r for r in chromium.requests if not r.startswith(("http://127.0.0.1:", "data:", "about:"))] == []
    chromium.go("about:blank")


@pytest.fixture
def client(tmp_path: Path) -> Iterator[Client]:
    file = tmp_path / "pillar.toml"
    file.write_text(PILLAR, encoding="utf-8")
    with window(tmp_path, file) as found:
        yield found


def opened(page: Browser, client: Client) -> None:
    page.go(client.server.address)
    page.until(DRAWN, "the picture")


def text_of(client: Client) -> str:
    return str(client.call("state")["document"]["text"])


def value(page: Browser, selector: str, text: str) -> None:
    """Write into a field as a person does."""
    page.js(
        f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.focus(); e.select && e.select(); }})()"
    )
    page.type(text)
    page.js("document.activeElement.blur()")


def test_a_load_is_clicked_asked_reported_and_survives_a_killed_server(page: Browser, tmp_path: Path) -> None:
    file = tmp_path / "arch.toml"
    shutil.copy(TEMPLATES / "arch.toml", file)
    command = [sys.executable, "-m", "concio", "window", str(file), "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        address = process.stdout.readline().split()[-1]
        page.go(address)
        page.until(DRAWN)
        page.click("[data-tool=load]")
        page.click_at(*page.where(-0.95, 1.6454))
        page.until("document.querySelector('#pane-build [name=body]').value")
        value(page, "#pane-build [name=value]", "0, -4")
        page.click("#pane-build button.main")
        page.until("window.concio.view.shown.loads.length === 3")
        page.click("#tab-ask")
        page.click("[data-question=run]")
        page.click("#run")
        page.until(ANSWERED)
        said = page.js("document.querySelector('#verdict-text .sentence').textContent")
        text = page.js("window.concio.state().document.text")
        assert said == concio.solve(concio.loads(text)).verdict.sentence
        page.click("#tab-report")
        page.until("document.querySelector('#pane-report iframe')")
        process.send_signal(signal.SIGKILL)
    page.until("document.querySelector('[data-banner=gone]')", "the page says that the program has ended")
    assert file.read_text(encoding="utf-8") != text
    page.events.clear()
    with window(tmp_path, file) as again:
        opened(page, again)
        assert text_of(again) == text
        page.until("document.querySelector('[data-banner=recovered]')")
        page.press("z", ctrl=True)
        page.until("window.concio.state().document.redo")
        assert text_of(again) == file.read_text(encoding="utf-8")
        page.press("y", ctrl=True)
        page.until("!window.concio.state().document.saved", "what was undone stands in the file: it counted as saved")
        page.press("s", ctrl=True)
        page.until("window.concio.state().document.saved")
    assert file.read_text(encoding="utf-8") == text


def test_from_a_drawing_to_a_limit_load(page: Browser, tmp_path: Path) -> None:
    shutil.copy(ROOT / "examples" / "facade.dxf", tmp_path / "facade.dxf")
    with window(tmp_path) as client:
        page.go(client.server.address)
        page.until("document.querySelector('#start').open")
        page.js("[...document.querySelectorAll('#start button')].find((b) => b.textContent === 'facade.dxf').click()")
        page.until("document.querySelector('#pane-layers table')")
        page.until(DRAWN)
        assert "faults" in page.js("document.querySelector('#fault').textContent")
        assert str(tmp_path) not in page.js("document.querySelector('#fault').textContent")
        page.js("[...document.querySelectorAll('#pane-layers button')].find((b) => !b.disabled).click()")
        page.until('/FONDAZIONE = "fixed"/.test(window.concio.state().document.text)')
        for selector, text in (("#pane-layers input[placeholder='0.5 mm']", "0.5 mm"),):
            value(page, selector, text)
        page.until('/mend = "0.5 mm"/.test(window.concio.state().document.text)')
        for layer, load in (("SOLAIO", "0, -24"), ("COPERTURA", "0, -10")):
            page.until(f"document.querySelector(\"select[aria-label$='{layer}']\")")
            page.js(f"(() => {{ const s = document.querySelector(\"select[aria-label$='{layer}']\"); s.value = 'load'; "
                    "s.dispatchEvent(new Event('change')); })()")  # fmt: skip
            value(page, f"input[aria-label$='{layer}']", load)
            page.until(f"/{layer} = .*load/.test(window.concio.state().document.text)")
        page.until(
            f"{SETTLED} && window.concio.view.shown && window.concio.view.shown.loads.length === 3", "the facade"
        )
        field = "document.querySelector(\"input[aria-label$='SOLAIO']\")"
        page.js(f"({field}.focus(), {field}.select())")
        page.type("0, -2")
        client.page = page.js("sessionStorage.getItem('page')")
        assert "error" not in client.do({"do": "set", "path": ["title"], "value": "another"})
        page.until(f"{SETTLED} && /another/.test(window.concio.state().document.text)")
        time.sleep(1.0)  # the table of the layers is filled again
        page.type("4")
        page.press("Tab")
        page.until("/SOLAIO = .*-24/.test(window.concio.state().document.text)")
        assert "value = [0, -2]" not in text_of(client)
        page.until(SETTLED)
        chosen = {"FONDAZIONE": "fixed", "SOLAIO": "load", "COPERTURA": "load", "ASSI": "ignore", "QUOTE": "ignore"}
        for layer, meaning in chosen.items():
            page.until(f"document.querySelector(\"select[aria-label$='{layer}']\")?.value === '{meaning}'", layer)
        assert "ASSI" in text_of(client)
        begun = "(document.querySelector('#begun')?.textContent || '')"
        assert all(one in page.js(begun) for one in ("thickness 1.0", "unit_weight 20 kN/m3", "friction 0.6"))
        page.click("#tab-data")
        value(page, "[id='value-analysis-thickness']", "0.5")
        page.until(f"{SETTLED} && /thickness = 0.5/.test(window.concio.state().document.text)")
        page.until(f"!/thickness/.test({begun}) && /friction/.test({begun})")
        page.js("document.querySelectorAll('#begun button')[1].click()")
        page.until(f"{SETTLED} && {begun} === ''")
        assert "state yours" not in text_of(client)
        page.click("[data-tool=load]")
        page.js("(() => { const k = document.querySelector('#pane-build [name=kind]'); k.value = 'weight'; "
                "k.dispatchEvent(new Event('change')); })()")  # fmt: skip
        page.click("#pane-build button.main")
        page.until(f"{SETTLED} && window.concio.view.shown.loads.length === 4")
        page.click("#tab-ask")
        page.click("[data-question=limit]")
        page.js("document.querySelector('#pane-ask label.row input').click()")
        page.until("/multiplied/.test(document.querySelector('#acts').textContent)")
        acts = page.js("document.querySelector('#acts').textContent")
        assert "live: multiplied" in acts
        assert "kN" in acts
        page.click("#run")
        page.until(ANSWERED)
        model = concio.loads(text_of(client), folder=tmp_path)
        found = concio.limit(model, path=False, steps=False, search=False)
        number = f"{found.associated.multiplier:.6g}"
        assert number in page.js("document.querySelector('#verdict-text .sentence').textContent")
        assert page.js(AUDIT) == []


def test_what_is_shown_while_a_load_is_dragged_is_certified_or_grey(page: Browser, client: Client) -> None:
    opened(page, client)
    page.js("""(() => { window.seen = []; new MutationObserver(() => { const b = document.getElementById('bound');
        window.seen.push([b.className, b.textContent]); }).observe(document.getElementById('bound'),
        { attributes: true, childList: true, subtree: true }); })()""")
    page.mouse("mousePressed", *page.where(-0.25, 2.0))
    heights = [2.0 - 0.05 * k for k in range(1, 16)]
    for y in heights:
        page.mouse("mouseMoved", *page.where(-0.3, y))
        time.sleep(0.05)
    page.until("!document.getElementById('bound').hidden && document.getElementById('bound').className === ''")
    shown = page.js("document.getElementById('bound').textContent")
    page.mouse("mouseReleased", *page.where(-0.3, heights[-1]))
    page.until("window.concio.state().document.undo")
    page.until(SETTLED)
    text = text_of(client)
    bound = concio.limit(concio.loads(text), path=False, steps=False, search=False).associated.multiplier
    assert f"{bound:.6g}" in shown
    assert text.startswith('title = "pillar"   # a comment that stays\n')
    fresh = [said for kind, said in page.js("window.seen") if kind == "" and said]
    assert fresh
    assert all("no equilibrium beyond it" in said for said in fresh)


WATCHED = """(() => { window.seen = []; const b = document.getElementById('bound');
    const note = () => window.seen.push({ kind: b.className, said: b.hidden ? '' : b.textContent,
        to: window.concio.dragging()?.to || null });
    new MutationObserver(note).observe(b, { attributes: true, childList: true, subtree: true }); })()"""


@pytest.mark.parametrize("model", ["arch", "facade"])
def test_a_dragged_load_shows_its_own_bound_or_a_grey_one(page: Browser, tmp_path: Path, model: str) -> None:
    """Whenever the bound is not grey, it is that of the place where the load is held at that moment."""
    if model == "arch":
        shutil.copy(TEMPLATES / "arch.toml", tmp_path)
    else:
        for suffix in ("dxf", "toml"):
            shutil.copy(ROOT / "examples" / f"facade.{suffix}", tmp_path)
    before = concio.load(tmp_path / f"{model}.toml")
    tops = [p for b in before.free_bodies for p in b.rings[0]]
    highest = max(p[1] for p in tops)
    width = max(p[0] for p in tops if p[1] > highest - 1e-3)
    way = [(-1.5 + 0.2 * k, 1.75) for k in range(8)] if model == "arch" else [
        (0.2 + (width - 0.4) * k / 7, highest + 0.02) for k in range(8)
    ]  # fmt: skip
    with window(tmp_path, tmp_path / f"{model}.toml") as client:
        opened(page, client)
        page.until("window.concio.view.shown && !window.concio.view.shown.early")
        page.click("[data-tool=load]")
        page.click_at(*page.where(way[0][0], way[0][1] - (0.0 if model == "facade" else 0.55)))
        page.until("document.querySelector('#pane-build [name=body]').value")
        value(page, "#pane-build [name=value]", "0, -5" if model == "arch" else "5, -1")
        value(page, "#pane-build [name=group]", "moved")
        page.click("#pane-build button.main")
        page.until(f"{SETTLED} && window.concio.view.shown.loads.at(-1).group === 'moved'")
        page.click("[data-tool=select]")
        at = page.js("window.concio.view.shown.loads.at(-1).at")
        text = text_of(client)
        page.js(WATCHED)
        page.mouse("mousePressed", *page.where(*at))
        fresh = "!document.getElementById('bound').hidden && document.getElementById('bound').className === ''"
        for k, place in enumerate(way):
            for share in (0.5, 1.0):
                from_ = way[k - 1] if k else at
                spot = [a + share * (b - a) for a, b in zip(from_, place, strict=True)]
                page.mouse("mouseMoved", *page.where(*spot))
                told = page.js("[document.getElementById('bound').hidden, document.getElementById('bound').className]")
                assert told[0] or told[1] == "old", "grey as soon as the load has moved"
            if k % 3 == 1:
                page.until(fresh)
        page.until(fresh)
        page.mouse("mouseReleased", *page.where(*way[-1]))
        page.until(f"{SETTLED} && window.concio.state().document.undo && document.getElementById('bound').hidden")
        notes = [n for n in page.js("window.seen") if n["kind"] == "" and n["said"] and n["to"]]
        asked = {(n["to"]["body"], *n["to"]["at"]): n["said"] for n in notes}
        assert len(asked) >= 3
        assert all("Where it stands now" in said for said in asked.values())
        described = concio.loads(text, folder=tmp_path)
        for (body, *spot), said in asked.items():
            moved = dataclasses.replace(described.loads[-1], at=tuple(spot), bodies=(body,))
            held = dataclasses.replace(described, loads=(*described.loads[:-1], moved))
            bound = concio.limit(held, "moved", path=False, steps=False, search=False)
            assert all(" ".join(line.split()) in said for line in bound_lines(bound)), (body, spot)
            assert f"{bound.associated.multiplier:.6g}" in said, (body, spot)
        assert len({said for said in asked.values()}) > 1, "the bound follows the load"
        after = concio.loads(text_of(client), folder=tmp_path).loads[-1]
        last = list(asked)[-1]
        assert (after.bodies, after.at) == ((last[0],), tuple(last[1:]))


def tab_to(page: Browser, condition: str, *, back: bool = False) -> None:
    """Go from control to control until a condition on the element ``e`` holds; each shows that it has the focus."""
    for _ in range(120):
        if page.js(f"(() => {{ const e = document.activeElement; return Boolean({condition}); }})()"):
            return
        page.press("Tab", shift=back)
        ring = page.js("getComputedStyle(document.activeElement).outlineStyle")
        assert ring != "none" or page.js("document.activeElement === document.body")
    raise AssertionError(condition)


def test_the_keyboard_alone_leads_from_the_first_page_to_the_verdict(page: Browser, tmp_path: Path) -> None:
    with window(tmp_path) as client:
        page.go(client.server.address)
        page.until("document.querySelector('#start').open")

        tab_to(page, "e.textContent === 'column'")
        page.press("Enter")
        page.until(f"{DRAWN} && window.concio.view.shown")
        page.press("p")
        page.press("ArrowUp")
        page.press("ArrowUp")
        assert page.js("window.concio.view.selected.bodies.size") == 1
        page.press("l")
        page.press("p")
        page.press("Enter")
        assert page.js("document.querySelector('#pane-build [name=body]').value")
        tab_to(page, "e.matches('#pane-build button.main')")
        page.press("Enter")
        page.until("window.concio.state().document.undo")
        page.press("Escape")
        page.press("3", alt=True)
        page.until(SETTLED)
        tab_to(page, "e.id === 'run' && !e.disabled")
        page.press("Enter")
        page.until(ANSWERED)
        assert page.js("document.querySelector('#verdict-text').getAttribute('aria-live')") == "polite"
        page.press("?")
        page.until("document.querySelector('#help').open")
        page.press("Escape")
        page.until("!document.querySelector('#help').open")


def test_text_and_picture_follow_each_other_and_mistakes_are_told(page: Browser, client: Client) -> None:
    opened(page, client)
    page.click("#tab-text")
    area = "#pane-text textarea"
    value(page, area, PILLAR.replace("blocks = 4", "blocks = "))
    page.js("document.querySelector('#pane-text button').click()")
    page.until("/line 5/.test(document.querySelector('#fault').textContent)")
    page.js("document.querySelector('#undo').click()")
    page.until("!document.querySelector('#fault').textContent")
    value(page, area, PILLAR.replace("blocks = 4", "blocks = 6").replace("b04", "b06"))
    page.js("document.querySelector('#pane-text button').click()")
    page.until("window.concio.view.shown.bodies.length === 7")
    page.click("#tab-data")
    value(page, "[id='value-column-width']", "60 cm")
    page.until('/width = "60 cm"/.test(window.concio.state().document.text)')
    assert 'title = "pillar"   # a comment that stays' in text_of(client)
    page.click("#tab-tables")
    page.js("document.querySelector(\"[data-row='bodies 3']\").click()")
    assert page.js("document.querySelectorAll('#picture .body.on').length") == 1
    page.click_at(*page.where(0.0, 1.8))
    chosen = page.js("document.querySelector('tr[aria-selected=true]').textContent")
    assert chosen.startswith("b06")
    page.js("document.querySelector(\"[data-row='things load 1'] button\").click()")
    page.until("window.concio.view.shown.loads.length === 1")
    page.click("#tab-python")
    program = page.js("document.querySelector('#pane-python pre').textContent")
    client.call("save")
    done = subprocess.run([sys.executable, "-c", program], cwd=client.server.session.folder, capture_output=True,
                          text=True, timeout=LATE, check=True)  # fmt: skip
    assert "equilibrium" in done.stdout


def test_a_load_on_a_fixed_body_is_refused_where_it_is_clicked(page: Browser, client: Client) -> None:
    opened(page, client)
    page.click("[data-tool=load]")
    page.click_at(*page.where(*page.js("window.concio.view.shown.bodies.find((b) => b.kind === 'fixed').centre")))
    assert "is fixed" in page.js("document.querySelector('#pane-build [role=alert]').textContent")
    assert page.js("document.querySelector('#pane-build [name=body]').value") == ""
    page.click_at(*page.where(0.0, 1.8))
    assert page.js("document.querySelector('#pane-build [role=alert]').textContent") == ""
    assert page.js("document.querySelector('#pane-build [name=body]').value") == "b04"


def chosen(page: Browser) -> set[str]:
    """Return the names of the selected blocks."""
    code = "[...window.concio.view.selected.bodies].map((k) => window.concio.view.shown.bodies[k].name)"
    return set(page.js(code))


def pick(page: Browser, selector: str, text: str) -> None:
    """Choose the entry of a list that shows a text."""
    page.js(f"(() => {{ const s = document.querySelector({json.dumps(selector)}); "
            f"s.value = [...s.options].find((o) => o.textContent === {json.dumps(text)}).value; "
            "s.dispatchEvent(new Event('change')); })()")  # fmt: skip


def test_blocks_are_selected_by_course_and_layer_and_given_a_material_and_a_load(page: Browser, tmp_path: Path) -> None:
    for suffix in ("dxf", "toml"):
        shutil.copy(ROOT / "examples" / f"facade.{suffix}", tmp_path)
    before = concio.load(tmp_path / "facade.toml")
    with window(tmp_path, tmp_path / "facade.toml") as client:
        opened(page, client)
        page.until("window.concio.view.shown && !window.concio.view.shown.early")
        page.click("#tab-build")
        one = next(b for b in before.free_bodies if b.layer == "MURATURA")
        page.click_at(*page.where(*one.centroid))
        assert chosen(page) == {one.name}
        page.click("#like-course")
        low, high = (f(p[1] for p in one.rings[0]) for f in (min, max))
        level = {b.name for b in before.free_bodies if low < b.centroid[1] < high}
        assert chosen(page) == level
        assert len(level) > 5
        assert "layer" in page.js("document.querySelector('#pane-build').textContent"), "a material is one of a layer"
        assert page.js("document.querySelector('#apply-material')") is None
        page.click("#load-selected")
        assert page.js("document.querySelector('#pane-build [name=kind]').value") == "weight"
        value(page, "#pane-build [name=value]", "0.2, 0")
        value(page, "#pane-build [name=group]", "course")
        page.click("#pane-build button.main")
        page.until(f"{SETTLED} && window.concio.view.shown.loads.length === {len(before.loads) + 1}")
        loaded = concio.loads(text_of(client), folder=tmp_path).loads[-1]
        assert (loaded.kind, loaded.value, loaded.group, set(loaded.bodies)) == ("weight", (0.2, 0.0), "course", level)
        page.click("[data-tool=select]")
        for layer in ("MURATURA", "ARCHITRAVI"):
            pick(page, "[name=select-by]", layer)
            whole = {b.name for b in before.free_bodies if b.layer == layer}
            assert chosen(page) == whole
            other = "granite" if layer == "MURATURA" else "stone"
            pick(page, "[name=set-material]", other)
            page.click("#apply-material")
            page.until(f"{SETTLED} && window.concio.view.shown.bodies.filter((b) => b.layer === '{layer}')"
                       f".every((b) => b.material === '{other}')")  # fmt: skip
            model = concio.loads(text_of(client), folder=tmp_path)
            assert {b.material for b in model.bodies if b.layer == layer} == {other}
        assert {b.role for b in model.bodies if b.layer == "ARCHITRAVI"} == {"lintel"}, "what else is said of it stays"
        page.click("[data-tool=load]")
        page.click("[data-tool=select]")
        assert page.js(AUDIT) == []


def test_stones_of_the_text_are_given_a_material_by_course(page: Browser, tmp_path: Path) -> None:
    wall = concio.wall(block_size=(0.5, 0.25), length=2.0, height=1.0, block="rigid")
    tuff = '\n[materials.tuff]\nkind = "rigid"\nunit_weight = "14 kN/m3"\n'
    (tmp_path / "wall.toml").write_text(concio.dumps(wall) + tuff, encoding="utf-8")
    with window(tmp_path, tmp_path / "wall.toml") as client:
        opened(page, client)
        page.until("window.concio.view.shown && !window.concio.view.shown.early")
        page.click("#tab-build")
        page.click_at(*page.where(1.1, 0.6))
        page.js("document.querySelector('#like-course').focus()")
        page.press("Enter")
        names = chosen(page)
        assert names == {b.name for b in wall.free_bodies if 0.5 < b.centroid[1] < 0.75}
        client.page = page.js("sessionStorage.getItem('page')")
        first = '[[blocks]]\nname = "first"\nrectangle = [[3, 0], [3.5, 0.25]]\nmaterial = "block"\n\n'
        text = text_of(client).replace("[[blocks]]", first + "[[blocks]]", 1)
        assert "error" not in client.do({"do": "text", "text": text})
        page.until(f"{SETTLED} && window.concio.view.shown.bodies.length === {len(wall.bodies) + 1}")
        assert chosen(page) == names, "numbers of blocks change, the selection does not"
        pick(page, "[name=set-material]", "tuff")
        page.click("#apply-material")
        page.until(f"{SETTLED} && window.concio.view.shown.bodies.some((b) => b.material === 'tuff')")
        model = concio.loads(text_of(client))
        assert {b.name for b in model.bodies if b.material == "tuff"} == names
        page.click("[data-tool=load]")
        value(page, "#pane-build [name=body]", ", ".join(sorted(names)))
        value(page, "#pane-build [name=at]", "1, 0.6")
        page.click("#pane-build button.main")
        assert "one block" in page.js("document.querySelector('#pane-build [role=alert]').textContent")
        client.call("new", kind="column")
        page.until(f"window.concio.state().document.name === 'column.toml' && {SETTLED}")
        assert chosen(page) == set(), "another model has other blocks"


PLACES = """(() => { const names = ['#tab-tables', '#run', '#picture', '#attention', '#verdict-head'];
    window.places = Object.fromEntries(names.map((name) => [name, []]));
    const note = () => {
        for (const name of window.concio ? names : []) {
            const r = document.querySelector(name)?.getBoundingClientRect(), at = [r?.x, r?.y].map(Math.round).join();
            if (r?.width && !window.places[name].includes(at)) window.places[name].push(at);
        }
        requestAnimationFrame(note);
    };
    note(); })()"""


def test_nothing_moves_away_from_the_pointer_while_a_question_is_answered(page: Browser, client: Client) -> None:
    script = page.send("Page.addScriptToEvaluateOnNewDocument", source=PLACES)["identifier"]
    opened(page, client)
    page.until("document.querySelector('#run') && !document.querySelector('#run').disabled")
    aim = page.js("(() => { const r = document.querySelector('#tab-tables').getBoundingClientRect(); "
                  "return [r.x + r.width / 2, r.y + r.height / 2]; })()")  # fmt: skip
    for question in ("run", "limit", "run"):
        page.click("#tab-ask")
        page.click(f"[data-question={question}]")
        page.click("#run")
        assert page.js("!document.querySelector('#running').hidden"), "the page is busy as soon as it is asked"
        page.click_at(*aim)
        assert page.js("!document.querySelector('#pane-tables').hidden")
        page.until(ANSWERED)
        asked = page.js("window.concio.state().asked")
        assert (asked["question"], asked["state"]) == (question, "done")
    page.click("#tab-ask")
    assert page.js("document.querySelector('#say').textContent") == ""
    places = page.js("window.places")
    assert {name: len(found) for name, found in places.items()} == dict.fromkeys(places, 1), places
    page.send("Page.removeScriptToEvaluateOnNewDocument", identifier=script)


def test_an_answer_that_is_computed_again_replaces_the_one_before(page: Browser, client: Client) -> None:
    opened(page, client)
    page.until("document.querySelector('#run') && !document.querySelector('#run').disabled")
    lane = client.server.session.asked.lane
    page.click("#run")
    end = time.monotonic() + LATE
    while lane.job is None or lane.job.request["kind"] != "ask" or lane.job.state != "working":
        assert time.monotonic() < end
        time.sleep(0.002)
    os.kill(lane.pid or 0, signal.SIGKILL)
    page.until("/ended from outside/.test(document.querySelector('#verdict-text').textContent)")
    page.click("#run")
    page.until(ANSWERED)
    assert "In equilibrium" in page.js("document.querySelector('#verdict-text .sentence').textContent")
    page.click("#tab-tables")
    heads = "[...document.querySelectorAll('#pane-tables th')].some((e) => e.textContent === 'N [kN]')"
    page.until(heads)
    client.page = page.js("sessionStorage.getItem('page')")
    client.do({"do": "set", "path": ["column", "width"], "value": 0.6})
    page.until(f"{SETTLED} && !({heads})")
    client.call("undo")
    page.until(f"{SETTLED} && {heads}", "numbers of the model that was asked, which is here again")


def test_two_pages_and_a_file_that_changes_underneath(page: Browser, client: Client) -> None:
    opened(page, client)
    other = Client(client.server, "another page")
    assert not other.call("state")["mine"]
    other.call("take")
    page.until("document.querySelector('[data-banner=pen]')")
    assert page.js("document.querySelector('#save').disabled")
    page.js("document.querySelector('[data-banner=pen] button').click()")
    page.until("!document.querySelector('[data-banner=pen]')")
    page.click("#tab-data")
    value(page, "[id='value-column-width']", "0.7")
    page.until("window.concio.state().document.undo")
    file = client.server.session.document.file  # type: ignore[union-attr]
    file.write_text(PILLAR + "# theirs\n", encoding="utf-8")
    page.until("document.querySelector('[data-banner=conflict]')")
    page.js("document.querySelectorAll('[data-banner=conflict] button')[1].click()")
    page.until("/# theirs/.test(window.concio.state().document.text)")
    page.press("z", ctrl=True)
    page.until("/width = 0.7/.test(window.concio.state().document.text)")


def test_a_support_is_moved_by_clicking_and_its_settlement_is_asked(page: Browser, tmp_path: Path) -> None:
    shutil.copy(TEMPLATES / "arch.toml", tmp_path / "arch.toml")
    with window(tmp_path, tmp_path / "arch.toml") as client:
        opened(page, client)
        page.until("document.querySelector('#run') && !document.querySelector('#run').disabled")
        page.click("[data-question=settle]")
        assert "a support that moves" in page.js("document.querySelector('#missing').textContent")
        page.click("#missing button")
        page.click_at(*page.where(1.7, -0.1))
        assert page.js("document.querySelector('#pane-build [name=body]').value") == "right abutment"
        assert page.js("document.querySelector('#pane-build [name=edge]').value") == "", "it moves as a whole"
        value(page, "#pane-build [name=displacement]", "0.002, -0.001")
        page.click("#pane-build button.main")
        page.until(f"{SETTLED} && window.concio.view.shown.supports.length === 1")
        page.click("#tab-ask")
        page.click("[data-question=settle]")
        said = "[...document.querySelectorAll('#acts li')].map((e) => e.textContent)"
        page.until(f"{said}.some((l) => l.includes('moves by 2 mm along x, -1 mm along y'))")
        page.js("(() => { const i = document.querySelectorAll('#pane-ask input')[0]; i.value = '3'; "
                "i.dispatchEvent(new Event('change')); })()")  # fmt: skip
        page.until(f"{said}.some((l) => l.includes('moves by 6 mm along x, -3 mm along y'))")
        assert "kN" in page.js("document.querySelector('#acts').textContent")
        page.click("#run")
        page.until("!document.querySelector('#running').hidden")
        page.click("#cancel")
        page.until("document.querySelector('#running').hidden")
        assert page.js("document.querySelector('#verdict-text .sentence')") is None
        page.click("#run")
        page.until(ANSWERED)
        sentence = page.js("document.querySelector('#verdict-text .sentence').textContent")
        model = concio.loads(text_of(client))
        assert sentence == concio.settle(model, "settlement", amount=3.0).verdict.sentence
        lines = page.js("document.querySelector('#verdict-text details pre').textContent")
        assert "reactions    before the movement | at its end" in lines
        page.click("#tab-look")
        page.until("document.querySelector('#play')")
        page.click("#tab-python")
        assert "settle" in page.js("document.querySelector('#pane-python pre').textContent")
        assert page.js(AUDIT) == []


def test_what_a_question_needs_is_said_and_written_down_to_be_filled_in(page: Browser, client: Client) -> None:
    opened(page, client)
    page.until("document.querySelector('#run') && !document.querySelector('#run').disabled")
    page.click("[data-question=bridge]")
    assert "[vehicle]" in page.js("document.querySelector('#missing').textContent")
    assert page.js("document.querySelector('#run')") is None
    page.click("[data-question=assess]")
    assert "[site]" in page.js("document.querySelector('#missing').textContent")
    assert page.js(AUDIT) == []
    page.click("#missing button")
    page.until("/F0/.test(document.querySelector('#fault').textContent)", "the first value that nobody has stated")
    assert text_of(client).startswith(PILLAR)
    for path, text in (("hazard-SLV-a_g", "0.2"), ("hazard-SLV-F0", "2.45"), ("hazard-SLV-Tc", "0.32"),
                       ("nominal_life", "50"), ("soil", "B"), ("topography", "T1"), ("use_class", "II")):  # fmt: skip
        value(page, f"[id='value-site-{path}']", text)
        page.until("window.concio.idle()")
    value(page, "[id='value-assessment-knowledge']", "LC1")
    page.until(f"{SETTLED} && document.querySelector('#fault').textContent === ''")
    page.click("#tab-ask")
    page.until("document.querySelectorAll('#acts li').length")
    page.click("#run")
    page.until(ANSWERED)
    assert "zeta_E" in page.js("document.querySelector('#verdict-text').textContent")


def test_it_is_read_in_both_languages_in_light_and_dark(page: Browser, client: Client) -> None:
    opened(page, client)
    page.js("document.querySelector('#run').click()")
    page.until(ANSWERED)
    for scheme in ("light", "dark"):
        page.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        for _ in range(2):
            page.click("#language")
            for tab in ("ask", "build", "tables", "data", "text", "python", "report"):
                page.click(f"#tab-{tab}")
                page.until(f"document.querySelector('#pane-{tab}').children.length")
                assert page.js(AUDIT) == [], (scheme, tab)
    page.js("document.documentElement.lang === 'it' || document.querySelector('#language').click()")
    words = page.js("document.body.innerText")
    assert "Salva" in words
    assert page.js("document.documentElement.lang") == "it"
    page.click("#keys")
    assert page.js(AUDIT) == []
    page.press("Escape")
    page.click("#language")
    page.send("Emulation.setEmulatedMedia", features=[])


FOREIGN = """[...document.querySelectorAll('body *')].filter((e) => e.checkVisibility()
        && !e.closest('[lang=en], textarea, pre, code, iframe, option, datalist, #language')
        && [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()))
    .map((e) => [...e.childNodes].filter((n) => n.nodeType === 3).map((n) => n.textContent.trim()).join(' '))
    .concat([...document.querySelectorAll('[aria-label], [placeholder]')].filter((e) => e.checkVisibility())
        .map((e) => e.getAttribute('aria-label') || e.getAttribute('placeholder')))"""
ENGLISH = re.compile(
    r"\b(the|of|and|with|is|are|not|no|blocks?|joints?|loads?|weight|friction|thickness|rigid|fixed|from|to|under|"
    r"ask|look|build|tables|text|report|layers|run|add|remove|cancel|width|height|length|force|which|one|two)\b",
    re.I,
)
OWN = ("pillar.toml", "blocks_in_space.toml", "facade.toml", "dead", "live")
"""What is the user's own."""


def english(page: Browser) -> list[str]:
    """Return the texts of an Italian page that are English and do not say so."""
    found = page.js(FOREIGN)
    bodies = page.js("(window.concio.view.shown?.bodies || [])")
    names = {name for b in bodies for name in (b["name"], b["material"], b["layer"])}
    names |= set(page.js("Object.keys({ ...window.concio.view.shown?.laws, ...window.concio.view.shown?.materials })"))
    own = "|".join(map(re.escape, sorted((names | set(OWN)) - {""}, key=len, reverse=True)))
    return [text for text in found if ENGLISH.search(re.sub(own, "", text))]


@pytest.mark.parametrize("model", ["pillar", "facade", "blocks_in_space"])
def test_no_page_in_italian_holds_english_that_is_not_marked(page: Browser, tmp_path: Path, model: str) -> None:
    if model == "facade":
        for suffix in ("dxf", "toml"):
            shutil.copy(ROOT / "examples" / f"facade.{suffix}", tmp_path)
    elif model == "pillar":
        (tmp_path / "pillar.toml").write_text(PILLAR, encoding="utf-8")
    with window(tmp_path) as client:
        page.go(client.server.address)
        page.until("document.querySelector('#start').open")
        page.js("localStorage.setItem('language', 'it'); location.reload()")
        page.until("document.documentElement.lang === 'it' && document.querySelector('#start').open")
        assert english(page) == []
        page.js("localStorage.removeItem('language')")
        client.call("take")
        client.call(*(("new",) if model == "blocks_in_space" else ("open",)), name=f"{model}.toml", kind=model)
        client.call("bye")
        page.until(f"{DRAWN} && {SETTLED}")
        page.js("document.querySelector('#start').close()")
        for tool in ("load", "support", "tie", "select"):
            page.click(f"[data-tool={tool}]")
            assert english(page) == [], tool
        page.click("#tab-ask")
        page.click("#run")
        page.until("document.querySelector('#running').hidden && document.querySelector('#verdict-text .sentence')")
        for tab in page.js("[...document.querySelectorAll('#tabs button')].map((b) => b.id.slice(4))"):
            page.click(f"#tab-{tab}")
            page.until(f"document.querySelector('#pane-{tab}').children.length")
            assert english(page) == [], tab
        asked = "[data-question]:not([aria-disabled=true])"
        offered = f"[...document.querySelectorAll('{asked}')].map((b) => b.dataset.question)"
        page.js("document.querySelector('#tab-ask').click()")
        for question in page.js(offered):
            page.js("document.querySelector('#tab-ask').click()")
            page.click(f"[data-question={question}]")
            page.until("document.querySelectorAll('#acts li').length")
            assert english(page) == [], question
        page.click("#keys")
        assert english(page) == []


def on_face(page: Browser, x: float, y: float, z: float) -> tuple[float, float]:
    """Return the place on the page [px] of a point of a model in space."""
    code = f"""import('./space.js').then((s) => {{ const r = document.getElementById('picture').getBoundingClientRect();
        const p = s.project([{x}, {y}, {z}]); return [r.x + p[0], r.y + p[1]]; }})"""
    at = page.js(code)
    return at[0], at[1]


def test_a_model_in_space_is_loaded_and_held_on_faces_and_asked(page: Browser, tmp_path: Path) -> None:
    with window(tmp_path) as client:
        client.call("new", kind="blocks_in_space")
        client.call("bye")
        page.go(client.server.address)
        page.until(f"{DRAWN} && window.concio.view.shown.dim === 3")
        seen = """import('./space.js').then((s) => { const c = document.getElementById('space'), p = new Uint8Array(4);
            const [x, y] = s.project([0.2, 0, 0.6]), g = c.getContext('webgl');
            g.readPixels(Math.round(x), Math.round(c.height - y), 1, 1, g.RGBA, g.UNSIGNED_BYTE, p); return p[3]; })"""
        assert page.js(seen) == 255, "the pier is drawn where it is said to be"
        page.click("[data-tool=load]")
        page.js("(() => { const k = document.querySelector('#pane-build [name=kind]'); k.value = 'pressure'; "
                "k.dispatchEvent(new Event('change')); })()")  # fmt: skip
        page.click_at(*on_face(page, 0.1, 0.0, 0.5))
        assert page.js("document.querySelector('#pane-build [name=body]').value") == "left pier"
        value(page, "#pane-build [name=group]", "side")
        page.click("#pane-build button.main")
        page.until(f"{SETTLED} && window.concio.view.shown.loads.length === 4")
        page.click("[data-tool=support]")
        page.press("p")
        page.js("import('./picture.js').then((p) => p.select('bodies', [2]))")  # the right pier
        page.js("document.getElementById('picture').focus()")
        page.press("f")
        page.press("Enter")
        assert page.js("document.querySelector('#pane-build [name=body]').value") == "right pier"
        assert page.js("document.querySelector('#pane-build [name=edge]').value").count("1.2") == 4, "its upper face"
        page.click("#tab-tables")
        value(page, "#group-3", "wind")
        page.until(f"{SETTLED} && window.concio.view.shown.loads[3].group === 'wind'")
        model = concio.loads(text_of(client))
        face = {tuple(p) for p in model.loads[3].polygon or ()}
        assert face == {(0.0, 0.0, 0.0), (0.4, 0.0, 0.0), (0.4, 0.0, 1.2), (0.0, 0.0, 1.2)}
        page.press("ArrowRight", shift=True)
        page.click("[data-look=plan]")
        page.click("#tab-ask")
        page.click("#run")
        page.until(ANSWERED)
        page.click("#tab-report")
        page.until("document.querySelector('#pane-report iframe')")
        said = page.js("document.querySelector('#verdict-text .sentence').textContent")
        assert said == concio.solve(model).verdict.sentence
        assert page.js(AUDIT) == []


def test_the_keyboard_alone_loads_and_holds_faces_in_space(page: Browser, tmp_path: Path) -> None:
    with window(tmp_path) as client:
        page.go(client.server.address)
        page.until("document.querySelector('#start').open")
        tab_to(page, "e.textContent === 'blocks in space'")
        page.press("Enter")
        page.until(f"{DRAWN} && window.concio.view.shown && window.concio.view.shown.dim === 3")
        before = page.js("window.concio.view.shown.loads.length")
        page.press("l")
        page.press("p")
        chosen = "window.concio.view.shown.bodies[[...window.concio.view.selected.bodies][0]]"
        page.press("ArrowUp")
        while page.js(f"{chosen}.kind") == "fixed":
            page.press("ArrowUp")
        name = page.js(f"{chosen}.name")
        page.press("ArrowRight", shift=True)
        page.press("f")
        said = page.js("document.querySelector('#say').textContent")
        assert said.startswith(f"{name}: face "), said
        page.press("Enter")
        assert page.js("document.querySelector('#pane-build [name=body]').value") == name
        tab_to(page, "e.matches('#pane-build button.main')")
        page.press("Enter")
        page.until(f"{SETTLED} && window.concio.view.shown.loads.length === {before + 1}")
        page.press("Escape")
        tab_to(page, "e.dataset.look === 'plan'", back=True)
        page.press("Enter")
        tab_to(page, "e.id === 'cut-share'")
        page.press("ArrowLeft")
        page.press("3", alt=True)
        tab_to(page, "e.id === 'run' && !e.disabled")
        page.press("Enter")
        page.until(ANSWERED)
        said = page.js("document.querySelector('#verdict-text .sentence').textContent")
        assert said == concio.solve(concio.loads(text_of(client))).verdict.sentence
        page.press("6", alt=True)
        page.until("document.querySelector('#running').hidden && document.querySelector('#pane-report a')")
        tab_to(page, "e.matches('#pane-report button')")
        page.press("Enter")
        page.until("document.querySelector('#pane-report [role=status]')", "the project folder is written")
        assert any(p.name.endswith("-project") for p in tmp_path.iterdir())


def test_two_answers_stand_beside_each_other_and_a_mechanism_moves(page: Browser, client: Client) -> None:
    client.answer("run")
    limit = client.answer("limit", groups=["live"])
    client.call("bye")
    opened(page, client)
    page.click("#tab-look")
    page.until("document.querySelector('#play')")
    page.js("(() => { const s = document.querySelectorAll('#pane-look select')[1]; s.value = s.options[2].value; "
            "s.dispatchEvent(new Event('change')); })()")  # fmt: skip
    page.until("document.querySelectorAll('.small-picture svg').length === 2")
    sentences = page.js("[...document.querySelectorAll('#pane-look .sentence')].map((e) => e.textContent)")
    assert sentences[0] == limit["verdict"]["sentence"]
    assert "In equilibrium" in sentences[1]
    head = "document.querySelector('#picture .film').lastElementChild.getAttribute('d')"
    page.click("#play")
    before = page.js(head)
    page.until(f"{head} !== {json.dumps(before)}", "the mechanism moves in the main picture")
    page.click("#play")
    page.js("[...document.querySelectorAll('#pane-look input[type=checkbox]')][0].click()")
    assert page.js("document.querySelectorAll('#picture .ghosted .body').length") == 5
    page.click("#film-off")
    assert page.js("document.querySelector('#picture .film')") is None
    page.click("#tab-ask")
    page.click("#run")
    page.until(ANSWERED)
    page.click("#tab-tables")
    page.until("[...document.querySelectorAll('#pane-tables th')].some((e) => e.textContent === 'N [kN]')")
    joint = page.js("document.querySelector(\"[data-row='joints 0']\").textContent")
    result = concio.solve(concio.loads(text_of(client)))
    assert f"{result.joints.N[0]:.5g}"[:5] in joint
    assert page.js(AUDIT) == []
    page.click("#tab-look")
    page.until("document.querySelector('#forces')")
    page.click("#forces")
    drawn = page.js("document.querySelectorAll('#picture .film .force').length")
    assert drawn == len(force_chains(result).force) > 0
    outlines = "[...document.querySelectorAll('#picture {} .body')].map((e) => e.getAttribute('d'))"
    drawn, described = (page.js(outlines.format(group)) for group in (".film:not(.ghosted)", ".faint"))
    assert len(drawn) == 5
    for moved, rest in zip(drawn, described, strict=True):
        assert box_of(moved) == pytest.approx(box_of(rest), abs=1e-6)
    assert page.js(AUDIT) == []


def box_of(path: str) -> list[float]:
    """Return smallest and largest x and y of an outline of the picture."""
    found = [float(word) for word in re.findall(r"-?[0-9.]+(?:e-?[0-9]+)?", path)]
    return [min(found[::2]), min(found[1::2]), max(found[::2]), max(found[1::2])]


EXAMPLES = (
    ("path", ROOT / "examples" / "spreading_arch.toml"), ("settle", ROOT / "examples" / "spreading_arch.toml"),
    ("shake", TEMPLATES / "motion.toml"),
    ("assess", TEMPLATES / "assessment.toml"), ("bridge", TEMPLATES / "bridge.toml"),
    ("diagnose", ROOT / "examples" / "cracked_arch.toml"), ("study", ROOT / "examples" / "study_of_an_arch.toml"),
    ("push", TEMPLATES / "column.toml"),
)  # fmt: skip


def test_every_question_is_asked_from_the_page_in_italian(page: Browser, tmp_path: Path) -> None:
    for _, file in EXAMPLES:
        if not (tmp_path / file.name).exists():
            shutil.copy(file, tmp_path / file.name)
    with window(tmp_path) as client:
        for question, file in EXAMPLES:
            page.go("about:blank")
            client.call("take")
            assert client.call("open", name=file.name)["document"]["name"] == file.name
            client.call("bye")
            page.go(client.server.address)
            page.until(f"{DRAWN} && {SETTLED}")
            page.js("document.documentElement.lang === 'it' || document.querySelector('#language').click()")
            page.click(f"[data-question={question}]")
            page.until("document.querySelectorAll('#acts li').length > 1")
            assert "kN" in page.js("document.querySelector('#acts').textContent")
            page.click("#run")
            asked = f"window.concio.state().asked?.question === '{question}'"
            page.until(f"document.querySelector('#running').hidden && {asked} && {SAID}")
            said = page.js("document.querySelector('#verdict-text').innerHTML")
            if question != "study":
                assert 'lang="it"' in page.js("document.querySelector('#verdict-text .headline').innerHTML"), question
                assert 'lang="it"' in page.js("document.querySelector('#verdict-text .sentence').innerHTML"), question
            assert "Error:" not in said, question
            page.click("#tab-report")
            page.until("document.querySelector('#pane-report iframe, #pane-report img')")
        page.click("#language")


def test_a_picture_becomes_blocks_that_are_corrected_and_asked(page: Browser, tmp_path: Path) -> None:
    wall = concio.wall(block_size=(0.25, 0.125), length=1.0, height=0.5, block="rigid")
    imsave(tmp_path / "wall.png", rendered(wall, contrast=0.2, seed=1).grey, cmap="gray", vmin=0.0, vmax=1.0)
    with window(tmp_path) as client:
        page.go(client.server.address)
        page.until("document.querySelector('#start').open")
        page.js("[...document.querySelectorAll('#start button')].find((b) => b.textContent === 'wall.png').click()")
        flat = "document.querySelector('[data-photo=flat]') && document.querySelector('#picture image')"
        page.until(flat)
        page.go("about:blank")
        page.go(client.server.address)
        page.until(flat, "a picture without blocks opens with its own tab")

        def corner(x: float, y: float) -> None:
            at = page.js("(() => { const r = document.querySelector('#picture image').getBoundingClientRect(); "
                         f"return [r.x + {x} * r.width, r.y + {y} * r.height]; }})()")  # fmt: skip
            page.click_at(*at)

        value(page, "[name=photo-size]", "1, 0.5")
        page.click("[data-photo=flat]")
        for x, y in ((0, 1), (1, 1), (1, 0), (0, 0)):
            corner(x, y)
        page.until("document.querySelector('#trace')", "the picture is flat and has its scale")
        assert page.js(AUDIT) == []
        page.click("#trace")
        page.until("document.querySelectorAll('#picture .traced').length === 18")
        assert "18 stones" in page.js("document.querySelector('#pane-photo [role=status]').textContent")
        page.click("#take-stones")
        page.until(f"{SETTLED} && window.concio.view.shown.bodies.length === 19")
        page.click_at(*page.where(0.25, 0.44))
        page.mouse("mousePressed", *page.where(0.5, 0.44), modifiers=8)
        page.mouse("mouseReleased", *page.where(0.5, 0.44), modifiers=8)
        page.click("#merge")
        page.until(f"{SETTLED} && window.concio.view.shown.bodies.length === 18")
        page.click_at(*page.where(0.25, 0.44))
        page.click("[data-photo=cut]")
        page.click_at(*page.where(0.375, 0.55))
        page.click_at(*page.where(0.375, 0.31))
        page.until(f"{SETTLED} && window.concio.view.shown.bodies.length === 19")
        page.click("#tab-ask")
        page.click("#run")
        page.until(ANSWERED)
        said = page.js("document.querySelector('#verdict-text .sentence').textContent")
        assert said == concio.solve(concio.loads(text_of(client), folder=tmp_path)).verdict.sentence
        assert "In equilibrium" in said


def test_a_picture_without_stones_is_no_fault_and_a_fault_beside_it_is_told(page: Browser, tmp_path: Path) -> None:
    shutil.copy(ROOT / "examples" / "bricks.png", tmp_path)
    with window(tmp_path) as client:
        client.call("open", name="bricks.png")
        client.call("bye")
        page.go(client.server.address)
        page.until("document.querySelector('[data-photo=flat]') && document.querySelector('#picture image')")
        page.until("document.querySelector('#untraced')")
        assert page.js("document.querySelector('#fault').textContent") == ""
        assert page.js(AUDIT) == []
        page.click("#tab-ask")
        page.until("/no stones yet/.test(document.querySelector('#acts').textContent)")
        assert page.js("document.querySelector('#run').disabled")
        for right, wrong, said in (
            ("thickness = 1.0", "thickness = ", "line 8"),
            ("friction = 0.6", "frictio = 0.6", "frictio"),
        ):
            page.click("#tab-text")
            value(page, "#pane-text textarea", text_of(client).replace(right, wrong))
            page.click("#pane-text button.main")
            page.until(f"/{said}/.test(document.querySelector('#fault').textContent)")
            assert page.js("document.querySelector('#fault').textContent").startswith("The model cannot be read")
            assert page.js("document.querySelector('#picture image') !== null") or wrong == "thickness = "
            page.js("document.querySelector('#undo').click()")
            page.until("!document.querySelector('#fault').textContent && document.querySelector('#untraced')")
        page.js("document.documentElement.lang === 'it' || document.querySelector('#language').click()")
        assert english(page) == []
        page.click("#language")


def test_the_way_along_the_joints_is_seen_while_the_pointer_moves(page: Browser, tmp_path: Path) -> None:
    wall = concio.wall(block_size=(0.25, 0.125), length=1.0, height=0.5, block="rigid")
    imsave(tmp_path / "wall.png", rendered(wall, contrast=0.2, seed=2).grey, cmap="gray", vmin=0.0, vmax=1.0)
    with window(tmp_path) as client:
        client.call("open", name="wall.png")
        client.do({"do": "set", "path": ["record", "picture", "points"], "value": [[0, 10], [300, 10]]},
                  {"do": "set", "path": ["record", "picture", "distance"], "value": 1.0})  # fmt: skip
        client.call("bye")
        page.go(client.server.address)
        page.until("document.querySelector('[data-photo=outline]') && document.querySelector('#picture image')")
        page.until("document.querySelector('#busy').hidden")
        page.click("[data-photo=outline]")
        corners = [(0.252, 0.128), (0.497, 0.121), (0.503, 0.253), (0.247, 0.246)]
        page.click_at(*page.where(*corners[0]))
        for x in (0.3, 0.4, 0.497):
            page.mouse("mouseMoved", *page.where(x, 0.121))
        page.until("document.querySelector('#picture .wire:not(.old)')", "the way to where the pointer stands")
        drawn = page.js("document.querySelector('#picture .wire').getAttribute('points')")
        way = [tuple(map(float, p.split(","))) for p in drawn.split()]
        assert max(abs(-y - 0.125) for x, y in way if 0.27 < x < 0.48) < 0.007
        for at in corners[1:]:
            page.click_at(*page.where(*at))
        page.until("document.querySelectorAll('#picture .wire:not(.old)').length >= 3", "the ways between clicks stay")
        page.click_at(*page.where(*corners[0]))
        page.until("document.querySelectorAll('#picture .traced').length === 1")
        assert page.js("document.querySelector('#picture .wire')") is None
        page.click("#take-stones")
        page.until(f"{SETTLED} && window.concio.view.shown.bodies.length === 2")
        stone = next(b for b in concio.loads(text_of(client), folder=tmp_path).bodies if b.kind != "fixed")
        assert stone.volume == pytest.approx(0.25 * 0.125, rel=0.15)


def ply_of(body: concio.Polyhedron) -> str:
    """Return a body as PLY."""
    head = ["ply", "format ascii 1.0", f"element vertex {len(body.vertices)}",
            *(f"property double {axis}" for axis in "xyz"), f"element face {len(body.faces)}",
            "property list uchar int vertex_indices", "end_header"]  # fmt: skip
    points = [" ".join(repr(float(v)) for v in p) for p in body.vertices]
    return "\n".join([*head, *points, *(" ".join(map(str, (len(f), *f))) for f in body.faces)]) + "\n"


def ifc_of(bodies: Sequence[concio.Polyhedron]) -> str:
    """Return bodies as IFC."""
    made = IfcText()
    for body in bodies:
        made.product(body.name, made.brep(body.vertices, body.faces))
    return made.text()


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "ifc", "3dm"])
def test_solids_are_dropped_and_asked(page: Browser, tmp_path: Path, suffix: str) -> None:
    tower = concio.drums(height=1.0, drums=2, diameter=0.5, block="rigid")
    tower = dataclasses.replace(tower, bodies=tower.free_bodies)  # the window adds the ground
    file = tmp_path / f"piece.{suffix}"
    if suffix in ("ply", "ifc"):
        bodies = [body for body in tower.bodies if isinstance(body, concio.Polyhedron)]
        file.write_text(ply_of(bodies[0]) if suffix == "ply" else ifc_of(bodies), encoding="utf-8")
    else:
        concio.write_solids(file, tower)
    content = base64.b64encode(file.read_bytes()).decode()
    file.unlink()
    with window(tmp_path) as client:
        page.go(client.server.address)
        page.until("document.querySelector('#start').open")
        page.js(f"""(() => {{ const bytes = Uint8Array.from(atob('{content}'), (c) => c.charCodeAt(0));
            const given = new DataTransfer(); given.items.add(new File([bytes], 'piece.{suffix}'));
            dispatchEvent(new DragEvent('drop', {{ dataTransfer: given, cancelable: true }})); }})()""")
        page.until(f"{DRAWN} && window.concio.view.shown && window.concio.view.shown.dim === 3", "the solids")
        assert (tmp_path / f"piece.{suffix}").is_file()
        page.until("document.querySelector('#acts li')", "what acts")
        assert page.js("window.concio.view.shown.bodies.length") == (2 if suffix == "ply" else 3)
        page.click("#run")
        page.until(ANSWERED)
        said = page.js("document.querySelector('#verdict-text .sentence').textContent")
        assert said == concio.solve(concio.loads(text_of(client), folder=tmp_path)).verdict.sentence


def test_after_random_hands_text_picture_and_program_describe_one_model(page: Browser, client: Client) -> None:
    """Clicks, drags, keys and texts in an order that nobody has thought of."""
    opened(page, client)
    rng = random.Random(7)
    for k in range(30):
        kind = rng.choice(["load", "drag", "undo", "undo", "redo", "data", "text", "tie", "remove"])
        loads = page.js("window.concio.view.shown.loads.length")
        if kind == "load":
            page.press("Escape")
            page.press("l")
            page.click_at(*page.where(rng.uniform(-0.2, 0.2), rng.uniform(0.2, 1.8)))
            page.click("#pane-build button.main")
        elif kind == "tie":
            page.press("Escape")
            page.press("t")
            for y in (0.3, 1.6):
                page.click_at(*page.where(rng.uniform(-0.2, 0.2), y))
            page.click("#pane-build button.main")
        elif kind == "drag" and page.js("window.concio.view.shown.loads[0]?.table === 0"):
            page.click("[data-tool=select]")
            x, y = page.js("window.concio.view.shown.loads[0].at")
            page.mouse("mousePressed", *page.where(x, y))
            for s in (0.3, 1.0):
                page.mouse("mouseMoved", *page.where(-0.26 - 0.02 * s, y + s * (rng.uniform(0.3, 1.7) - y)))
            page.mouse("mouseReleased", *page.where(-0.28, rng.uniform(0.3, 1.7)))
        elif kind in ("undo", "redo"):
            page.js("document.activeElement.blur()")
            page.press("z" if kind == "undo" else "y", ctrl=True)
        elif kind == "data":
            page.click("#tab-data")
            value(page, "[id='value-column-width']", rng.choice(["0.5", "55 cm", "0.6"]))
        elif kind == "text":
            page.click("#tab-text")
            value(page, "#pane-text textarea", text_of(client) + f"# {k}\n")
            page.click("#pane-text button.main")
        elif kind == "remove" and loads > 1:
            page.click("#tab-tables")
            page.js(f"document.querySelector(\"[data-row='things load {loads - 1}'] button\")?.click()")
        page.until("window.concio.idle()")
        page.until(SETTLED)
        text = text_of(client)
        assert page.js("window.concio.state().document.text") == text, kind
        model = concio.loads(text)
        assert page.js("window.concio.view.shown.bodies.map((b) => b.name)") == [b.name for b in model.bodies], kind
        places = [one.at and list(one.at) for one in model.loads]
        assert page.js("window.concio.view.shown.loads.map((l) => l.at)") == places, kind
        assert page.js("window.concio.view.shown.ties.map((l) => l.name)") == [one.name for one in model.ties], kind
    page.click("#tab-python")
    page.until("document.querySelector('#pane-python [role=note]')", "the program reads the file, which is older")
    page.press("s", ctrl=True)
    page.until("!document.querySelector('#pane-python [role=note]')")
    program = page.js("document.querySelector('#pane-python pre').textContent")
    code = f"{program}\nprint([one.at for one in model.loads])\n"
    folder = client.server.session.folder
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == str([one.at for one in concio.loads(text_of(client)).loads])


def test_a_question_is_cancelled_and_the_newest_wins(page: Browser, client: Client) -> None:
    opened(page, client)
    wall = (TEMPLATES / "wall.toml").read_text(encoding="utf-8").replace("[0.50, 0.25]", "[0.25, 0.125]")
    client.page = page.js("sessionStorage.getItem('page')")
    client.do({"do": "text", "text": wall})
    page.until(f"{SETTLED} && window.concio.view.shown.bodies.length > 200")
    page.click("[data-question=limit]")
    page.click("#run")
    page.until("!document.querySelector('#running').hidden")
    page.click("#cancel")
    page.until("document.querySelector('#running').hidden")
    page.click("[data-question=run]")
    page.click("#run")
    page.until(ANSWERED)
    model = concio.loads(wall)
    said = page.js("document.querySelector('#verdict-text .sentence').textContent")
    assert said == concio.solve(model).verdict.sentence


def test_pure_functions_of_the_page(page: Browser, client: Client) -> None:
    opened(page, client)
    run = "import('./geometry.js').then((g) => {body})"
    square = "[[[0, 0], [2, 0], [2, 1], [0, 1]]]"
    assert page.js(run.format(body=f"[g.inside([1, 0.5], {square}), g.inside([3, 0.5], {square})]".join("()"))) == [
        True,
        False,
    ]
    assert page.js(run.format(body=f"g.nearestEdge([1, -1], {square}).at")) == [1, 0]
    joints = "[[[0, 0], [2, 0]]]"
    assert page.js(run.format(body=f"g.nearestEdge([1.9, 0.02], {square}, {joints}, 0.2).at")) == [2, 0.02]
    assert page.js(run.format(body="g.numbers('1, -2.5', 2)")) == [1, -2.5]
    assert page.js(run.format(body="g.numbers('1, x', 2)")) is None
    heights = [(0, 1), (0, 1), (1, 2), (0, 2), (0.4, 1.4), (0.6, 1.6)]
    bodies = json.dumps([{"kind": "rigid", "rings": [[[0, a], [1, a], [1, b], [0, b]]]} for a, b in heights])
    assert page.js(run.format(body=f"g.courseOf({bodies}, 0)")) == [0, 1, 3, 4], "half of both heights"
    solids = json.dumps([{"kind": kind, "vertices": [[0, 0, 0], [0, 0, 1]]} for kind in ("rigid", "fixed", "elastic")])
    assert page.js(run.format(body=f"g.courseOf({solids}, 0)")) == [0, 2], "upwards is z in space, ground is no course"


if __name__ == "__main__":
    os.chdir(ROOT)
    sys.exit(pytest.main([__file__, *sys.argv[1:]]))
