"""A headless Chromium over the DevTools protocol, with the standard library alone: its pipe needs no web socket."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
LATE = float(os.environ.get("LATE", 240.0))
"""What is not there after so long is missing [s]: a machine may be busy."""
KEYS = {"Enter": ("\r", 13), "Tab": ("\t", 9), "Escape": ("", 27), "ArrowRight": ("", 39), "ArrowLeft": ("", 37),
        "ArrowUp": ("", 38), "ArrowDown": ("", 40), " ": (" ", 32)}  # fmt: skip


def chromium() -> str | None:
    """Return the program: that of the variable CHROMIUM, or one that is installed."""
    given = os.environ.get("CHROMIUM")
    return given or next((found for name in NAMES if (found := shutil.which(name))), None)


class Left(AssertionError):
    """The page was left for another before it answered."""


class Browser:
    """A page in a browser.

    Parameters
    ----------
    program : str
    profile : Path
        An empty directory.
    """

    def __init__(self, program: str, profile: Path, size: tuple[int, int] = (1280, 860)) -> None:
        to_read, self._write = os.pipe()
        self._read, to_write = os.pipe()
        script = 'exec 3<&"$1" 4>&"$2"; shift 2; exec "$@"'
        flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                 "--remote-debugging-pipe", "--no-first-run", "--disable-background-networking",
                 "--disable-component-update", "--disable-sync",
                 "--disable-default-apps", "--hide-scrollbars", f"--user-data-dir={profile}",
                 f"--window-size={size[0]},{size[1]}", "--force-prefers-reduced-motion", "about:blank"]  # fmt: skip
        self._process = subprocess.Popen(
            ["bash", "-c", script, "bash", str(to_read), str(to_write), program, *flags],
            pass_fds=(to_read, to_write), env={**os.environ, "HOME": str(profile)},
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(to_read)
        os.close(to_write)
        self._buffer, self._number = b"", 0
        self.events: list[dict[str, Any]] = []
        self._session: str | None = None
        target = self.send("Target.getTargets")["targetInfos"]
        page = next(t for t in target if t["type"] == "page")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.send(f"{domain}.enable")
        self.send(
            "Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=False
        )

    def close(self) -> None:
        """End the browser."""
        self._process.kill()
        self._process.wait()
        os.close(self._read)
        os.close(self._write)

    def send(self, method: str, **params: Any) -> dict[str, Any]:
        """Return the answer to a command of the protocol."""
        self._number += 1
        number = self._number
        message: dict[str, Any] = {"id": number, "method": method, "params": params}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            found = self._next(LATE)
            if found.get("id") == number:
                if "navigated" in found.get("error", {}).get("message", ""):
                    raise Left(found["error"]["message"])
                assert "error" not in found, f"{method}: {found['error']}"
                return found["result"]

    def _next(self, patience: float) -> dict[str, Any]:
        end = time.monotonic() + patience
        while b"\0" not in self._buffer:
            ready, _, _ = select.select([self._read], [], [], max(0.0, end - time.monotonic()))
            assert ready, "the browser does not answer"
            piece = os.read(self._read, 1 << 20)
            assert piece, "the browser has ended"
            self._buffer += piece
        raw, self._buffer = self._buffer.split(b"\0", 1)
        found = json.loads(raw)
        if "method" in found:
            self.events.append(found)
        return found

    def go(self, address: str) -> None:
        """Open a page."""
        self.send("Page.navigate", url=address)

    def js(self, code: str) -> Any:
        """Return the value of an expression in the page."""
        found = self.send("Runtime.evaluate", expression=code, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, f"{code}: {found['exceptionDetails'].get('exception')}"
        return found["result"].get("value")

    def until(self, code: str, why: str = "", pause: float = 0.05) -> None:
        """Wait until an expression of the page is true."""
        end = time.monotonic() + LATE
        while time.monotonic() < end:
            with suppress(Left):
                if self.js(f"(() => {{ try {{ return Boolean({code}); }} catch {{ return false; }} }})()"):
                    return
            time.sleep(pause)
        msg = f"{why or code} did not happen; the page says: {self.js('document.body.innerText')[:1500]}"
        raise AssertionError(msg)

    def press(self, key: str, *, ctrl: bool = False, alt: bool = False, shift: bool = False) -> None:
        """Press a key."""
        text, code = KEYS.get(key, (key, ord(key.upper()) if len(key) == 1 else 0))
        flags = 2 * ctrl + alt + 8 * shift
        shown = "" if ctrl or alt else text
        told = {"key": key, "modifiers": flags, "windowsVirtualKeyCode": code, "text": shown, "code": _code(key)}
        self.send("Input.dispatchKeyEvent", type="keyDown" if shown else "rawKeyDown", **told)
        self.send("Input.dispatchKeyEvent", type="keyUp", **{**told, "text": ""})

    def type(self, text: str) -> None:
        """Write a text where the focus is."""
        self.send("Input.insertText", text=text)

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        """Send an event of the mouse: mousePressed, mouseMoved, mouseReleased."""
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1, **more)

    def click_at(self, x: float, y: float) -> None:
        """Click a place of the page [px]."""
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.mouse(kind, x, y)

    def click(self, selector: str) -> None:
        """Click the middle of an element."""
        code = f"(() => {{ const e = document.querySelector({json.dumps(selector)}); if (!e) return null; "
        code += "e.scrollIntoView({block: 'nearest'}); const r = e.getBoundingClientRect(); "
        code += "return [r.x + r.width / 2, r.y + r.height / 2]; })()"
        at = self.js(code)
        assert at is not None, f"there is no {selector}"
        self.click_at(*at)

    def where(self, x: float, y: float) -> tuple[float, float]:
        """Return the place on the page [px] of a point of the picture [m]."""
        code = f"(() => {{ const p = new DOMPoint({x}, {-y}).matrixTransform("
        code += "document.getElementById('picture').getScreenCTM()); return [p.x, p.y]; })()"
        found = self.js(code)
        return found[0], found[1]

    def picture(self, path: Path) -> None:
        """Write a picture of the page."""
        path.write_bytes(base64.b64decode(self.send("Page.captureScreenshot")["data"]))

    @property
    def requests(self) -> list[str]:
        """Addresses that were asked for."""
        sent = [e for e in self.events if e["method"] == "Network.requestWillBeSent"]
        return [e["params"]["request"]["url"] for e in sent]

    @property
    def complaints(self) -> list[str]:
        """What the page printed as errors, and exceptions that nobody caught."""
        thrown = [e["params"]["exceptionDetails"] for e in self.events if e["method"] == "Runtime.exceptionThrown"]
        logged = [e["params"]["entry"] for e in self.events if e["method"] == "Log.entryAdded"]
        said = [f"{x.get('text')} {x.get('exception', {}).get('description', '')}" for x in thrown]
        return said + [f"{x['text']} {x.get('url', '')}" for x in logged if x["level"] == "error"] + self._refusals()

    def _refusals(self) -> list[str]:
        """Return what was asked and answered where a request was refused."""
        sent = {e["params"]["requestId"]: e["params"]["request"] for e in self.events
                if e["method"] == "Network.requestWillBeSent"}  # fmt: skip
        answers = [e["params"] for e in self.events if e["method"] == "Network.responseReceived"]
        told = []
        for one in answers:
            if one["response"]["status"] >= 400:
                asked = sent.get(one["requestId"], {}).get("postData", "")[:1000]
                try:
                    body = self.send("Network.getResponseBody", requestId=one["requestId"])["body"]
                except AssertionError:
                    body = "its body is gone"
                told.append(f"{one['response']['status']} {one['response']['url']} asked {asked} answered {body}")
        return told


def _code(key: str) -> str:
    return f"Key{key.upper()}" if len(key) == 1 and key.isalpha() else f"Digit{key}" if key.isdigit() else key


@contextmanager
def browser() -> Iterator[Browser]:
    """Give a browser that ends afterwards."""
    program = chromium()
    assert program is not None, "there is no Chromium: install one, or name it in the variable CHROMIUM"
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        found = Browser(program, Path(profile))
        try:
            yield found
        finally:
            found.close()
