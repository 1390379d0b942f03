"""Measures of the window: first picture, answer, drags, memory, random commands, attacks.

    python benchmarks/window.py [DRAGS [REQUESTS]] [--write]

as many random commands as drags; ``--write`` puts the measures into the page of the window in the documentation. The
first picture is measured in Chromium, where there is one, from the command to the picture in the page; the rest without
a browser.

Times are those of this machine. Beside the seconds that were waited stand the processor seconds of the window and its
processes: those do not depend on what else the machine does.
"""

from __future__ import annotations

import json
import os
import random
import resource
import shutil
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import concio  # noqa: E402
from browser import Browser, browser, chromium  # noqa: E402
from windows import Client, known, window  # noqa: E402

PAGE = ROOT / "docs" / "howto" / "window.md"
BEGIN, END = "<!-- measures: written by benchmarks/window.py -->", "<!-- end of measures -->"
TOLD: list[str] = []
DEMO = ("ercolano_panel.toml", "ercolano_panel_full_base.toml")
"""The files of ``make demo``."""
SIXTY = (
    "[arch]\nspan = 4.0\nring = 0.6\nvoussoirs = 60\nblock = 'rigid'\nunit_weight = 20.0\nfriction = 0.7\n"
)
MIDDLES: dict[str, list[float]] = {}
LOAD = {"kind": "point", "value": [0.0, -4.0], "bodies": ["v05"], "at": [-0.95, 1.64544827], "group": "live"}


def resident(pid: int) -> float:
    """Return the memory of a process [MB], where the system tells it."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except OSError:
        return float("nan")
    return pages * resource.getpagesize() / 1e6


def processor(pid: int) -> float:
    """Return the processor seconds of a process and of those it started, as far as they run, where the system tells."""
    found = 0.0
    for place in Path("/proc").glob("[0-9]*"):
        try:
            fields = (place / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(place.name) == pid or int(fields[1]) == pid:
            found += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return found


def first_picture(page: Browser, file: Path, what: str) -> None:
    """Print what passes from the command to the first picture in the page, and to the whole one."""
    begun = time.perf_counter()
    command = [sys.executable, "-m", "concio", "window", str(file), "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=file.parent) as process:
        assert process.stdout is not None
        page.go(process.stdout.readline().split()[-1])
        told = []
        for name, code in (
            ("first picture", "view.shown?.bodies.length > 0"), ("joints and attention", "pictured() !== ''")
        ):  # fmt: skip
            page.until(f"window.concio && window.concio.{code}", pause=0.01)
            told.append(f"{name} {time.perf_counter() - begun:.2f} s ({processor(process.pid):.2f} s of processor)")
        tell(f"{what}, from the command: {', '.join(told)}")
        process.kill()
    page.go("about:blank")


def tell(line: str) -> None:
    """Print a measure, and keep it."""
    print(line, flush=True)
    TOLD.append(line)


def main(drags: int, count: int) -> None:
    """Print the measures."""
    if hasattr(os, "getloadavg"):
        tell(f"{os.getloadavg()[1]:.1f} processes wanted to run on {os.cpu_count()} cores in the minutes before")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(Path(concio.__file__).parent / "model" / "templates" / "arch.toml", folder)
        shutil.copy(ROOT / "examples" / "facade.dxf", folder)
        shutil.copy(ROOT / "examples" / "facade.toml", folder)
        (folder / "sixty.toml").write_text(SIXTY, encoding="utf-8")
        for name in DEMO:
            shutil.copy(ROOT / "examples" / name, folder)
        if chromium() is None:
            tell("There is no Chromium: the first picture is not measured.")
        else:
            with browser() as page:
                page.go("about:blank")
                first_picture(page, folder / "arch.toml", "arch of 15 voussoirs")
                first_picture(page, folder / "facade.toml", "facade of 182 stones")
                demo(page, folder)
        with window(folder, folder / "arch.toml") as client:
            client.until("picture")
            client.do({"do": "add", "to": "loads", "table": LOAD})
            client.until("picture")
            drag(client, drags)
            drag_on_sixty(client, max(drags // 10, 20))
            client.call("open", name="facade.toml")
            begun = time.perf_counter()
            client.until("picture")
            tell(f"facade of 182 stones: picture                                 {time.perf_counter() - begun:.2f} s")
            answer_of(client)
            drag_on_facade(client)
            dropped(client)
            commands(client, drags)
            large_drop(client, 200)
        attack(folder, count)


def answer_of(client: Client) -> None:
    """Print how long the verdict takes, and the answer with its report."""
    begun, before = time.perf_counter(), processor(client.server.session.asked.lane.pid or 0)
    client.call("ask", question="run", options={})
    told = {}
    while True:
        asked = client.call("state")["asked"]
        for name, there in (("verdict", asked.get("early")), ("with its report", asked["state"] == "done")):
            if name not in told and (there or asked["state"] == "done"):
                used = processor(client.server.session.asked.lane.pid or 0) - before
                told[name] = f"{name} {time.perf_counter() - begun:.2f} s ({used:.2f} s of processor)"
        if asked["state"] == "done":
            break
        time.sleep(0.05)
    tell(f"facade of 182 stones, from the question: {', '.join(told.values())}")


def drag(client: Client, drags: int) -> None:
    """Print how long drags take, and the memory of the process before and after."""
    waited, own = [], []
    used = processor(client.server.session.look.pid or 0)
    pid = client.server.session.look.pid or 0
    for k in range(drags):
        if k == min(20, drags // 2):
            before = resident(pid)
        begun = time.perf_counter()
        inward = 1.0 - 0.02 * (k % 7)
        found = client.call("drag", table=0, body="v05", at=[-0.95 * inward, 1.64544827 * inward])
        waited.append(time.perf_counter() - begun)
        own.append(found["done"]["seconds"])
    share = statistics.median(own) / statistics.median(waited)
    tell(f"drag: median {1e3 * statistics.median(waited):.0f} ms of {drags}, of which the bound {share:.0%};"
          f" {1e3 * (processor(pid) - used) / drags:.0f} ms of processor each")  # fmt: skip
    tell(f"memory of the process: {before:.0f} MB after some, {resident(pid):.0f} MB after {drags} drags")


def drag_on_sixty(client: Client, drags: int) -> None:
    """Print how long a bound takes on an arch of 60 voussoirs: up to there a drag is to take a tenth of a second."""
    client.call("open", name="sixty.toml")
    client.do({"do": "add", "to": "loads", "table": {**LOAD, "bodies": ["v20"], "at": middle_of(client, "v20")}})
    client.until("picture")
    waited, pid = [], client.server.session.look.pid or 0
    used = processor(pid)
    for k in range(drags):
        body = f"v{20 + k % 12}"
        begun = time.perf_counter()
        found = client.call("drag", table=0, body=body, at=middle_of(client, body))
        waited.append(time.perf_counter() - begun)
        assert found["state"] == "done", found
    own = 1e3 * (processor(pid) - used) / drags
    median = 1e3 * statistics.median(waited)
    tell(f"arch of 60 voussoirs: drag, median {median:.0f} ms of {drags}; {own:.0f} ms of processor each")


def middle_of(client: Client, body: str) -> list[float]:
    """Return the middle of a block, from the picture."""
    if body not in MIDDLES:
        MIDDLES.update({b["name"]: b["centre"] for b in client.until("picture")["done"]["bodies"]})
    return MIDDLES[body]


def dropped(client: Client) -> None:
    """Print what passes from a facade dropped on the page to its verdict, and to the whole answer."""
    content = (ROOT / "examples" / "facade.toml").read_bytes() + b"# dropped\n"
    begun, used = time.perf_counter(), processor(os.getpid())
    client.raw("POST", f"/{client.server.token}/drop", content, X_Name="dropped.toml", X_Page=client.page)
    client.until("picture")
    first = time.perf_counter() - begun
    client.call("ask", question="run", options={})
    early = 0.0
    while True:
        asked = client.call("state")["asked"]
        early = early or (time.perf_counter() - begun if asked.get("early") else 0.0)
        if asked["state"] == "done":
            break
        time.sleep(0.05)
    whole = time.perf_counter() - begun
    told = f"picture after {first:.2f} s, verdict {early or whole:.2f} s, report {whole:.2f} s"
    tell(f"facade of 182 stones dropped: {told}, of which {processor(os.getpid()) - used:.2f} s of processor")


def demo(page: Browser, folder: Path) -> None:
    """Print the clicks of the demo: both panels of the paper opened, asked, and their reports looked at."""
    clicks = 0

    def click(selector: str, wait: str) -> None:
        nonlocal clicks
        page.until(f"document.querySelector({json.dumps(selector)})")
        page.click(selector)
        clicks += 1
        page.until(wait)

    answered = ("document.querySelector('#running').hidden && "
                "document.querySelector('#verdict-text div:not(.old) .sentence')")  # fmt: skip
    said, begun = [], time.perf_counter()
    with window(folder) as client:
        page.go(client.server.address)
        for k, name in enumerate(DEMO):
            if k:
                click("#open", "document.querySelector('#start').open")
            page.until("document.querySelector('#start').open")
            buttons = "[...document.querySelectorAll('#start button')]"
            button = f"{buttons}.find((b) => b.textContent === {json.dumps(name)})"
            page.until(button)
            page.js(f"({button}).id = 'wanted'")
            click("#wanted", f"window.concio.state().document?.name === {json.dumps(name)}")
            page.until("window.concio.pictured().startsWith(window.concio.state().document.hash)")
            if k:
                click("#tab-ask", "document.querySelector('#run') && !document.querySelector('#run').disabled")
            page.until("document.querySelector('#run') && !document.querySelector('#run').disabled")
            click("#run", answered)
            said.append(page.js("document.querySelector('#verdict-text .headline').textContent"))
            click("#tab-report", "document.querySelector('#pane-report iframe')")
        page.go("about:blank")
    seconds = time.perf_counter() - begun
    told = "; ".join(said)
    tell(f"demo, both panels from the empty window to their reports: {clicks} clicks, {seconds:.0f} s ({told})")


def drag_on_facade(client: Client) -> None:
    """Print how long a bound takes while a load is dragged along the top of the facade: until then it is grey."""
    bodies = [b for b in client.until("picture")["done"]["bodies"] if b["kind"] != "fixed"]
    highest = max(y for b in bodies for _, y in b["rings"][0])
    tops = [b for b in bodies if max(y for _, y in b["rings"][0]) > highest - 1e-3]
    places = [(b["name"], max(b["rings"][0], key=lambda p: (round(p[1], 3), -p[0]))) for b in tops]
    load = {"kind": "point", "value": [0.0, -10.0], "bodies": [places[0][0]], "at": places[0][1], "group": "drag"}
    client.do({"do": "add", "to": "loads", "table": load})
    client.until("picture")
    waited, last = [], client.call("state", version=-1)["document"]["lists"]["loads"] - 1
    for body, at in places:
        begun = time.perf_counter()
        found = client.call("drag", table=last, body=body, at=at)
        waited.append(time.perf_counter() - begun)
        assert found["state"] == "done", found
    tell(f"facade of 182 stones, a load dragged along its top: median {1e3 * statistics.median(waited):.0f} ms")
    client.call("undo")


def commands(client: Client, count: int) -> None:
    """Print whether random commands, taken back to the first, leave the text as it was."""
    draw = random.Random(1)
    client.call("open", name="arch.toml")
    before = (client.server.session.folder / "arch.toml").read_text(encoding="utf-8")
    begun, done = time.perf_counter(), 0
    for k in range(count):
        what = draw.choice(("load", "tie", "value", "group"))
        if what == "load":
            table = {**LOAD, "at": [round(draw.uniform(-1.0, 1.0), 3), 1.7], "group": f"g{k % 3}"}
            found = client.do({"do": "add", "to": "loads", "table": table})
        elif what == "tie":
            ends = {"at_a": [-1.0, 0.5], "at_b": [1.0, 0.5]}
            found = client.do({"do": "add", "to": "ties", "table": {"name": f"tie {k}", "body_a": "v01", **ends}})
        elif what == "value":
            found = client.do({"do": "set", "path": ["arch", "ring"], "value": round(draw.uniform(0.1, 0.5), 3)})
        else:
            found = client.do({"do": "set", "path": ["loads", 0, "group"], "value": f"h{k % 5}"})
        done += "error" not in found
        if draw.random() < 0.2:
            client.call("undo")
    while client.call("state")["document"]["undo"]:
        client.call("undo")
    same = client.call("state", version=0)["document"]["text"] == before
    text = "the same text" if same else "ANOTHER TEXT"
    tell(f"{done} random commands, some taken back at once, then all: {text} ({time.perf_counter() - begun:.0f} s)")


def held(pid: int) -> str:
    """Return memory, open files and threads of a process, where the system tells them."""
    try:
        there = Path(f"/proc/{pid}")
        files, threads = len(list((there / "fd").iterdir())), len(list((there / "task").iterdir()))
    except OSError:
        return "unknown"
    return f"{resident(pid):.0f} MB, {files} open files, {threads} threads"


def attack(folder: Path, count: int) -> None:
    """Print what many requests, most of them hostile, leave in a window of its own process, and whether it answers."""
    command = [sys.executable, "-m", "concio", "window", str(folder / "arch.toml"), "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        client = known(process.stdout.readline().split()[-1])
        client.until("picture")
        text = client.call("state", version=-1)["document"]["text"]
        statuses: Counter[str] = Counter()
        shoot(client, 500, statuses)
        before, begun = held(process.pid), time.perf_counter()
        statuses.clear()
        shoot(client, count, statuses)
        rate = count / (time.perf_counter() - begun)
        time.sleep(1.0)
        after, begun = held(process.pid), time.perf_counter()
        same = client.call("state", version=-1)["document"]["text"] == text
        waited = 1e3 * (time.perf_counter() - begun)
        answered = ", ".join(f"{name} {n}" for name, n in sorted(statuses.items()))
        tell(f"{count} requests, eight of ten hostile: {rate:.0f} a second ({answered}); before {before},"
             f" after {after}; {'the same text' if same else 'ANOTHER TEXT'}, answered in {waited:.0f} ms")  # fmt: skip
        process.kill()


def shoot(client: Client, count: int, statuses: Counter[str]) -> None:
    """Send requests of ten kinds by turns, and count how they are answered."""
    import http.client

    token, port, origin = client.server.token, client.server.server_port, client.server.origin
    state = json.dumps({"page": client.page, "version": 10**9}).encode()
    own = {"Origin": origin, "Content-Type": "application/json"}
    kinds: list[tuple[str, str, bytes | None, dict[str, str]]] = [
        ("POST", f"/{token}/api/state", state, own),
        ("POST", f"/{token}/api/picture", state, own),
        ("POST", f"/{'x' * len(token)}/api/state", state, own),
        ("POST", f"/{token}/api/state", state, {"Origin": "http://evil.example"}),
        ("GET", f"/{token}/", None, {"Host": "evil.example"}),
        ("GET", f"/{token}/..%2f..%2fsession.py", None, {}),
        ("POST", f"/{token}/api/do", b'{"commands": [{"do": "set", "path": ["arch", 7], "value": []}]}', own),
        ("POST", f"/{token}/api/ask", b'{"question": "rm", "options": {"out": "/"}}', own),
        ("POST", f"/{token}/drop", b"x", {**own, "X-Name": "../arch.toml"}),
    ]
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    for k in range(count):
        if k % 10 == 9:  # a request that breaks off
            with socket.create_connection(("127.0.0.1", port), timeout=60) as broken:
                broken.sendall(b"POST /" + token.encode() + b"/api/do HTTP/1.1\r\nContent-Length: 900\r\n")
            statuses["broken off"] += 1
            continue
        method, path, body, headers = kinds[k % 10]
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        answer.read()
        statuses[str(answer.status)] += 1
    connection.close()


def large_drop(client: Client, megabytes: int) -> None:
    """Print what becomes of a file that is too large."""
    begun, size = time.perf_counter(), megabytes * 1_000_000
    head = (f"POST /{client.server.token}/drop HTTP/1.1\r\nHost: 127.0.0.1:{client.server.server_port}\r\n"
            f"Origin: {client.server.origin}\r\nX-Name: large.dxf\r\nContent-Length: {size}\r\n\r\n")  # fmt: skip
    with socket.create_connection(("127.0.0.1", client.server.server_port), timeout=30) as connection:
        connection.sendall(head.encode())
        sent = 0
        try:
            while sent < size:
                sent += connection.send(b"0" * 1_000_000)
        except OSError:
            pass
        try:
            said = connection.recv(100).decode(errors="replace").split("\r\n")[0]
        except OSError:
            said = "connection closed"
    there = "taken" if (client.server.session.folder / "large.dxf").exists() else "not taken"
    tell(
        f"drop of {megabytes} MB: {said}, {there}, {sent / 1e6:.0f} MB were sent ({time.perf_counter() - begun:.2f} s)"
    )


def write() -> None:
    """Put the measures into the documentation."""
    head, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    lines = "\n".join(f"* {line[0].upper()}{' '.join(line.split())[1:]}" for line in TOLD)
    PAGE.write_text(f"{head}{BEGIN}\n\n{lines}\n\n{END}{rest.split(END)[1]}", encoding="utf-8")


if __name__ == "__main__":
    given = [int(word) for word in sys.argv[1:] if word != "--write"]
    main(given[0] if given else 1000, given[1] if len(given) > 1 else 100_000)
    if "--write" in sys.argv:
        write()
