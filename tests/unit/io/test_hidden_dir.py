"""Hidden directories: only what a run left is taken for left, and only what such a directory holds is removed."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from concio.io import hidden_dir
from concio.io.hidden_dir import FORGOTTEN, hidden_directory, hidden_name, is_hidden, is_left, remove


@pytest.mark.parametrize(
    ("name", "inside", "gone"),
    [
        (".concio-host-1.0", (), True),
        (".concio-host-1.0", ("new/", "old/", "list.json"), True),
        (".concio-host-1.0", ("new/", "photo.jpg"), False),
        (".concio-host-1.0", ("mine/",), False),
        ("results", (), False),
        ("results", ("new/", "old/", "list.json"), False),
        (".concio-host-1.0.bak", ("new/",), False),
    ],
)
def test_nothing_is_removed_that_may_be_somebodys(
    tmp_path: Path, name: str, inside: tuple[str, ...], gone: bool
) -> None:
    path = tmp_path / name
    path.mkdir()
    for part in inside:
        (path / part).mkdir() if part.endswith("/") else (path / part).write_text("kept")
    remove(path)
    assert path.exists() is not gone
    if not gone:
        assert {p.name for p in path.iterdir()} == {part.rstrip("/") for part in inside}
    remove(tmp_path / "nowhere")


def test_names_are_hidden_ones_and_never_the_same(tmp_path: Path) -> None:
    names = [hidden_name() for _ in range(5)]
    assert len(set(names)) == 5
    assert all(map(is_hidden, names))
    assert not any(
        map(is_hidden, ("new", ".concio", ".concio-host", "concio-host-1", ".concio-ho.st-1", ".concio-a-b"))
    )
    with hidden_directory(tmp_path / "made") as path:
        assert is_hidden(path.name)
        assert not list(path.iterdir())
        assert not is_left(path)
    assert is_left(path)  # its run is over, and has not removed it
    remove(path)
    assert not path.exists()


@pytest.mark.skipif(os.name != "posix", reason="processes are asked for on POSIX systems alone")
def test_what_a_run_that_is_over_left_is_told_from_what_one_still_has(tmp_path: Path) -> None:
    def directory(host: str, pid: int, old: float = 0.0) -> Path:
        path = tmp_path / f".concio-{host}-{pid}.7"
        path.mkdir()
        os.utime(path, (time.time() - old,) * 2)
        return path

    here, gone = hidden_dir._host(), 2**22 + 7  # beyond the largest number of a process
    assert is_left(directory(here, gone))
    assert not is_left(directory(here, os.getppid()))
    assert not is_left(directory("elsewhere", gone))
    assert is_left(directory("elsewhere", gone + 1, old=FORGOTTEN + 60))
    assert not is_left(directory("elsewhere", gone + 2, old=FORGOTTEN - 60))
    link = tmp_path / f".concio-{here}-{gone}.8"
    link.symlink_to(tmp_path, target_is_directory=True)
    assert not is_left(link)
    file = tmp_path / f".concio-{here}-{gone}.9"
    file.write_text("no directory")
    assert not is_left(file)
