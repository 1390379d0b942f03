"""Standard output closed, full or broken off: one message, exit code 2, no traceback; and ``python -m concio``."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from samples import sample

pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs a shell")

SMALL = "[panel]\ncourses = 1\nblocks = 2\ntop_pressure = 10\nelements_per_block = [2, 1]\n"


def shell(tmp_path: Path, command: str) -> subprocess.CompletedProcess[str]:
    """Run a command line in which CONCIO stands for ``python -m concio``."""
    (tmp_path / "m.toml").write_text(SMALL)
    text = command.replace("CONCIO", f"{sys.executable} -m concio")
    return subprocess.run(["sh", "-c", text], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)


def test_python_m_concio(tmp_path: Path) -> None:
    found = shell(tmp_path, "CONCIO --version")
    assert (found.returncode, found.stderr) == (0, "")
    assert found.stdout.startswith("concio ")


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("CONCIO check m.toml >&-", "standard output: it is closed"),
        pytest.param("CONCIO run m.toml >/dev/full", "cannot be written to: No space left", marks=pytest.mark.long),
        pytest.param("CONCIO check m.toml --json >/dev/full", "to: No space left", marks=pytest.mark.long),
        ("CONCIO check no.toml --json >/dev/full", "no.toml: there is no such file"),
        ("CONCIO --help >/dev/full", "standard output: cannot be written to"),
    ],
)
def test_output_that_cannot_be_written_is_one_message(tmp_path: Path, command: str, said: str) -> None:
    found = shell(tmp_path, command)
    assert found.returncode == 2
    assert said in found.stderr
    assert found.stderr.count("Error") == 1
    assert "Traceback" not in found.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["m.toml"]


@pytest.mark.long
def test_nothing_is_written_into_files_that_got_the_number_of_a_closed_stream(tmp_path: Path) -> None:
    found = shell(tmp_path, "CONCIO run m.toml --quiet --out r --no-figures >&- 2>&- <&-")
    assert found.returncode == 0
    assert (tmp_path / "m.toml").read_text() == SMALL
    assert (tmp_path / "r" / "summary.json").read_text().startswith("{")


@pytest.mark.long
def test_a_reader_that_has_gone_is_no_error(tmp_path: Path) -> None:
    found = shell(tmp_path, "CONCIO schema | head -1")
    assert (found.returncode, found.stdout, found.stderr) == (0, "{\n", "")


@pytest.mark.long
@pytest.mark.parametrize("title", ["\U0001f9f1 wall", "\u77f3\u9020"][: sample(1, 2)])
def test_letters_that_the_font_lacks_are_told_once(title: str, tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text(f'title = "{title}"\n[column]\nwidth = 1.0\nheight = 1.0\nblocks = 1\n', encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "concio", "check", str(path), "--out", str(tmp_path / "p.png")],
        capture_output=True, text=True, encoding="utf-8", check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0
    assert "Glyph" not in done.stderr
    assert done.stderr.count("has no letter for") == 1
