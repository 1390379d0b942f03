"""What goes wrong around a study: lost workers, killed processes, full disks, runs that raise or never end."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.studies import executors
from concio.studies.study_rows import Row
from study_functions import VARIABLES, deaf, dying, dying_once, formula, hanging, raising

HERE = Path(__file__).parents[2]
EXECUTORS = ["serial", "processes", "dask"]
RUNS = 24


def study(function: object, executor: str = "processes", **options: object) -> concio.StudyResult:
    """Return a study of the block's formula, or of what goes wrong instead, with two workers."""
    if executor != "serial":
        options["workers"] = 2
    return concio.study(
        function, VARIABLES, "multiplier", "monte-carlo", size=RUNS, seed=1, executor=executor, **options
    )


def strong(found: concio.StudyResult) -> np.ndarray:
    """Return which runs have a friction above 0.6: those in which something goes wrong."""
    return found.values("mu") > 0.6


def same_rows(one: concio.StudyResult, other: concio.StudyResult) -> bool:
    """Return whether two studies have the same rows, times apart."""

    def told(rows: tuple[Row, ...]) -> list[tuple[object, ...]]:
        return [(r.index, r.verdict, r.message, tuple(map(repr, r.outputs.values()))) for r in rows]

    return told(one.rows) == told(other.rows)


@pytest.mark.long
@pytest.mark.parametrize("executor", [*EXECUTORS[:2], pytest.param("dask", marks=pytest.mark.long)])
def test_rows_are_the_same_whatever_the_executor_and_a_run_that_raises_is_one(executor: str) -> None:
    found = study(raising, executor)
    assert same_rows(found, study(raising, "serial"))
    bad = strong(found)
    assert [row.verdict == "raised" for row in found.rows] == bad.tolist()
    assert "ZeroDivisionError: friction beyond belief" in found.failures[0].message
    assert 0 < bad.sum() < RUNS
    assert np.isnan(found.values("multiplier")).tolist() == bad.tolist()


@pytest.mark.long
@pytest.mark.parametrize("executor", EXECUTORS[:2])
def test_a_run_that_never_ends_is_a_row(executor: str) -> None:
    found = study(hanging, executor, time_limit=0.3)
    assert [row.verdict == "time_limit" for row in found.rows] == strong(found).tolist()
    assert "within 0.3 s" in found.failures[0].message


@pytest.mark.long
def test_a_run_that_hears_no_alarm_is_ended_with_its_process() -> None:
    few = concio.study(
        deaf, VARIABLES, "multiplier", np.array([[0.4, 0.3], [0.65, 0.3], [0.5, 0.3]]), workers=2, time_limit=0.5
    )
    assert [row.verdict for row in few.rows] == ["done", "time_limit", "done"]


@pytest.mark.long
def test_a_run_that_takes_its_worker_with_it_is_a_row() -> None:
    few = concio.study(
        dying, VARIABLES, "multiplier", np.array([[0.4, 0.3], [0.65, 0.3], [0.5, 0.3], [0.55, 0.3]]), workers=2
    )
    assert [row.verdict for row in few.rows] == ["done", "worker_lost", "done", "done"]


@pytest.mark.long
@pytest.mark.parametrize("executor", ["processes", pytest.param("dask", marks=pytest.mark.long)])
def test_a_lost_worker_loses_no_row(executor: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CONCIO_TEST_MARKS", str(tmp_path))
    table = np.array([[0.4, 0.3], [0.65, 0.3], [0.5, 0.3], [0.55, 0.25], [0.35, 0.3]])
    found = concio.study(dying_once, VARIABLES, "multiplier", table, executor=executor, workers=2)
    assert list(tmp_path.iterdir())  # a worker was lost
    assert [row.verdict for row in found.rows] == ["done"] * 5
    assert found.values("multiplier").tolist() == [0.3, 0.3, 0.3, 0.25, 0.3]


@pytest.mark.long  # rows are the same whatever the executor
def test_the_processes_of_a_pool_start_together() -> None:
    """One after the other, as many starts as there are workers passed before they all worked."""
    pool = executors._processes(2)
    try:
        executors._start(pool, 2)
        assert len(pool._processes) == 2
    finally:
        executors._end(pool)


SCRIPT = """
import sys
sys.path.insert(0, {tests!r})
from study_functions import VARIABLES, slow
import concio
concio.study(slow, VARIABLES, "multiplier", "monte-carlo", size=60, directory={directory!r})
"""


@pytest.mark.long
def test_a_killed_study_goes_on_and_repeats_nothing(tmp_path: Path) -> None:
    from study_functions import slow

    directory = tmp_path / "study"
    script = SCRIPT.format(tests=str(HERE), directory=str(directory))
    process = subprocess.Popen([sys.executable, "-c", script])
    rows = directory / "rows.jsonl"
    end = time.monotonic() + 60
    while (not rows.exists() or rows.read_bytes().count(b"\n") < 5) and time.monotonic() < end:
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    before = rows.read_bytes()
    kept = before.count(b"\n")
    assert 5 <= kept < 60
    with rows.open("ab") as file:
        file.write(b'{"index": 59, "verd')  # the line that was being written
    with pytest.raises(concio.InputError, match="holds a study already"):
        concio.study(slow, VARIABLES, "multiplier", "monte-carlo", size=60, directory=directory)
    found = concio.study(slow, VARIABLES, "multiplier", "monte-carlo", size=60, directory=directory, resume=True)
    assert rows.read_bytes().startswith(before[: before.rfind(b"\n") + 1])
    lines = [json.loads(line)["index"] for line in rows.read_text().splitlines()]
    assert sorted(lines) == list(range(60))  # nothing lost, nothing twice
    whole = concio.study(slow, VARIABLES, "multiplier", "monte-carlo", size=60)
    assert same_rows(found, whole)
    assert same_rows(concio.load_study(directory), whole)


def test_rows_of_another_study_are_not_mixed_in(tmp_path: Path) -> None:
    study(formula, "serial", directory=tmp_path / "s")
    for change in ({"seed": 2}, {"size": 25}, {"outputs": ["multiplier", "other"]}):
        given = {"sample": "monte-carlo", "size": RUNS, "seed": 1, "outputs": "multiplier", **change}
        with pytest.raises(concio.InputError, match="another study"):
            concio.study(formula, VARIABLES, directory=tmp_path / "s", resume=True, **given)
    with pytest.raises(concio.InputError, match="another study"):
        study(raising, "serial", directory=tmp_path / "s", resume=True)
    (tmp_path / "s" / "rows.jsonl").write_text('{"index": 0}\n')
    with pytest.raises(concio.InputError, match="line 1 is not a row"):
        study(formula, "serial", directory=tmp_path / "s", resume=True)


def test_files_of_others_stay(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    study(formula, "serial", directory=tmp_path)
    assert (tmp_path / "thesis.txt").read_text() == "mine"


FULL = """
import resource, sys
sys.path.insert(0, {tests!r})
resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))
from study_functions import VARIABLES, formula
import concio
try:
    concio.study(formula, VARIABLES, "multiplier", "monte-carlo", size=200, directory={directory!r})
except concio.ConcioError as error:
    print(type(error).__name__, error.exit_code, error)
"""


@pytest.mark.long
def test_a_full_disk_keeps_the_rows_there_are(tmp_path: Path) -> None:
    directory = tmp_path / "study"
    directory.mkdir()
    script = FULL.format(tests=str(HERE), directory=str(directory)).replace("size=200", "size=60")
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert said.startswith("StorageError 1")
    assert "rows are kept; make room, then resume" in said
    lines = (directory / "rows.jsonl").read_bytes()
    assert lines.endswith(b"\n")
    kept = lines.count(b"\n")
    assert 0 < kept < 60
    found = concio.study(formula, VARIABLES, "multiplier", "monte-carlo", size=60, directory=directory, resume=True)
    assert len(found) == 60


def test_a_study_can_be_stopped_and_resumed(tmp_path: Path) -> None:
    seen = []

    def stop(state: object) -> bool:
        seen.append(state)
        return len(seen) == 7

    part = study(formula, "serial", directory=tmp_path, progress=stop)
    assert len(part) == 7
    assert seen[-1].done == 7
    assert seen[-1].total == RUNS
    assert same_rows(study(formula, "serial", directory=tmp_path, resume=True), study(formula, "serial"))


def test_two_processes_do_not_write_one_study(tmp_path: Path) -> None:
    inner = []

    def again(_: object) -> bool:
        with pytest.raises(concio.InputError, match="another process"):
            study(formula, "serial", directory=tmp_path, resume=True)
        inner.append(1)
        return True

    study(formula, "serial", directory=tmp_path, progress=again)
    assert inner


@pytest.mark.long  # waits for a scheduler that never answers
def test_an_executor_that_is_none_is_told() -> None:
    with pytest.raises(concio.InputError, match="has no 'submit'"):
        study(formula, executor=3)  # type: ignore[arg-type]
    with pytest.raises(concio.InputError, match="no Dask scheduler answers"):
        concio.study(formula, VARIABLES, "multiplier", size=4, executor=f"tcp://127.0.0.1:{free_port()}")
    with pytest.raises(concio.ConcioError, match="cannot be handed"):
        concio.study(lambda row: formula(row), VARIABLES, "multiplier", size=4, workers=2)


def test_any_executor_of_the_standard_library_does() -> None:
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(3) as pool:
        found = concio.study(formula, VARIABLES, "multiplier", "monte-carlo", size=RUNS, seed=1, executor=pool)
    assert same_rows(found, study(formula, "serial"))


def free_port() -> int:
    """Return a port on this machine that nothing listens on."""
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[str]:
    """Start a Dask scheduler and two workers as processes of their own; give the address."""
    address = f"tcp://127.0.0.1:{free_port()}"
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")])}
    port = address.rsplit(":", 1)[1]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": env, "cwd": tmp_path}
    command = [sys.executable, "-m", "dask"]
    started = [
        subprocess.Popen(
            [*command, "scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard", "--no-jupyter"], **quiet
        )
    ]
    options = ["--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"]
    started += [subprocess.Popen([*command, "worker", address, *options], **quiet) for _ in range(2)]
    try:
        yield address
    finally:
        for process in reversed(started):
            process.terminate()
        for process in started:
            process.wait(timeout=20)


@pytest.mark.long
def test_a_scheduler_and_two_workers_of_their_own(scheduler: str) -> None:
    from distributed import Client

    with Client(scheduler, timeout="60s") as client:
        client.wait_for_workers(2, timeout=60)
        found = concio.study(
            formula, VARIABLES, "multiplier", "monte-carlo", size=RUNS, seed=1, executor=client, workers=2
        )
    assert same_rows(found, study(formula, "serial"))
    by_address = study(formula, executor=scheduler)
    assert same_rows(by_address, found)


@pytest.mark.long
def test_the_command_line(tmp_path: Path) -> None:
    text = """
[arch]
span = 1.89
ring = 0.11
voussoirs = 10
block = { kind = "rigid", unit_weight = 20 }
friction = 0.8
[study]
sample = "monte-carlo"
size = 8
outputs = "stands"
[[study.variables]]
name = "ring"
keys = "arch.ring"
low = 0.10
high = 0.12
"""
    file = tmp_path / "arch.toml"
    file.write_text(text)
    code, out, _ = run("study", file, "--out", tmp_path / "s", "--json")
    assert code == 0
    told = json.loads(out)
    assert told["runs"] == 8
    assert sum(told["verdicts"].values()) == 8
    assert (tmp_path / "s" / "report.html").read_text().count("<figure") >= 1
    assert (tmp_path / "s" / "table.csv").read_text().startswith("run,ring,stands,verdict")
    code, _, error = run("study", file, "--out", tmp_path / "s")
    assert code == 2
    assert "resume it" in error
    code, out, _ = run("study", file, "--out", tmp_path / "s", "--resume")
    assert code == 0
    assert "probability" in out
    file.write_text(text.replace("arch.ring", "arch.rnig"))
    code, _, error = run("study", file, "--out", tmp_path / "t")
    assert code == 2
    assert "did you mean 'ring'" in error
    assert not (tmp_path / "t").exists()


class Client:
    """A stand-in for a Dask client of some threads, whose executor makes each run at once."""

    def __init__(self, threads: dict[str, int]) -> None:
        self.threads, self.out, self.most = threads, 0, 0

    def nthreads(self) -> dict[str, int]:
        return self.threads

    def get_executor(self, *, pure: bool) -> Client:
        assert not pure  # a run that is tried again is no other one
        return self

    def submit(self, task: Callable[..., Row], *given: object) -> Future[Row]:
        client = self
        client.out += 1
        client.most = max(client.most, client.out)

        class Made(Future):  # type: ignore[type-arg]
            def result(self, timeout: float | None = None) -> Row:
                client.out -= 1
                return super().result(timeout)  # type: ignore[no-any-return]

        made = Made()
        made.set_result(task(*given))
        return made


@pytest.mark.parametrize(
    ("threads", "workers", "size"), [({"a": 4, "b": 2, "c": 1}, None, 3), ({}, None, 1), ({"a": 1}, 2, 2)]
)
def test_a_client_gets_as_many_runs_ahead_as_keep_its_workers_busy(
    threads: dict[str, int], workers: int | None, size: int
) -> None:
    client = Client(threads)
    given = {"size": RUNS, "seed": 1, "executor": client, "workers": workers}
    found = concio.study(formula, VARIABLES, "multiplier", "monte-carlo", **given)
    assert same_rows(found, study(formula, "serial"))
    assert client.most == executors.AHEAD * size
