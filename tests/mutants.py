"""A sample of mutants of the package: small faults put in on purpose, which the tests must see.

python tests/mutants.py [--count 60] [--seed 0] [--jobs 2] [--only PATH] [--named] [--minutes M] [--traced FILE]

Each mutant changes one operator, comparison, constant or function of one line (a minus for a plus, a
maximum for a minimum, a factor of two where a number is not a threshold: between
a thousandth and a million); the tests of its room, quick ones first, are run on a copy of the
package that holds it, until one fails. A test that fails without the mutant, too, has killed nothing: the run ends, and
says which. Survivors are defects of the tests, or mutants that change nothing: those stand
in ``mutants_kept.toml`` with the reason. Any other survivor makes the exit code 1. With ``--named`` those of
``mutants_named.toml`` are tried instead of a sample. After ``--minutes`` no other mutant is begun.

A room has more tests than those that the table names: what survives these is tried by the other files of tests that
import its module, and by the long tests of both. With ``--traced FILE``, a data file of coverage.py that knows the
test of each line (``pytest -m "not long" --cov=concio --cov-context=test``, of pytest-cov), what survives its room is
tried by all tests that ran its line, those that run the fewest lines first.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from itertools import accumulate
from pathlib import Path
from queue import SimpleQueue

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent / "src" / "concio"
KEPT = HERE / "mutants_kept.toml"
SECONDS = 90
"""A mutant whose tests take more time of a processor is dead, where they do not without it: it made something
endless."""
LONG = "took too long"
TRACED_SECONDS = 300
"""Time of a processor for the tests that import a module, for long ones, and for the tests that ran the line of a
mutant; where it is over, the mutant has survived."""
MOST_TRACED = 1000
"""Tests that ran the line of a mutant, beyond which no other is tried."""

ROOMS: dict[str, tuple[str, ...]] = tomllib.loads((HERE / "mutants_rooms.toml").read_text(encoding="utf-8"))["rooms"]
"""Files and folders of the core, and the tests that look at them, quick ones first."""


@dataclass(frozen=True)
class Mutant:
    """One change of one file.

    Parameters
    ----------
    path : str
        File in the package.
    line : int
    old, new : str
        The smallest expression that changes.
    start : int
        Where ``old`` begins in the file, in bytes.
    tests : tuple of str
        What should see it; those of its room where there are none.
    """

    path: str
    line: int
    old: str
    new: str
    start: int
    tests: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """What names a mutant where lines move."""
        return f"{self.path}: {self.old} -> {self.new}"

    def put_in(self, text: str) -> str:
        """Return the text of its file with the change; an expression goes in with brackets, a named one as it is."""
        raw, old = text.encode(), self.old.encode()
        new = self.new if self.tests else f"({self.new})"
        return (raw[: self.start] + new.encode() + raw[self.start + len(old) :]).decode()


LIMITED = """
import resource, sys, pytest
seconds = int(sys.argv[1])
resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
sys.exit(pytest.main(sys.argv[2:]))
"""
"""Runs tests with a limit on the time of the processor, which says the same on a busy machine."""

SWAPPED = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Lt: ast.GtE, ast.LtE: ast.Gt,
    ast.Gt: ast.LtE, ast.GtE: ast.Lt, ast.And: ast.Or, ast.Or: ast.And, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd,
}  # fmt: skip
NAMES = {
    "maximum": "minimum",
    "minimum": "maximum",
    "max": "min",
    "min": "max",
    "abs": "float",
    "any": "all",
    "all": "any",
}


def changes(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the changed copies of one node."""
    if isinstance(node, ast.BinOp) and type(node.op) in SWAPPED:
        if isinstance(node.op, ast.BitOr) and isinstance(node.right, ast.Constant | ast.Name):
            return  # a union of types
        yield ast.BinOp(node.left, SWAPPED[type(node.op)](), node.right)
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in SWAPPED:
        yield ast.Compare(node.left, [SWAPPED[type(node.ops[0])]()], node.comparators)
    elif isinstance(node, ast.BoolOp):
        yield ast.BoolOp(SWAPPED[type(node.op)](), node.values)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield node.operand
    elif isinstance(node, ast.Attribute) and node.attr in NAMES and node.attr not in ("abs",):
        yield ast.Attribute(node.value, NAMES[node.attr], node.ctx)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("max", "min"):
        yield ast.Call(ast.Name(NAMES[node.func.id], ast.Load()), node.args, node.keywords)
    elif isinstance(node, ast.Constant) and isinstance(node.value, float) and 1e-3 < abs(node.value) < 1e6:
        yield ast.Constant(node.value * 2.0)


def mutants_of(path: Path) -> list[Mutant]:
    """Return all mutants of a file; messages, annotations and defaults of the module's constants are left alone."""
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    name, lines = path.relative_to(SOURCE).as_posix(), text.encode().split(b"\n")
    begins = [0, *accumulate(len(line) + 1 for line in lines)]
    found = []
    inside: set[int] = set()
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef):
            skip = {id(n) for a in ast.walk(function.args) for n in ast.walk(a)}
            skip |= {id(n) for n in ast.walk(function.returns)} if function.returns else set()
            skip |= {id(n) for s in ast.walk(function) if isinstance(s, ast.AnnAssign) for n in ast.walk(s.annotation)}
            skip |= {id(n) for s in ast.walk(function) if isinstance(s, ast.Raise | ast.JoinedStr) for n in ast.walk(s)}
            inside |= {id(n) for s in function.body for n in ast.walk(s)} - skip
    for node in ast.walk(tree):
        if id(node) not in inside or not hasattr(node, "lineno"):
            continue
        for changed in changes(node):
            if node.lineno != node.end_lineno:
                continue
            row, start, end = node.lineno - 1, node.col_offset, node.end_col_offset
            old = lines[row][start:end].decode()
            found.append(Mutant(name, node.lineno, old, ast.unparse(changed), begins[row] + start))
    return found


def named_mutants() -> list[Mutant]:
    """Return the mutants of ``mutants_named.toml``; each has to be found once in its file."""
    found = []
    for entry in tomllib.loads((HERE / "mutants_named.toml").read_text(encoding="utf-8"))["named"]:
        text = (SOURCE / entry["path"]).read_text(encoding="utf-8")
        if text.count(entry["old"]) != 1:
            sys.exit(f"{entry['path']} holds {text.count(entry['old'])} times: {entry['old']}")
        before = text[: text.index(entry["old"])]
        line, start = before.count("\n") + 1, len(before.encode())
        found.append(Mutant(entry["path"], line, entry["old"], entry["new"], start, tuple(entry["tests"])))
    return found


def tests_for(path: str) -> list[str]:
    """Return the tests that look at a file: those of the longest place that holds it."""
    places = [place for place in ROOMS if path == place or path.startswith(place.rstrip("/") + "/")]
    return list(ROOMS[max(places, key=len)])


@cache
def imports_of_tests() -> dict[str, frozenset[str]]:
    """Return the modules of the package that each file of tests imports."""
    found = {}
    for file in sorted(HERE.rglob("test_*.py")):
        text = file.read_text(encoding="utf-8")
        nodes = [n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.ImportFrom) and n.module]
        names = {m for n in nodes for m in (n.module, *(f"{n.module}.{a.name}" for a in n.names))}
        found[file.relative_to(HERE.parent).as_posix()] = frozenset(m for m in names if m.startswith("concio."))
    return found


def importers_of(path: str) -> list[str]:
    """Return the files of tests that import a module: that of its name first, then those that import the least."""
    module = "concio." + path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    known = [(file, names) for file, names in imports_of_tests().items() if module in names]
    own = f"/test_{module.rsplit('.', 1)[-1]}.py"
    return [file for file, names in sorted(known, key=lambda k: (not k[0].endswith(own), len(k[1]), k[0]))]


def copied(root: Path) -> Path:
    """Return a copy of the package in ``src`` of a folder that has everything else of the repository beside it."""
    package = Path(shutil.copytree(SOURCE, root / "src" / "concio"))
    for beside in HERE.parent.iterdir():
        if beside.name != "src":
            (root / beside.name).symlink_to(beside)
    return package


class Traces:
    """Which test ran which line, from a data file of coverage.py.

    Parameters
    ----------
    file : Path
    """

    def __init__(self, file: Path) -> None:
        self.file = file
        with sqlite3.connect(file) as data:
            size = "select context_id, sum(length(numbits)) from line_bits group by context_id"
            self.size = dict(data.execute(size).fetchall())

    def tests_of(self, mutant: Mutant) -> list[str]:
        """Return the tests that ran the line of a mutant, those that run the fewest lines first."""
        asked = (
            "select context.id, context.context, numbits from line_bits join context on context.id = context_id "
            "join file on file.id = file_id where file.path like ?"
        )
        byte, bit = divmod(mutant.line, 8)
        with sqlite3.connect(self.file) as data:
            rows = data.execute(asked, (f"%/concio/{mutant.path}",)).fetchall()
        ran = [(self.size[i], name) for i, name, bits in rows if byte < len(bits) and bits[byte] >> bit & 1]
        return list(dict.fromkeys(name.rsplit("|", 1)[0] for _, name in sorted(ran) if "::" in name))


def killed_by(mutant: Mutant, package: Path, traces: Traces | None = None) -> str:
    """Return the test that sees a mutant, or nothing; ``package`` is a copy of the package to put it in."""
    target = package / mutant.path
    whole = target.read_text(encoding="utf-8")
    target.write_text(mutant.put_in(whole), encoding="utf-8")
    try:
        room = mutant.tests or tests_for(mutant.path)
        test = first_failure(room, package)
        if test == LONG:
            target.write_text(whole, encoding="utf-8")
            test = "" if first_failure_without(tuple(room), package) == LONG else LONG
            target.write_text(mutant.put_in(whole), encoding="utf-8")
        others = [] if mutant.tests else [file for file in importers_of(mutant.path) if file not in room]
        traced = traces.tests_of(mutant)[:MOST_TRACED] if traces is not None and not test else []
        for tests, select in ((others, "not long"), ([*room, *others], "long"), (traced, "not long")):
            if tests and not test:  # only what fails has seen it
                test = first_failure(tests, package, TRACED_SECONDS, select)
                test = test if test.startswith(("FAILED ", "ERROR ")) else ""
    finally:
        target.write_text(whole, encoding="utf-8")
    if test.startswith(("FAILED ", "ERROR ")) and fails_anyway(test.split(" ", 1)[1], package):
        sys.exit(f"{test} without any mutant: mend that first")
    return test


def first_failure(tests: Sequence[str], package: Path, seconds: int = SECONDS, select: str = "not long") -> str:
    """Return the first test that fails with a copy of the package, how else they ended, or nothing."""
    # no bytecode: that of a mutant of the same second and size would pass for that of the next
    env = {**os.environ, "PYTHONPATH": str(package.parent), "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    options = ["-x", "-q", "--no-header", "-p", "no:cacheprovider", "-m", select, "--tb=no"]
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, str(seconds), *options, *tests],
        cwd=HERE.parent, env=env, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode == 0:
        return ""
    failed = [line for line in done.stdout.split("\n") if line.startswith(("FAILED", "ERROR"))]
    endless = done.returncode == -signal.SIGXCPU
    return failed[0].split(" - ")[0] if failed else LONG if endless else f"exit code {done.returncode}"


@cache
def first_failure_without(tests: tuple[str, ...], package: Path) -> str:
    """Return how tests end with the package as it is."""
    return first_failure(tests, package)


@cache
def fails_anyway(test: str, package: Path) -> bool:
    """Return whether a test fails with the package as it is."""
    return bool(first_failure([test], package, TRACED_SECONDS, "long or not long"))


def main() -> int:
    """Draw a sample, try it, print what became of each; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="a file or folder of the package")
    parser.add_argument("--named", action="store_true", help="those that once survived, one by one")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="after which no other mutant is begun")
    parser.add_argument("--traced", type=Path, help="data of coverage.py: which test ran which line")
    chosen = parser.parse_args()
    traces = Traces(chosen.traced) if chosen.traced else None
    last = time.monotonic() + 60 * chosen.minutes
    missing = sorted({t for tests in ROOMS.values() for t in tests if not (HERE.parent / t).exists()})
    if missing:
        sys.exit("no such tests: " + ", ".join(missing))
    paths = sorted(
        {p for place in ROOMS for p in ([SOURCE / place] if place.endswith(".py") else (SOURCE / place).rglob("*.py"))}
    )
    drawn = [] if chosen.named else [m for p in paths if chosen.only in p.as_posix() for m in mutants_of(p)]
    every = drawn or [m for m in named_mutants() if chosen.only in m.path]
    sample = every if chosen.named else random.Random(chosen.seed).sample(every, min(chosen.count, len(every)))
    kept = tomllib.loads(KEPT.read_text(encoding="utf-8")).get("kept", {}) if KEPT.exists() else {}
    print(f"{len(sample)} of {len(every)} mutants of {len(paths)} files, seed {chosen.seed}", flush=True)
    copies: SimpleQueue[Path] = SimpleQueue()
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for k in range(chosen.jobs):
            copies.put(copied(Path(folder) / str(k)))

        def attempt(mutant: Mutant) -> tuple[Mutant, str | None]:
            if time.monotonic() > last:
                return mutant, None
            package = copies.get()
            try:
                return mutant, killed_by(mutant, package, traces)
            finally:
                copies.put(package)

        with ThreadPoolExecutor(chosen.jobs) as pool:
            for mutant, test in pool.map(attempt, sample):
                why = kept.get(mutant.key, "")
                word = "not tried" if test is None else "killed" if test else "kept" if why else "SURVIVED"
                print(
                    f"{word:10s} {mutant.path}:{mutant.line}  {mutant.old}  ->  {mutant.new}  {test or why}", flush=True
                )
                counts[word] += 1
    told = ", ".join(f"{number} {word}" for word, number in counts.items())
    print(f"{len(sample)} mutants: {told}")
    return 1 if counts["SURVIVED"] else 0


if __name__ == "__main__":
    sys.exit(main())
