"""Measures of the window, without a browser: time to the first picture, to an answer, of a drag, and memory after many.

    python benchmarks/window.py [DRAGS]

Times are those of this machine; what is compared is the worker's own calculation with what the page waits for.
"""

from __future__ import annotations

import resource
import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

import concio  # noqa: E402
from windows import Client, window  # noqa: E402

LOAD = {"kind": "point", "value": [0.0, -4.0], "bodies": ["v05"], "at": [-0.95, 1.64544827], "group": "live"}


def resident(pid: int) -> float:
    """Return the memory of a process [MB], where the system tells it."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except OSError:
        return float("nan")
    return pages * resource.getpagesize() / 1e6


def main(drags: int) -> None:
    """Print the measures."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(Path(concio.__file__).parent / "model" / "templates" / "arch.toml", folder)
        shutil.copy(ROOT / "examples" / "facade.dxf", folder)
        shutil.copy(ROOT / "examples" / "facade.toml", folder)
        begun = time.perf_counter()
        with window(folder, folder / "arch.toml") as client:
            client.until("picture")
            print(f"arch of 15 voussoirs: first picture, processes started cold   {time.perf_counter() - begun:.2f} s")
            client.do({"do": "add", "to": "loads", "table": LOAD})
            client.until("picture")
            drag(client, drags)
            client.call("open", name="facade.toml")
            begun = time.perf_counter()
            client.until("picture")
            print(f"facade of 182 stones: picture                                 {time.perf_counter() - begun:.2f} s")
            begun = time.perf_counter()
            answer = client.answer("run")
            waited, own = time.perf_counter() - begun, answer["seconds"]
            print(f"facade: opened to verdict {waited:.2f} s, of which the command {own:.2f} s ({own / waited:.0%})")


def drag(client: Client, drags: int) -> None:
    """Print how long drags take, and the memory of the process before and after."""
    waited, own = [], []
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
    print(f"drag: median {1e3 * statistics.median(waited):.0f} ms of {drags}, of which the bound {share:.0%}")
    print(f"memory of the process: {before:.0f} MB after some, {resident(pid):.0f} MB after {drags} drags")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
