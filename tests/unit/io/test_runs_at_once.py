"""Two runs that write into one directory at the same time: each leaves a whole result, or says that it did not."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from pillars import pillar, sideways
from samples import sample


@pytest.mark.long  # two processes of their own
@pytest.mark.parametrize("there", sample([True], [True], [False, True]))
def test_two_runs_into_one_directory_leave_one_whole_result(there: bool, tmp_path: Path) -> None:
    loads = {"first": 0.05, "second": 0.1}
    for name, load in loads.items():
        (tmp_path / f"{name}.toml").write_text(f'title = "{name}"\n' + pillar(sideways(load)))
    command = [sys.executable, "-m", "concio", "run"]
    if there:
        subprocess.run([*command, "first.toml", "--out", "out", "--quiet"], cwd=tmp_path, check=True)
    running = [
        subprocess.Popen([*command, f"{name}.toml", "--out", "out"], cwd=tmp_path, text=True,
                         stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for name in loads
    ]  # fmt: skip
    ended = [(p, *p.communicate(timeout=120)) for p in running]
    codes = [p.returncode for p, _, _ in ended]
    assert set(codes) <= {0, 2}, ended
    assert 0 in codes, ended
    for process, out, err in ended:
        assert "Traceback" not in out + err
        assert (process.returncode == 2) == err.startswith("Error: "), (out, err)
    written = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert written["status"] == "solved"
    report = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    (name,) = [n for n in loads if f"<title>{n}" in report or f">{n}<" in report]
    assert f"live ({12.8 * loads[name]:.4g} kN)" in written["sentence"], "summary and report are of one run"
    assert f'title = "{name}"' in (tmp_path / "out" / "model.toml").read_text()
    saved = [p.name for p in tmp_path.iterdir()]
    assert sorted(saved) == ["first.toml", "out", "second.toml"], "nothing half written stays beside it"
    again = subprocess.run([*command, f"{name}.toml", "--out", "out", "--quiet"], cwd=tmp_path, check=False)
    assert again.returncode == 0, "a later run accepts the directory"
