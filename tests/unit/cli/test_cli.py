"""The command line: what it prints where, its exit codes, and that no mistake of a user ends in a traceback."""

from __future__ import annotations

import errno
import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import typer

import concio
from commands import run
from concio.cli.options import factors_of
from concio.cli.outcome import fail
from concio.cli.run_command import where_written
from concio.problem.solution import Progress

SMALL = "[panel]\ncourses = 1\nblocks = 2\ntop_pressure = 10\nelements_per_block = [2, 1]\n"
SLIDES = "[panel]\nside_walls = false\nfriction = 0.5\nunit_weight = 20\nhorizontal = 1.0\ncourses = 1\n"
KEYS = {
    "status", "method", "bodies", "contacts", "unknowns", "certificate", "iterations", "seconds", "max_settlement",
    "reactions",
}  # fmt: skip


@pytest.fixture
def panel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A small panel in a directory of its own, which is the working directory."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "panel.toml"
    path.write_text(SMALL)
    return path


def test_run_says_what_was_found(panel: Path) -> None:
    code, out, err = run("run", panel)
    assert code == 0
    assert err == ""
    assert "In equilibrium" in out
    assert "settlement" in out
    assert "base" in out
    assert not [p for p in panel.parent.iterdir() if p != panel], "nothing is written unless it is asked for"


def test_json_is_one_object_and_nothing_else(panel: Path) -> None:
    code, out, err = run("run", panel, "--json")
    assert code == 0
    assert err == ""
    data = json.loads(out)
    assert set(data) >= KEYS
    assert data["status"] == "solved"
    assert set(data["certificate"]) == {
        "equilibrium", "penetration", "cone", "slip_direction", "complementarity", "worst",
    }  # fmt: skip
    assert set(data["seconds"]) == {"total", "assemble", "solve"}
    assert data["certificate"]["worst"] <= 1e-10
    carried = sum(force[1] for force in data["reactions"].values())
    assert carried == pytest.approx(10 * 0.4 * 0.1, rel=1e-9)  # pressure x width x thickness


def test_quiet_prints_nothing(panel: Path) -> None:
    assert run("run", panel, "--quiet") == (0, "", "")


def test_load_factors_scale_the_answer(panel: Path) -> None:
    one = json.loads(run("run", panel, "--json")[1])
    two = json.loads(run("run", panel, "--json", "--factor", "top=2")[1])
    assert two["max_settlement"] == pytest.approx(2 * one["max_settlement"], rel=1e-9)
    code, _, err = run("run", panel, "--factor", "snow=2")
    assert code == 2
    assert "no load group 'snow'" in err
    assert run("run", panel, "--factor", "top")[0] == 2
    assert run("run", panel, "--factor", "top=two")[0] == 2
    assert factors_of(["a=1", "b = 2.5"]) == {"a": 1.0, "b": 2.5}


@pytest.mark.long
def test_out_holds_summary_report_and_figures(panel: Path) -> None:
    code, out, _ = run("run", panel, "--out", "result")
    assert code == 0
    place = panel.parent / "result"
    assert {"summary.json", "report.html", "figures"} <= {p.name for p in place.iterdir()}
    assert "report.html" in out
    assert {p.name for p in panel.parent.iterdir()} == {"panel.toml", "result"}
    data = json.loads((place / "summary.json").read_text())
    assert data["status"] == "solved"
    code, out, _ = run("view", "result", "--no-open")
    assert (code, out.strip()) == (0, str(Path("result") / "report.html"))


@pytest.mark.usefixtures("blank_figures")
def test_a_result_is_replaced_and_anything_else_is_not(panel: Path) -> None:
    assert run("run", panel, "--out", "result", "--no-figures")[0] == 0
    before = (panel.parent / "result" / "result.json").stat().st_mtime_ns
    (panel.parent / "result" / "mine").write_text("mine")
    code, _, err = run("run", panel, "--out", "result", "--no-figures")
    assert (code, "they stay: mine" in err) == (0, True)
    assert (panel.parent / "result" / "mine").read_text() == "mine"
    assert (panel.parent / "result" / "result.json").stat().st_mtime_ns > before
    letters = panel.parent / "letters"
    letters.mkdir()
    (letters / "dear.txt").write_text("dear")
    code, _, err = run("run", panel, "--out", letters)
    assert code == 2
    assert "holds other things" in err
    assert [p.name for p in letters.iterdir()] == ["dear.txt"]
    code, _, err = run("run", panel, "--out", panel)
    assert code == 2
    assert "this is a file" in err


def test_where_written_names_the_report_first() -> None:
    paths = [Path("r/summary.json"), Path("r/figures/a.png"), Path("r/figures/a.svg"), Path("r/report.html")]
    lines = where_written(paths)
    assert "report.html" in lines[0]
    assert lines[1].endswith(": a")
    assert where_written([]) == []


def test_collapse_is_told_and_proved(tmp_path: Path) -> None:
    path = tmp_path / "slides.toml"
    path.write_text(SLIDES)
    code, out, err = run("run", path)
    assert code == 3
    assert err == ""
    assert "No equilibrium is possible" in out
    assert "moves        'c1-b1'" in out
    code, out, _ = run("run", path, "--json")
    assert code == 3
    assert json.loads(out)["status"] == "no_equilibrium"


def test_a_solver_that_stops_has_an_exit_code_of_its_own(panel: Path) -> None:
    panel.write_text(SMALL.replace("courses = 1", "courses = 3"))
    code, out, _ = run("run", panel, "--method", "penalty", "--json")
    data = json.loads(out)
    assert (code == 0) == (data["status"] == "solved")
    assert code in (0, 4)


BAD = {
    "negative modulus": "[panel]\nblock.E = -1",
    "zero modulus": "[panel]\nblock.E = 0",
    "incompressible": "[panel]\nplane = 'strain'\nblock = { E = 1e5, nu = 0.5 }",
    "negative friction": "[panel]\nfriction = -1",
    "zero courses": "[panel]\ncourses = 0",
    "unknown key": "[panel]\ncourse = 1",
    "wrong unit": "[panel]\njoint = '20 kN'",
    "NaN": "[panel]\ntop_pressure = nan",
    "open polygon": "[joints.j]\nfriction=1\n[materials.m]\nE=1\n[[blocks]]\nname='a'\nmaterial='m'\n"
    "outline=[[0,0],[1,1],[1,0],[0,1]]",
    "two vertices": "[joints.j]\nfriction=1\n[materials.m]\nE=1\n[[blocks]]\nname='a'\nmaterial='m'\n"
    "outline=[[0,0],[1,1]]",
    "overlapping blocks": "[column]\nwidth=1\nheight=1\nblocks=1\n[[blocks]]\nname='a'\nrectangle=[[0,0.5],[1,1.5]]",
    "no support": "[joints.j]\nfriction=1\n[materials.m]\nE=1\n[[blocks]]\nname='a'\nmaterial='m'\n"
    "rectangle=[[0,0],[1,1]]\n[[loads]]\nkind='weight'\nvalue=[0,-1]",
    "everything fixed": "[joints.j]\nfriction=1\n[[blocks]]\nname='a'\nkind='fixed'\nrectangle=[[0,0],[1,1]]",
    "nothing holds it": "[panel]\nbase = 'none'\nside_walls = false",
    "load beside the wall": "[panel]\n[[loads]]\nkind='pressure'\nvalue=1\nedge=[[9,0],[9,1]]",
    "point load beside the block": "[column]\nwidth=1\nheight=1\nblocks=1\n[[loads]]\nkind='point'\nvalue=[1,0]\n"
    "bodies=['b01']\nat=[5,5]",
    "support beside the block": "[column]\nwidth=1\nheight=1\nblocks=1\n[[supports]]\nname='s'\nbody='b01'\n"
    "edge=[[5,5],[6,5]]",
    "tie of no length": "[column]\nwidth=1\nheight=1\nblocks=1\n[[ties]]\nname='t'\nbody_a='b01'\nat_a=[0,0.5]\n"
    "at_b=[0,0.5]\nstiffness=1",
    "syntax": "[panel",
    "empty": "",
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_message_and_exit_code_2(tmp_path: Path, case: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(BAD[case])
    for command in ("run", "check"):
        code, out, err = run(command, path, "--json")
        assert code == 2, (command, out, err)
        assert err.startswith("Error: ")
        assert err.count("Error: ") == 1
        assert "Traceback" not in out + err
        told = json.loads(out)
        assert (told["status"], told["exit_code"]) == ("error", 2)
        assert told["what"] in err


def test_missing_and_unreadable_files(tmp_path: Path) -> None:
    code, _, err = run("run", tmp_path / "no.toml")
    assert code == 2
    assert "no such file" in err
    assert run("run", tmp_path)[0] == 2
    (tmp_path / "latin.toml").write_bytes("# größe".encode("latin-1"))
    assert run("check", tmp_path / "latin.toml")[0] == 2
    assert run("run", tmp_path / "no.toml", "--method", "magic")[0] == 2


def test_unknown_method_names_those_there_are(panel: Path) -> None:
    code, _, err = run("run", panel, "--method", "magic")
    assert code == 2
    assert "interior-point" in err


@pytest.mark.parametrize("kind", ["panel", "wall", "arch", "column", "blocks"])
def test_new_files_can_be_checked_and_solved(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    code, out, _ = run("new", kind)
    assert code == 0
    assert f"{kind}.toml" in out
    before = (tmp_path / f"{kind}.toml").read_bytes()
    code, _, err = run("new", kind)
    assert code == 2
    assert "--force" in err
    assert (tmp_path / f"{kind}.toml").read_bytes() == before
    (tmp_path / f"{kind}.toml").write_text("mine")
    assert run("new", kind, "--force")[0] == 0
    assert (tmp_path / f"{kind}.toml").read_bytes() == before
    code, out, err = run("check", f"{kind}.toml")
    assert (code, err) == (0, "")
    assert "no overlaps and no near misses" in out
    code, out, _ = run("run", f"{kind}.toml", "--json")
    assert json.loads(out)["status"] == "solved"
    assert code == 0


def test_check_reports_what_detection_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "near.toml"
    text = "[column]\nwidth=1\nheight=1\nblocks=1\n[[blocks]]\nname='floating'\nrectangle=[[-0.5,1.001],[0.5,2]]\n"
    path.write_text(text)
    code, out, err = run("check", path, "--out", "near.png")
    assert (code, err) == (0, "")
    assert "near miss" in out
    assert "gap of 1 mm" in out
    assert (tmp_path / "near.png").read_bytes()[:4] == b"\x89PNG"
    data = json.loads(run("check", path, "--json")[1])
    assert data["status"] == "ok"
    assert len(data["near_misses"]) == 1
    path.write_text(text.replace("1.001", "0.9"))
    code, out, err = run("check", path)
    assert code == 2
    assert err.startswith("Error: 'b01' and 'floating' overlap at ")
    assert (out + err).count("overlap at ") == 1, "the error tells it, the list above need not"
    assert "no overlaps" not in out
    path.write_text(text.replace("1.001", "0.9") + "[[blocks]]\nname='third'\nrectangle=[[0.2,1.9],[0.4,2.5]]\n")
    code, out, err = run("check", path)
    assert "and 1 more overlap" in err
    assert sorted((out.count("overlap at "), err.count("overlap at "))) == [1, 1]
    code, _, err = run("check", path, "--out", "near.txt")
    assert code == 2
    assert "'.txt'" in err


def test_run_tells_of_joints_that_were_nearly_made(tmp_path: Path) -> None:
    path = tmp_path / "near.toml"
    text = "[column]\nwidth=1\nheight=1\nblocks=1\n[[blocks]]\nname='floating'\nrectangle=[[-0.5,1.001],[0.5,2]]\n"
    path.write_text(text)
    code, out, _ = run("run", path)
    assert "attention    1 joint almost made, but not made or made only in part: 'b01' and 'floating' at" in out
    assert "with the joints that were made" in out
    path.write_text(text.replace("1.001", "1.0"))
    code, out, _ = run("run", path)
    assert code == 0
    assert "attention" not in out


def test_run_gives_the_force_in_a_tie(tmp_path: Path) -> None:
    path = tmp_path / "hangs.toml"
    path.write_text(
        "[materials.stone]\nkind='rigid'\nunit_weight=25\n[joints.smooth]\nfriction=0\n"
        "[[blocks]]\nname='hanging'\nrectangle=[[0,0],[1,1]]\nmaterial='stone'\n"
        "[[blocks]]\nname='wall'\nrectangle=[[-1,0],[0,1]]\nkind='fixed'\n"
        "[[loads]]\nkind='weight'\nvalue=[0,-1]\n"
        "[[supports]]\nname='rail'\nbody='hanging'\nedge=[[1,0],[1,1]]\ndirections='x'\n"
        "[[ties]]\nname='chain'\nbody_a='hanging'\nat_a=[0.5,1.0]\nat_b=[0.5,3.0]\nstiffness='1 MN/m'\n"
    )
    code, out, err = run("run", path)
    assert (code, err) == (0, "")
    assert "  ties         chain  25 kN of tension" in out
    assert "  1 body, 1 joint, " in out


def test_run_tells_of_blocks_that_a_drawing_lost(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new(units=6)
    for x, layer, close in ((0.0, "stone", True), (2.0, "stone", False)):
        drawing.modelspace().add_lwpolyline(
            [(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)], close=close, dxfattribs={"layer": layer}
        )
    ground = [(-1, -1), (4, -1), (4, 0), (-1, 0)]
    drawing.modelspace().add_lwpolyline(ground, close=True, dxfattribs={"layer": "CONCIO_FIXED"})
    drawing.saveas(tmp_path / "open.dxf")
    path = tmp_path / "open.toml"
    path.write_text(
        "blocks_file = 'open.dxf'\n[drawing]\non_fault = 'skip'\n[materials.stone]\nE = '5 GPa'\nunit_weight = 20\n"
    )
    code, out, err = run("run", path)
    assert (code, err) == (0, "")
    assert "attention    the drawing: 1 fault repaired or left out, first: " in out


def test_faults_of_a_drawing_and_the_remedy_are_printed_without_a_gap(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit):
        fail({"what": "two faults\n  - one\n  - two\n", "hint": "mend them"}, 2, False)
    assert capsys.readouterr().err == "Error: two faults\n  - one\n  - two\n  -> mend them\n"


def test_check_counts_what_a_file_holds(tmp_path: Path) -> None:
    path = tmp_path / "c.toml"
    path.write_text("[column]\nwidth=0.5\nheight=2\nblocks=4\ntop_force=10\nblock={E='5 GPa', unit_weight=20}\n")
    out = run("check", path)[1]
    assert "4 elastic" in out
    assert "joints       4 with law 'joint', 2 m in all" in out
    assert "load group   top: 1 point, 0 kN along x, -10 kN along y in all" in out
    assert "load group   dead: 1 weight, 0 kN along x, -20 kN along y in all" in out


def test_compare_prints_a_table(panel: Path) -> None:
    code, out, _ = run("compare", panel, "--methods", "uzawa,panagiotopoulos")
    assert code == 0
    assert "uzawa" in out
    assert "interior-point" in out
    data = json.loads(run("compare", panel, "--methods", "uzawa", "--json")[1])
    assert {row["method"] for row in data["rows"]} == {"interior-point", "uzawa"}
    assert run("compare", panel, "--methods", "magic")[0] == 2


def test_schema_is_json() -> None:
    code, out, _ = run("schema")
    assert code == 0
    assert "panel" in json.loads(out)["properties"]


def test_view_of_nothing(tmp_path: Path) -> None:
    code, _, err = run("view", tmp_path, "--no-open")
    assert code == 2
    assert "report.html" in err


def test_version_and_help() -> None:
    assert run("--version") == (0, f"concio {concio.__version__}\n", "")
    for command in ("new", "check", "run", "compare", "view", "schema"):
        code, out, _ = run(command, "--help")
        assert code == 0
        assert "Example: concio" in out
    assert run("run")[0] == 2
    assert run("fly")[0] == 2


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (KeyboardInterrupt(), 130, "stopped on request"),
        (MemoryError(), 4, "does not fit into memory"),
        (OSError(errno.ENOSPC, "No space left on device"), 1, "the disk is full"),
        (ValueError("surprise"), 1, "this is a bug in concio: ValueError: surprise"),
    ],
)
def test_accidents(panel: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException, code: int, said: str) -> None:
    def fall(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("concio.analysis.step.solve", fall)
    found, out, err = run("run", panel, "--json")
    assert found == code
    assert said in err
    assert json.loads(out)["exit_code"] == code
    assert "Traceback" not in err


def test_a_limit_that_is_stopped_shows_what_was_found_and_no_verdict(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    file = tmp_path / "column.toml"
    text = '[column]\nwidth = 0.4\nheight = 1.6\nblocks = 4\nblock = "rigid"\nhorizontal = 1.0\n'
    file.write_text(text, encoding="utf-8")
    monkeypatch.setattr("concio.analysis.limit.smallest_friction", stop)
    code, out, err = run("limit", file)
    assert (code, "stopped on request" in err) == (130, True)
    assert out.startswith("Stopped: found until then, without a verdict:\n  associated bound     0.25 ")
    assert "by default" not in out


@pytest.mark.usefixtures("blank_figures")
def test_a_full_disk_leaves_what_was_there(panel: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("run", panel, "--out", "result", "--no-figures")[0] == 0
    before = sorted((p.name, p.read_bytes()) for p in Path("result").iterdir() if p.is_file())

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("concio.io.result_dir.save_result", full)
    code, _, err = run("run", panel, "--out", "result", "--no-figures")
    assert code == 1
    assert "No space left" in err
    assert sorted((p.name, p.read_bytes()) for p in Path("result").iterdir() if p.is_file()) == before
    assert {p.name for p in Path().iterdir()} == {"panel.toml", "result"}


def test_where_there_is_no_terminal_a_line_from_time_to_time_says_what_is_done(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from concio.cli import progress

    clock = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: clock[0])
    with progress.progress_bar(shown=True) as callback:
        assert callback is not None
        for second in range(25):
            clock[0] = 100.0 + second
            callback(Progress("assessment", second, 1.0 - second / 40, message=f"part {second}"))
    with progress.progress_bar(shown=False) as nothing:
        assert nothing is None
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        "so far:  at work              assessment, part 10, about 30 s left",
        "so far:  at work              assessment, part 20, about 20 s left",
    ]


def test_a_run_says_when_its_report_is_being_written(panel: Path) -> None:
    told = "the report and its figures are written to result"
    assert told in run("run", panel, "--out", "result", "--no-figures")[2]


def test_the_bar_moves_forward_only(monkeypatch: pytest.MonkeyPatch) -> None:
    from concio.cli import progress

    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    seen: list[float] = []
    monkeypatch.setattr("rich.progress.Progress.update", lambda self, task, **k: seen.append(k["completed"]))
    with progress.progress_bar(shown=True) as callback:
        assert callback is not None
        for k, residual in enumerate((1.0, 1e-3, 1e-1, float("nan"), 0.0, 1e-9, 1e-14)):
            callback(Progress("interior-point", k, residual))
    assert seen == sorted(seen)
    assert seen[0] == 0.0
    assert seen[-1] == 1.0


def test_the_bar_tells_the_time_left_of_long_runs() -> None:
    from concio.cli.progress import TimeLeft

    left = TimeLeft()
    assert left.after(0.0, 100.0) == ""  # nothing known
    assert left.after(0.1, 102.0) == ""  # too soon to tell
    assert left.after(0.009, 120.0) == ""  # too little to tell
    assert left.after(0.25, 120.0) == ", about 60 s left"
    assert left.after(0.5, 400.0) == ", about 5 min left"
    assert left.after(0.5, 100.0 + 7200.0) == ", about 2.0 h left"
    assert left.after(1.0, 9000.0) == ""


@pytest.mark.parametrize("words", [["run", "--help"], ["limit", "--help"], ["run"], ["rum"], ["--help"], []])
def test_the_command_that_is_asked_for_alone_says_what_it_says_among_all(words: list[str]) -> None:
    from typer.testing import CliRunner

    from concio.cli.main import app, asked_of

    alone, among = (CliRunner().invoke(line, words) for line in (asked_of(words), app))
    assert (alone.exit_code, alone.output) == (among.exit_code, among.output)
    every = len(app.registered_commands)
    assert every >= 20
    assert len(asked_of(words).registered_commands) == (1 if words[:1] in (["run"], ["limit"]) else every)


WAITING = """
import signal, time
import concio.analysis.step
from concio.cli.main import main

def wait(*_, **__):
    print("solving", flush=True)
    time.sleep(60)

signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background of a shell
concio.analysis.step.solve = wait
main()
"""


@pytest.mark.long
def test_a_reader_that_has_gone_changes_no_exit_code(panel: Path) -> None:
    """A command whose output nobody reads on ends as it would, with its verdict and its files."""
    panel.write_text(SLIDES)
    command = [sys.executable, "-m", "concio", "run", str(panel), "--out", "result"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.stderr is not None
        err = process.stderr.read()
    said = [line for line in err.splitlines() if not line.startswith("so far:")]
    assert (process.returncode, said) == (3, [])
    assert (panel.parent / "result" / "summary.json").exists()


@pytest.mark.long
def test_interrupting_a_running_command(panel: Path) -> None:
    command = [sys.executable, "-c", WAITING, "run", str(panel), "--out", "result"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "solving\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, "")
    assert err.startswith("Error: stopped on request")
    assert "Traceback" not in err
    assert {p.name for p in panel.parent.iterdir()} == {"panel.toml"}
