"""The HTML report: its numbers are the result's numbers, it fetches nothing, and it works in a browser."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import concio
from concio.analysis.result import Result
from concio.errors import InputError
from concio.problem.solution import Status
from concio.report.page import report_html, write_report
from concio.report.view_data import unpack
from concio.verdict.step_verdict import checks
from concio.verdict.step_verdict import proof as certificate_sentence
from concio.verdict.step_verdict import step_verdict as verdict
from concio.verdict.step_words import OUTCOMES
from concio.verdict.step_words import WORDS as VERDICTS
from models import bearing_panel, sliding_panel

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


@pytest.fixture(scope="module")
def arched() -> Result:
    return concio.solve(bearing_panel())


@pytest.fixture(scope="module")
def sliding() -> Result:
    return concio.solve(sliding_panel(), on_failure="return")


def embedded(page: str) -> dict:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found
    return json.loads(found.group(1))


def test_embedded_numbers_are_those_of_the_result(arched: Result) -> None:
    data = embedded(report_html(arched, figures=False))
    step = data["steps"][0]
    pair = unpack(data["pieces"]["pair"])
    contacts, joints = arched.contacts, arched.joints
    assert data["bodies"]["name"] == [b.name for b in arched.model.bodies]
    for name, values in (
        ("t_n", contacts.normal_force[pair]),
        ("t_t", contacts.friction_force[pair, 0]),
        ("gap", contacts.gap[pair]),
        ("slip", contacts.slip[pair, 0]),
        ("pressure", contacts.pressure[pair]),
        ("N", joints.N),
        ("V", joints.V),
        ("eccentricity", joints.eccentricity),
        ("s1", arched.stress.principal[0]),
        ("s2", arched.stress.principal[1]),
    ):
        np.testing.assert_array_equal(unpack(step[name]), values)
    np.testing.assert_array_equal(unpack(step["state"]), contacts.state[pair])
    assert sorted(pair) == list(range(len(contacts)))  # every pair is there once


def test_embedded_shape_is_the_deformed_shape(arched: Result) -> None:
    data = embedded(report_html(arched, figures=False))
    start, move = unpack(data["bodies"]["start"]), unpack(data["steps"][0]["move"]).reshape(-1, 2)
    for b in range(len(arched.model.bodies)):
        shown = move[start[b] : start[b + 1]]
        nodes = arched.node_displacement(b)
        # the first point of an outline is the body's first vertex, where a node stands
        vertex = np.argmin(np.linalg.norm(arched.nodes(b) - arched.model.bodies[b].outline[0], axis=1))
        np.testing.assert_allclose(shown[0], nodes[vertex], rtol=1e-6, atol=1e-12)


class _Links(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found += [v or "" for k, v in attrs if k in ("src", "href", "srcset", "data", "action")]


@pytest.mark.long
def test_report_fetches_nothing(arched: Result) -> None:
    page = report_html(arched)
    links = _Links()
    links.feed(page)
    assert links.found
    assert all(link.startswith("data:") for link in links.found)
    assert "@import" not in page
    assert "url(" not in page
    assert "fetch(" not in page


def test_tables_show_the_numbers(arched: Result) -> None:
    page = report_html(arched, figures=False)
    for x, y in arched.reactions.values():
        assert f'title="{x!r}"' in page
        assert f'title="{y!r}"' in page
    strongest = int(np.argmax(np.hypot(arched.joints.N, arched.joints.V)))
    assert f'title="{float(arched.joints.N[strongest])!r}"' in page


@pytest.mark.parametrize("status", list(Status))
def test_every_outcome_has_words(status: Status) -> None:
    words = VERDICTS[status]
    assert words.headline.endswith(".")
    assert words.next_steps
    bad = (Status.NO_EQUILIBRIUM, Status.COLLAPSES, Status.NO_COULOMB_STATE)
    assert OUTCOMES[status].tone == ("good" if status is Status.SOLVED else "bad" if status in bad else "unsure")


@pytest.mark.parametrize("status", [Status.UNDECIDED, Status.GAVE_UP, Status.CANCELLED])
def test_no_answer_shows_no_numbers(arched: Result, status: Status) -> None:
    unsure = Result(arched.assembly, {}, replace(arched.solution, status=status), arched.seconds)
    page = report_html(unsure)
    assert VERDICTS[status].headline in page
    assert "Not certified" in page
    assert "<h2>Reactions</h2>" not in page
    assert "fig-deformed" not in page
    step = embedded(page)["steps"][0]
    assert "s1" not in step
    assert not unpack(step["move"]).any()
    assert "Not certified" in unsure._repr_html_()


def test_collapse_shows_its_mechanism(sliding: Result) -> None:
    assert sliding.status is Status.NO_EQUILIBRIUM
    page = report_html(sliding)
    assert "The loads cannot be carried." in page
    assert "fig-mechanism" in page
    assert "fig-principal" not in page
    data = embedded(page)
    assert data["mechanism"]
    assert unpack(data["steps"][0]["move"]).any()
    assert f"{sliding.mechanism.power:.4g}" in certificate_sentence(sliding)


def test_checks_are_the_certificate(arched: Result) -> None:
    c = arched.certificate
    assert [k.value for k in checks(arched)] == [
        c.equilibrium, c.penetration, c.cone, c.slip_direction, c.complementarity,
    ]  # fmt: skip
    assert all(k.holds for k in checks(arched))


def test_title_is_escaped(arched: Result) -> None:
    model = replace(arched.model, title="</script><script>alert(1)</script>")
    assembly = replace(arched.assembly, model=model)
    page = report_html(Result(assembly, {}, arched.solution, arched.seconds), figures=False)
    assert "<script>alert" not in page


def test_name_cannot_end_the_data(arched: Result) -> None:
    body = replace(arched.model.bodies[0], name="</script>evil")
    model = replace(arched.model, bodies=(body, *arched.model.bodies[1:]))
    assembly = replace(arched.assembly, model=model)
    page = report_html(Result(assembly, {}, arched.solution, arched.seconds), figures=False)
    assert "</script>evil" not in page
    assert embedded(page)["bodies"]["name"][0] == "</script>evil"


def test_steps_of_different_models_are_refused(arched: Result, sliding: Result) -> None:
    with pytest.raises(InputError, match="different models"):
        report_html([arched, sliding])
    with pytest.raises(InputError, match="no result"):
        report_html([])


def test_notebook_shows_the_verdict(arched: Result, sliding: Result) -> None:
    assert "The loads are carried." in arched._repr_html_()
    assert "data:image" in arched._repr_html_()
    assert "The loads cannot be carried." in sliding._repr_html_()


ACT = """
<script>
const report = {};
const fire = (id, value, kind) => {
  const box = document.getElementById(id);
  if (box.type === "checkbox") box.checked = value; else box.value = value;
  box.dispatchEvent(new Event(kind, { bubbles: true }));
};
const picture = () => { concio.paint(); return document.getElementById("canvas").toDataURL(); };
const press = (x, y) => {
  const canvas = document.getElementById("canvas"), box = canvas.getBoundingClientRect();
  const at = { clientX: box.left + canvas.clientLeft + x, clientY: box.top + canvas.clientTop + y };
  for (const kind of ["pointerdown", "pointerup"]) {
    canvas.dispatchEvent(new PointerEvent(kind, { ...at, pointerId: 1, bubbles: true }));
  }
};
const numbers = () => Object.fromEntries(
  [...document.querySelectorAll("#info dd")].map((d) => [d.dataset.name, Number(d.dataset.value)]));
const words = () => document.getElementById("info").textContent;
try {
  const begin = performance.now();
  const pictures = [picture()];
  report.paintMilliseconds = performance.now() - begin;
  report.step = concio.view.step;
  fire("scale", "0", "input"); report.scaleAtZero = concio.view.scale; pictures.push(picture());
  fire("scale", "200", "input"); report.scaleAtFull = concio.view.scale; pictures.push(picture());
  fire("scale", "0", "input");
  for (const colour of ["s1", "s2", "move", "pressure"]) { fire("colour", colour, "change"); pictures.push(picture()); }
  report.legend = document.getElementById("legend").textContent;
  fire("colour", "none", "change");
  fire("states", false, "change"); pictures.push(picture());
  fire("crosses", false, "change"); pictures.push(picture());
  document.getElementById("zoom-in").click(); pictures.push(picture());
  document.getElementById("fit").click();
  report.different = new Set(pictures).size; report.pictures = pictures.length;
  const c = concio.bodies.centre, body = BODY;
  press(concio.X(c[2 * body]), concio.Y(c[2 * body + 1]));
  report.body = numbers(); report.bodyWords = words();
  const piece = PIECE, p = concio.middle(piece, 0), q = concio.middle(piece, 1);
  press((p[0] + q[0]) / 2, (p[1] + q[1]) / 2);
  report.joint = numbers(); report.jointWords = words();
  if (concio.data.steps.length > 1) {
    const last = picture(); fire("step", "0", "input"); report.first = document.getElementById("step-text").textContent;
    report.stepChanges = picture() !== last;
  }
  const own = concio.bodies.name[body];
  const found = [...document.querySelectorAll("button.found")].filter((b) => b.textContent === own);
  document.getElementById("fit").click(); concio.choose(null); report.before = words();
  found[0].click(); report.byName = words(); report.marked = found.every((b) => b.classList.contains("picked"));
  report.others = [...document.querySelectorAll("button.found.picked")].every((b) => b.textContent === own);
  concio.choose(null); report.none = document.querySelectorAll("button.found.picked").length;
  press(concio.X(c[2 * body]), concio.Y(c[2 * body + 1]));
  report.reverse = found.every((b) => b.classList.contains("picked"));
  report.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
} catch (error) { report.failure = String(error.stack || error); }
report.errors = document.getElementById("errors").textContent;
const out = document.createElement("pre"); out.id = "outcome"; out.textContent = JSON.stringify(report);
document.body.append(out);
</script>
</body>"""


def browse(page: Path, profile: Path, size: str = "1200,900") -> str:
    flags = (
        "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
        "--disable-background-networking", "--disable-component-update", "--disable-sync",
    )  # fmt: skip
    done = subprocess.run(
        [CHROMIUM, *flags, f"--user-data-dir={profile}", f"--window-size={size}", "--dump-dom", page.as_uri()],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    return done.stdout


@pytest.mark.long
@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
@pytest.mark.parametrize("size", ["1200,900", "500,900"])
def test_report_works_in_a_browser(arched: Result, tmp_path: Path, size: str) -> None:
    half = concio.solve(arched.assembly, factors={"top": 0.5})
    page = report_html([half, arched], labels=["half", "full"])
    body = next(i for i, b in enumerate(arched.model.bodies) if b.role == "block")
    data = embedded(page)
    pair = unpack(data["pieces"]["pair"])
    # the piece with the largest force whose middle no other joint crosses: inside an interface
    force = arched.contacts.normal_force[pair]
    inner = arched.assembly.pairs.length[pair] >= np.median(arched.assembly.pairs.length[pair])
    piece = int(np.argmax(np.where(inner, force, -1.0)))
    acting = ACT.replace("BODY", str(body)).replace("PIECE", str(piece))
    file = tmp_path / "report.html"
    file.write_text(page.replace("</body>", acting), encoding="utf-8")
    dom = browse(file, tmp_path / "profile", size)
    found = re.search(r'<pre id="outcome">(.*?)</pre>', dom, re.DOTALL)
    assert found, dom[-2000:]
    report = json.loads(found.group(1).replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    assert "failure" not in report, report["failure"]
    assert report["errors"] == ""
    assert report["step"] == 1
    assert report["scaleAtZero"] == 0
    assert report["scaleAtFull"] == pytest.approx(4 * data["scale"])
    assert report["different"] == report["pictures"]
    assert "contact pressure" in report["legend"]
    assert report["overflow"] <= 0
    s1, s2, _ = arched.stress.principal
    assert arched.model.bodies[body].name in report["bodyWords"]
    assert report["body"]["largest stress"] == s1[body]
    assert report["body"]["smallest stress"] == s2[body]
    k = pair[piece]
    joint = arched.assembly.pairs.interface[k]
    assert "joint" in report["jointWords"]
    assert report["joint"]["normal force N"] == arched.joints.N[joint]
    assert report["joint"]["force here"] == arched.contacts.normal_force[k]
    assert report["first"] == "half"
    assert arched.model.bodies[body].name not in report["before"]
    assert arched.model.bodies[body].name in report["byName"]
    assert report["marked"]
    assert report["others"]
    assert report["none"] == 0
    assert report["reverse"]
    assert report["stepChanges"]


FIND = """<script>
const found = [...document.querySelectorAll("button.found")], out = document.createElement("pre"); out.id = "outcome";
found[found.length - 1].click();
out.textContent = JSON.stringify([found[found.length - 1].textContent, document.getElementById("info").textContent,
  [...new Set([...document.querySelectorAll("button.found.picked")].map((b) => b.textContent))]]);
document.body.append(out);
</script></body>"""


@pytest.mark.long
@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
def test_a_name_in_a_table_finds_its_block_in_space(tmp_path: Path) -> None:
    stones = concio.load(Path(str(files("concio.model") / "templates" / "drums.toml")))
    file = tmp_path / "report.html"
    page = report_html(concio.solve(stones), figures=False)
    file.write_text(page.replace("</body>", FIND), encoding="utf-8")
    found = re.search(r'<pre id="outcome">(.*?)</pre>', browse(file, tmp_path / "profile"), re.DOTALL)
    assert found
    name, words, marked = json.loads(found[1])
    assert name in {b.name for b in stones.bodies}
    assert words.startswith(name)
    assert marked == [name]


@pytest.mark.long  # starts a browser; make journeys does, too
@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
def test_collapse_opens_without_errors(sliding: Result, tmp_path: Path) -> None:
    file = write_report(sliding, tmp_path / "report.html", figures=False)
    dom = browse(file, tmp_path / "profile")
    assert re.search(r'<pre id="errors" hidden(="")?></pre>', dom)
    assert "slides" in dom


def test_joints_that_were_nearly_made_come_first_of_what_to_do_next() -> None:
    text = "[column]\nwidth=1\nheight=1\nblocks=1\n[[blocks]]\nname='floating'\nrectangle=[[-0.5,1.001],[0.5,2]]\n"
    fallen = concio.solve(concio.loads(text), on_failure="return")
    assert verdict(fallen).next_steps[0].startswith("1 joint almost made, but not made")
    assert "1 joint almost made, but not made" in report_html(fallen)
    touching = concio.solve(concio.loads(text.replace("1.001", "1.0")), on_failure="return")
    assert not any("almost made" in line for line in (*verdict(touching).limits, *verdict(touching).attention))
    assert verdict(touching).headline == VERDICTS[touching.status].headline
