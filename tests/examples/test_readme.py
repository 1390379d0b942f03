"""The README says what is true: its code runs, its numbers are those of today, its commands exist."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest
from typer.testing import CliRunner

import concio
from concio.cli.main import app

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_numbers_are_those_of_today(capsys: pytest.CaptureFixture[str]) -> None:
    script = runpy.run_path(str(ROOT / "docs" / "readme_numbers.py"))
    assert script["main"](["--check"]) == 0, capsys.readouterr().out


def test_the_python_runs() -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    names: dict[str, object] = {}
    exec(code, names)
    result = names["result"]
    assert isinstance(result, concio.Result)
    for name in re.findall(r"`result\.(\w+)`", README):
        assert getattr(result, name) is not None
    for name in re.findall(r"`concio\.(\w+)`", README):
        assert getattr(concio, name) is not None


def test_the_model_files_load() -> None:
    texts = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)
    assert texts
    for text in texts:
        assert concio.solve(concio.loads(text)).solved


def test_the_commands_exist() -> None:
    named = set(re.findall(r"^    concio (\w+)", README, re.MULTILINE))
    there = {command.name for command in app.registered_commands}
    assert named == there
    for name in named:
        assert CliRunner().invoke(app, [name, "--help"]).exit_code == 0


def test_the_make_targets_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"^    make (\w+)", README, re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE)
    assert "make test" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")
