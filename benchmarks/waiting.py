"""Seconds that people wait: every template and every example, by the commands that their first lines name.

    python benchmarks/waiting.py [--only NAME ...] [--repeat 1] [--most 120]
                                 [--save BEFORE.json] [--before BEFORE.json] [--busy BUSY.json] [--write PAGE.md]

Each command runs in a process of its own, as people run it, with one thread of linear algebra. Two numbers are taken:
the seconds of the processor (user and system, workers included), which another process on the same machine changes
little, and the seconds of the clock until the first line with a number. ``--save`` keeps the numbers as they come (a
second call goes on where the first ended), ``--before`` puts earlier ones beside them, ``--busy`` those kept while
other processes ran on every core, ``--write`` writes the table as a page. ``--only path`` measures one command,
``--only tower`` one file.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import concio

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
TEMPLATES = Path(concio.__file__).parent / "model" / "templates"
COMMAND = re.compile(r"^#\s+concio (?P<words>[a-z]+ \S+\.toml(?: \S+)*?)(?:\s{2,}.*)?$", re.MULTILINE)
BESIDE = ("path facade.toml",)
"""Commands that are measured though no file names them."""


@dataclass(frozen=True)
class Wait:
    """What one command took: exit code (None: stopped), seconds of the processor, of the clock, to the first number."""

    code: int | None
    processor: float
    wall: float
    first: float | None

    def words(self) -> str:
        """Return processor seconds as the table has them."""
        return f"{self.processor:.1f}" if self.code is not None else f"more than {self.processor:.0f}"

    def first_words(self) -> str:
        """Return the seconds to the first number as the table has them."""
        return "" if self.first is None else f"{self.first:.1f}"


def commands() -> list[tuple[str, str]]:
    """Return every (file, command), templates first."""
    found = []
    for folder in (TEMPLATES, EXAMPLES):
        for path in sorted(folder.glob("*.toml")):
            named = [m["words"] for m in COMMAND.finditer(path.read_text(encoding="utf-8"))]
            found += [(path.name, words.replace("examples/", "")) for words in named]
            found += [(path.name, words) for words in BESIDE if words.split()[1] == path.name]
    return found


def first_number(stream: list[tuple[float, str]]) -> float | None:
    """Return when the first line with a number appeared, if any."""
    return next((at for at, line in stream if re.search(r"\d", line)), None)


def wait(words: str, place: Path, most: float) -> Wait:
    """Run one command in ``place``; stop it after ``most`` seconds of the clock."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "MPLBACKEND": "Agg", "PYTHONUNBUFFERED": "1"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # as people have it: modules are compiled once
    start = time.perf_counter()
    process = subprocess.Popen([sys.executable, "-m", "concio", *shlex.split(words)], cwd=place, env=environment,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)  # fmt: skip
    assert process.stdout is not None
    os.set_blocking(process.stdout.fileno(), False)
    stream: list[tuple[float, str]] = []
    while True:
        stream += [(time.perf_counter() - start, line) for line in iter(process.stdout.readline, "")]
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        wall = time.perf_counter() - start
        if pid:
            break
        if wall > most:
            process.kill()
            pid, status, usage = os.wait4(process.pid, 0)
            break
        time.sleep(0.01)
    process.returncode = os.waitstatus_to_exitcode(status)
    code = process.returncode if process.returncode >= 0 else None
    return Wait(code, usage.ru_utime + usage.ru_stime, wall, first_number(stream))


def kept(path: Path | None) -> dict[str, Wait]:
    """Return what an earlier run kept in ``path``."""
    if path is None or not path.exists():
        return {}
    return {words: Wait(**w) for words, w in json.loads(path.read_text(encoding="utf-8")).items()}


def measure(only: list[str], repeat: int, most: float, save: Path | None) -> dict[str, Wait]:
    """Return the least of ``repeat`` runs of every command; what ``save`` holds already is not run again."""
    waits = kept(save)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "examples"
        shutil.copytree(EXAMPLES, place)
        for template in TEMPLATES.glob("*.toml"):
            shutil.copy(template, place / template.name)
        for file, words in commands():
            if only and not any(name in (file, Path(file).stem, words.split()[0]) for name in only):
                continue
            if words in waits:
                continue
            runs = [wait(words, place, most) for _ in range(repeat)]
            waits[words] = min(runs, key=lambda w: w.processor)
            taken = waits[words]
            print(f"{taken.processor:8.2f} s  {taken.wall:8.2f} s  first {taken.first or float('nan'):6.2f} s  "
                  f"exit {taken.code}  concio {words}", flush=True)  # fmt: skip
            if save:
                save.write_text(json.dumps({w: asdict(t) for w, t in waits.items()}, indent=1), encoding="utf-8")
    return waits


def table(waits: dict[str, Wait], before: dict[str, Wait], busy: dict[str, Wait]) -> str:
    """Return the table as Markdown."""
    head = ["command", *(["before"] if before else []), "processor s", "first number after s", "exit code"]
    head += ["busy: processor s", "busy: first number after s"] if busy else []
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for words, taken in waits.items():
        old = [before[words].words() if words in before else ""] if before else []
        code = "stopped" if taken.code is None else str(taken.code)
        beside = ([busy[words].words(), busy[words].first_words()] if words in busy else ["", ""]) if busy else []
        cells = [f"`concio {words}`", *old, taken.words(), taken.first_words(), code, *beside]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure, print, keep."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="files, their stems, or commands")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--most", type=float, default=120.0, help="seconds after which a command is stopped")
    parser.add_argument("--save", type=Path)
    parser.add_argument("--before", type=Path)
    parser.add_argument("--busy", type=Path)
    parser.add_argument("--write", type=Path)
    chosen = parser.parse_args()
    waits = measure(chosen.only, chosen.repeat, chosen.most, chosen.save)
    if chosen.write:
        written = table(waits, kept(chosen.before), kept(chosen.busy))
        chosen.write.write_text(written, encoding="utf-8")


if __name__ == "__main__":
    main()
