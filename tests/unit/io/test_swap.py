"""A run that dies between any two steps of the file system, and runs side by side: every file is found again."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

import concio
from concio.errors import ConcioError, InputError
from concio.io.listing import CONTENTS
from concio.io.owned_dir import look_at, owned_directory, settle
from motion_models import standing
from samples import sample

STEPS = ("rename", "replace", "link", "unlink", "mkdir", "rmdir")
NAMES = ("a.txt", "b.txt", "c.txt", "f/a.png", "f/b.png", "f/g/c.png", "f", "a.txt/in", "deep/er/x")
MINE = ("thesis.txt", "f/mine.png", "deep/mine.txt", "own/x.txt")


@pytest.fixture(autouse=True)
def quick_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "fsync", lambda _: None)


class DiedError(BaseException):
    """Stands for the end of a process: nothing catches it, and nothing of the file system works any more."""


@contextmanager
def counted(monkeypatch: pytest.MonkeyPatch, fault: Callable[[int], None]) -> Iterator[None]:
    """Call ``fault`` with its number before every step of the file system."""
    steps = [0]

    def patched(real: Callable[..., Any]) -> Callable[..., Any]:
        def step(*args: Any, **kwargs: Any) -> Any:
            steps[0] += 1
            fault(steps[0])
            return real(*args, **kwargs)

        return step

    with monkeypatch.context() as patch:
        for name in STEPS:
            patch.setattr(os, name, patched(getattr(os, name)))
        yield


def fill(place: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = place / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def write(place: Path, files: dict[str, str]) -> None:
    with owned_directory(place) as fresh:
        fill(fresh, files)


def tree(place: Path) -> dict[str, str]:
    """Return all files of a directory but the list, without hidden directories."""
    return {
        p.relative_to(place).as_posix(): p.read_text()
        for p in place.rglob("*")
        if p.is_file() and p.name != CONTENTS and not p.relative_to(place).parts[0].startswith(".concio-")
    }


def drawn(rng: random.Random, text: str, most: int = 6) -> dict[str, str]:
    """Return files of a run, no name of which is the folder of another; some have the same content in every run."""
    found: dict[str, str] = {}
    for name in rng.sample(NAMES, rng.randint(1, most)):
        if not any(n.startswith(name + "/") or name.startswith(n + "/") for n in found):
            found[name] = "the same" if rng.random() < 0.3 else f"{text} {name}"
    return found


def users(rng: random.Random, *runs: dict[str, str]) -> dict[str, str]:
    """Return files of the user's that are in the way of no run."""
    names = [n for run in runs for n in run]
    return {n: "mine" for n in rng.sample(MINE, 2) if not any(n.startswith(name + "/") for name in names)}


@pytest.mark.parametrize("seed", range(sample(3, 12, 60)))
def test_a_run_that_dies_at_any_step_leaves_one_whole_result(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = random.Random(seed)
    first, second, third = (drawn(rng, text) for text in ("first", "second", "third"))
    mine = users(rng, first, second, third)
    begun = seed % 4 > 0
    for k in range(1, 500):
        place = tmp_path / str(k)
        if begun:
            write(place, first)
            fill(place, mine)

        def die(step: int, last: int = k) -> None:
            if step >= last:
                raise DiedError

        died = False
        with counted(monkeypatch, die):
            try:
                write(place, second)
            except DiedError:
                died = True
        place.mkdir(exist_ok=True)
        kept = mine if begun else {}
        assert {n: tree(place).get(n) for n in kept} == kept
        assert set(look_at(place).kept) == set(kept), "a later run accepts it, and knows what is the user's"
        settle(place)
        whole = [{**kept, **run} for run in (first if begun else {}, second)]
        if begun or (place / CONTENTS).exists():
            assert tree(place) in whole, f"step {k}"
        write(place, third)
        assert tree(place) == {**kept, **third}
        assert [p.name for p in place.iterdir() if p.name.startswith(".")] == []
        if not died:
            break
    else:
        pytest.fail("it never ended")
    assert k > 5


@pytest.mark.parametrize("seed", range(sample(1, 8, 30)))
@pytest.mark.parametrize("kind", ["once", "from then on"])
def test_a_fault_at_any_step_leaves_what_was_there(
    seed: int, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = random.Random(1000 + seed)
    first, second = drawn(rng, "first", 3), drawn(rng, "second", 3)
    mine = users(rng, first, second)
    for k in range(1, 500):
        place = tmp_path / str(k)
        write(place, first)
        fill(place, mine)

        def fail(step: int, at: int = k) -> None:
            if step == at or (step > at and kind != "once"):
                raise OSError(28, "No space left on device")

        failed = False
        with counted(monkeypatch, fail):
            try:
                write(place, second)
            except ConcioError:
                failed = True
        if kind == "once" and failed:
            assert tree(place) == {**mine, **first}
        settle(place)
        assert tree(place) in ({**mine, **first}, {**mine, **second})
        write(place, second)
        assert tree(place) == {**mine, **second}
        if not failed and k > 25:
            break


def test_what_the_user_puts_in_the_way_meanwhile_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    for k in range(1, 40):
        place = tmp_path / str(k)
        write(place, {"a.txt": "1", "b.txt": "1"})

        def meddle(step: int, at: int = k, place: Path = place) -> None:
            if step == at:
                with suppress(FileExistsError), (place / "c.txt").open("x") as file:
                    file.write("mine")

        with counted(monkeypatch, meddle):
            try:
                write(place, {"a.txt": "2", "b.txt": "2", "c.txt": "2"})
            except InputError as error:
                told.append(str(error))
        old, new = {"a.txt": "1", "b.txt": "1", "c.txt": "mine"}, {"a.txt": "2", "b.txt": "2", "c.txt": "2"}
        assert tree(place) in (old, new)
    assert told
    assert all("'c.txt' is in the way" in text for text in told)


def test_what_the_user_changes_in_the_last_moment_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told = []
    for k in range(1, 30):
        place = tmp_path / str(k)
        write(place, {"a.txt": "1", "b.txt": "1"})

        def meddle(step: int, at: int = k, place: Path = place) -> None:
            if step == at and tree(place) == {"a.txt": "1", "b.txt": "1"}:
                (place / "a.txt").write_text("what I know better")

        with counted(monkeypatch, meddle):
            try:
                write(place, {"a.txt": "2", "b.txt": "2"})
            except InputError as error:
                told.append(str(error))
                assert tree(place) == {"a.txt": "what I know better", "b.txt": "1"}
            else:
                assert tree(place) == {"a.txt": "2", "b.txt": "2"}
    assert any("was changed while the run put its files there" in text for text in told)


def test_runs_side_by_side_leave_the_files_of_one(tmp_path: Path) -> None:
    place, faults = tmp_path / "r", []
    write(place, {"a.txt": "0", "zero/x.txt": "0"})
    fill(place, {"thesis.txt": "mine", "zero/mine.txt": "mine"})
    runs = [{"a.txt": f"{i}", f"only{i}.txt": f"{i}", f"f{i}/x": f"{i}"} for i in range(4)]

    def work(i: int) -> None:
        try:
            for _ in range(6):
                write(place, runs[i])
        except BaseException as error:
            faults.append(error)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert faults == []
    mine = {"thesis.txt": "mine", "zero/mine.txt": "mine"}
    assert tree(place) in [{**mine, **run} for run in runs]
    assert [p.name for p in place.iterdir() if p.name.startswith(".")] == []
    assert set(look_at(place).kept) == set(mine)


@pytest.mark.long
@pytest.mark.skipif(os.name != "posix", reason="kills processes")
def test_processes_side_by_side_some_of_which_are_killed(tmp_path: Path) -> None:
    place = tmp_path / "r"
    write(place, {"a.txt": "before"})
    fill(place, {"thesis.txt": "mine"})
    code = (
        "import os, sys\nfrom concio.io.owned_dir import owned_directory\n"
        "place, i, last = sys.argv[1], sys.argv[2], int(sys.argv[3])\n"
        "steps, rename = [0], os.rename\n"
        "def step(*args, **kwargs):\n"
        "    steps[0] += 1\n"
        "    if steps[0] == last:\n"
        "        os.kill(os.getpid(), 9)\n"
        "    return rename(*args, **kwargs)\n"
        "os.rename = step\n"
        "for k in range(8):\n"
        "    with owned_directory(place) as fresh:\n"
        "        for name in ('a.txt', 'b.txt', 'only' + i):\n"
        "            (fresh / name).write_text(i)\n"
    )
    kills = (2, 5, 0)
    ran = [subprocess.Popen([sys.executable, "-c", code, str(place), str(i), str(k)]) for i, k in enumerate(kills)]
    codes = [process.wait(timeout=60) for process in ran]
    assert all(code in (killed, 0) for code, killed in zip(codes, (-9, -9, 0), strict=True)), "killed, or done before"
    settle(place)
    found = tree(place)
    assert found.pop("thesis.txt") == "mine"
    assert found in [{"a.txt": i, "b.txt": i, f"only{i}": i} for i in "012"]
    write(place, {"a.txt": "after"})
    assert tree(place) == {"a.txt": "after", "thesis.txt": "mine"}


@pytest.mark.long
def test_a_motion_is_read_whole_after_a_run_died_at_any_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    motions = [concio.push(standing(0.2, 1.0), step=0.1, until=until) for until in (0.05, 0.1)]

    def put(place: Path, which: int) -> None:
        with owned_directory(place) as folder:
            concio.save_motion(motions[which], folder / "motion.npz")
            (folder / ("old.txt", "new.txt")[which]).write_text("beside it")

    ended: list[int] = []
    for k in range(1, 100):
        place, died = tmp_path / str(k), False
        put(place, 0)

        def die(step: int, last: int = k) -> None:
            if step >= last:
                raise DiedError

        with counted(monkeypatch, die):
            try:
                put(place, 1)
            except DiedError:
                died = True
        found = concio.load_motion(place / "motion.npz")
        ended.append([m.until for m in motions].index(found.until))
        beside = [name for name in ("old.txt", "new.txt") if (place / name).exists()]
        assert beside == [("old.txt", "new.txt")[ended[-1]]], f"step {k}: files of one run"
        if not died:
            break
    assert set(ended) == {0, 1}
    assert len(ended) > 5
