"""From the drawing of a facade to a report, as an engineer would do it: clicks, texts, keys and seconds counted.

    python benchmarks/window_trial.py [PICTURES] [--language it] [--dark] [--width 390]

Real mouse and keyboard events in Chromium, from the empty window in the folder of the drawing to the report and the
project folder. A picture of each step is written into the folder PICTURES. Seconds are those the machine needs. The
minutes of a person add to them the keystroke-level model of Card, Moran and Newell (Communications of the ACM 23, 1980,
396-410): 1.1 s to point, 0.28 s for a key or a button, 0.4 s from the mouse to the keys or back, and 1.35 s to think
before each; that is a person who knows the way, without the time to read. ``--write`` puts the counts into the page of
the window in the documentation.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from browser import Browser, browser  # noqa: E402
from windows import window  # noqa: E402

PAGE = ROOT / "docs" / "howto" / "window.md"
BEGIN, END = "<!-- counts: written by benchmarks/window_trial.py -->", "<!-- end of counts -->"
SETTLED = "window.concio.pictured().startsWith(window.concio.state().document.hash)"
POINT, KEY, HAND, THINK = 1.1, 0.28, 0.4, 1.35
"""Seconds of the keystroke-level model."""
MEANT = "window.concio.state().document.text"


class Hand:
    """Does what a person does, and counts it."""

    def __init__(self, page: Browser, pictures: Path | None) -> None:
        self.page, self.pictures = page, pictures
        self.clicks = self.texts = self.keys = 0
        self.seconds = 0.0
        self.begun = self.last = time.perf_counter()
        self.steps: list[tuple[str, int, int, int, float]] = []
        self._before = (0, 0, 0)

    def click(self, selector: str) -> None:
        """Click what a selector finds, scrolled into view as a person would scroll."""
        self.page.click(selector)
        self._clicked()

    def _clicked(self, count: int = 1) -> None:
        self.clicks += count
        self.seconds += count * (THINK + POINT + KEY)

    def click_text(self, within: str, text: str) -> None:
        """Click the button with a text."""
        code = f"[...document.querySelectorAll({json.dumps(within + ' button')})]"
        code += f".find((b) => b.textContent.trim() === {json.dumps(text)})"
        self.page.until(f"{code} && !{code}.disabled", f"the button {text}")
        self.page.js(f"{code}.setAttribute('data-hand', '')")
        self.click("[data-hand]")
        self.page.js("document.querySelector('[data-hand]')?.removeAttribute('data-hand')")

    def write(self, selector: str, text: str) -> None:
        """Click into a field, write over what is there, leave it by Tab."""
        self.click(selector)
        self.page.press("a", ctrl=True)
        self.page.type(text)
        self.page.press("Tab")
        self.texts += 1
        self.seconds += THINK + 2 * HAND + (len(text) + 3) * KEY

    def choose(self, selector: str, value: str) -> None:
        """Choose from a list: a click, and the first letters or arrows on the keyboard count as one key."""
        name = json.dumps(selector)
        self.page.js(f"document.querySelector({name}).focus()")
        self.page.js(f"(() => {{ const e = document.querySelector({name}); e.value = {json.dumps(value)};"
                     " e.dispatchEvent(new Event('input', {bubbles: true}));"
                     " e.dispatchEvent(new Event('change', {bubbles: true})); })()")  # fmt: skip
        self._clicked(2)

    def click_model(self, x: float, y: float) -> None:
        """Click a point of the model [m]."""
        self.page.js("document.getElementById('picture').scrollIntoView({block: 'nearest'})")
        self.page.click_at(*self.page.where(x, y))
        self._clicked()

    def until(self, code: str, why: str = "") -> None:
        """Wait."""
        self.page.until(code, why)

    def step(self, name: str) -> None:
        """End a step: note what it took, and take a picture."""
        now = time.perf_counter()
        was = self._before
        self._before = (self.clicks, self.texts, self.keys)
        self.steps.append((name, self.clicks - was[0], self.texts - was[1], self.keys - was[2], now - self.last))
        self.last = now
        if self.pictures is not None:
            self.pictures.mkdir(parents=True, exist_ok=True)
            self.page.picture(self.pictures / f"{len(self.steps):02d} {name}.png")


def trial(hand: Hand, words: dict[str, list[str]], italian: bool) -> None:
    """Go from the drawing to the report."""

    def word(key: str) -> str:
        return words[key][1 if italian else 0]

    hand.until("document.querySelector('#start').open")
    hand.step("start")
    hand.click_text("#start", "facade.dxf")
    hand.until("document.querySelector('#pane-layers table')")
    hand.step("drawing opened")
    hand.click_text("#pane-layers", word("layer_apply"))
    hand.until(f'/FONDAZIONE = "fixed"/.test({MEANT})')
    hand.write("#pane-layers input[placeholder='0.5 mm']", "0.5 mm")
    hand.until(f'/mend = "0.5 mm"/.test({MEANT})')
    for layer, load in (("SOLAIO", "0, -24"), ("COPERTURA", "0, -10")):
        hand.until(f"document.querySelector(\"select[aria-label$='{layer}']\")")
        hand.choose(f"select[aria-label$='{layer}']", "load")
        hand.write(f"input[aria-label$='{layer}']", load)
        hand.until(f"/{layer} = .*load/.test({MEANT})")
    hand.until(f"{SETTLED} && window.concio.view.shown && window.concio.view.shown.loads.length === 3", "the facade")
    hand.step("layers")
    hand.click("#tab-data")
    hand.write("[id='value-analysis-thickness']", "0.5")
    hand.until(f"/thickness = 0.5/.test({MEANT})")
    hand.write("[id='value-materials-block-unit_weight']", "19 kN/m3")
    hand.until(f'/unit_weight = "19 kN.m3"/.test({MEANT})')
    hand.until(f"{SETTLED} && /0\\.6/.test(document.querySelector('#begun')?.textContent)")
    hand.click_text("#begun", word("begun_meant"))
    hand.until(f"{SETTLED} && !document.querySelector('#begun')")
    hand.step("data")
    hand.click("[data-tool=load]")
    hand.choose("#pane-build [name=kind]", "weight")
    hand.click("#pane-build button.main")
    hand.until(f"{SETTLED} && window.concio.view.shown.loads.length === 4")
    hand.step("load")
    hand.click("#tab-ask")
    hand.step("question")
    hand.click("#run")
    hand.until("document.querySelector('#verdict-text .sentence')")
    hand.step("verdict")
    hand.until("document.querySelector('#running').hidden")
    hand.click("#tab-report")
    hand.until("document.querySelector('#pane-report iframe')")
    time.sleep(1.0)
    hand.step("report")
    hand.click_text("#pane-report", word("export"))
    hand.until("document.querySelector('#pane-report [role=status]')")
    hand.step("project folder")


def run(language: str, dark: bool, width: int, pictures: Path | None) -> Hand:
    """Make one trial and return what was counted."""
    height = 800 if width > 800 else 844
    with tempfile.TemporaryDirectory() as name, browser() as page:
        folder = Path(name)
        shutil.copy(ROOT / "examples" / "facade.dxf", folder)
        page.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        scheme = "dark" if dark else "light"
        page.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        with window(folder) as client:
            page.go(client.server.address)
            page.until("window.concio")
            if language == "it":
                page.js("localStorage.setItem('language', 'it'); location.reload()")
                page.until("document.documentElement.lang === 'it'")
            hand = Hand(page, pictures)
            trial(hand, client.call("hello")["words"], language == "it")
            assert page.complaints == [], page.complaints
    return hand


def main(arguments: list[str]) -> None:
    """Make the trial and print it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("pictures", nargs="?", type=Path)
    parser.add_argument("--language", default="en", choices=["en", "it"])
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args(arguments)
    hand = run(given.language, given.dark, given.width, given.pictures)
    lines = ["| step | clicks | texts |", "|---|---|---|"]
    for name, clicks, texts, _, seconds in hand.steps:
        print(f"{name:16s} {clicks:3d} clicks {texts:3d} texts {seconds:6.1f} s")
        lines.append(f"| {name} | {clicks} | {texts} |")
    total = time.perf_counter() - hand.begun
    print(f"{'in all':16s} {hand.clicks:3d} clicks {hand.texts:3d} texts {total:6.1f} s")
    lines.append(f"| in all | {hand.clicks} | {hand.texts} |")
    minutes = (total + hand.seconds) / 60
    print(f"{minutes:.1f} minutes of a person who knows the way")
    lines += ["", f"By the keystroke-level model, with the seconds of the machine: {minutes:.1f} minutes of a person",
              "who knows the way; reading and thinking about the structure come on top."]  # fmt: skip
    if given.write:
        head, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
        PAGE.write_text(f"{head}{BEGIN}\n\n" + "\n".join(lines) + f"\n\n{END}{rest.split(END)[1]}", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
