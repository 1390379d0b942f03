"""Places where results go: nothing of the user's is ever deleted, replaced or left half written."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from commands import run
from concio.errors import InputError
from concio.io.listing import CONTENTS
from concio.io.owned_dir import contents, is_own, look_at, owned_directory
from samples import first

SMALL = "[panel]\ncourses = 1\nblocks = 2\ntop_pressure = 10\nelements_per_block = [2, 1]\n"


def fill(place: Path, **files: str) -> None:
    for name, text in files.items():
        path = place / name.replace("__", "/").replace("_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def written(target: Path, **files: str) -> None:
    with owned_directory(target) as fresh:
        fill(fresh, **files)


def tree(place: Path) -> dict[str, str]:
    return {
        p.relative_to(place).as_posix(): p.read_text()
        for p in sorted(place.rglob("*"))
        if p.is_file() and p.name != CONTENTS
    }


@pytest.fixture
def model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.toml").write_text(SMALL)
    return tmp_path / "m.toml"


@pytest.mark.parametrize("command", ["run", "path", "limit"])
def test_a_directory_that_happens_to_hold_a_summary_is_left_alone(model: Path, command: str) -> None:
    mine = model.parent / "mine"
    fill(mine, thesis_txt="years", summary_json='{"status": "solved"}', figures__a_png="drawn by hand")
    before = tree(mine)
    options = {"limit": ["--group", "top"]}.get(command, [])
    code, _, err = run(command, model, "--out", mine, *options)
    assert code == 2
    assert "holds other things than results of concio" in err
    assert tree(mine) == before


def test_what_concio_wrote_is_replaced_and_the_rest_stays(tmp_path: Path) -> None:
    place = tmp_path / "r"
    written(place, a_txt="1", figures__old_png="1", end__deep__x_txt="1")
    fill(place, thesis_txt="years", figures__mine_png="by hand")
    assert set(look_at(place).kept) == {"thesis.txt", "figures/mine.png"}
    written(place, a_txt="2", b_txt="2")
    assert tree(place) == {"a.txt": "2", "b.txt": "2", "thesis.txt": "years", "figures/mine.png": "by hand"}
    assert not (place / "end").exists()
    assert set(contents(place) or ()) == {"a.txt", "b.txt"}


def test_what_was_changed_by_hand_is_not_replaced(tmp_path: Path) -> None:
    place = tmp_path / "r"
    written(place, model_toml="1", a_txt="1")
    (place / "model.toml").write_text("1 and what I know better")
    with pytest.raises(InputError, match=r"model\.toml was changed since concio wrote the directory"):
        written(place, model_toml="2", a_txt="2")
    assert tree(place) == {"model.toml": "1 and what I know better", "a.txt": "1"}


@pytest.mark.parametrize("kind", ["file", "folder", "link", "dangling link"])
def test_something_else_of_a_name_that_is_needed_stops_the_writing(tmp_path: Path, kind: str) -> None:
    place = tmp_path / "r"
    written(place, a_txt="1")
    outside = tmp_path / "outside"
    fill(outside, precious_txt="years")
    way = place / "figures"
    if kind == "file":
        way.write_text("mine")
    elif kind == "folder":
        fill(way / "x.png", mine_txt="mine")
    else:
        way.symlink_to(outside if kind == "link" else tmp_path / "nowhere")
    before = tree(place), tree(outside)
    with pytest.raises(InputError, match="is in the way, which concio did not write"):
        written(place, a_txt="2", figures__x_png="2")
    assert (tree(place), tree(outside)) == before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["outside", "r"]


def test_a_forged_list_reaches_nothing_outside(tmp_path: Path) -> None:
    place, outside = tmp_path / "r", tmp_path / "precious.txt"
    outside.write_text("years")
    written(place, a_txt="1")
    listing = json.loads((place / CONTENTS).read_text())
    checksum = listing["files"]["a.txt"]
    outside.write_text("1")  # even with the right checksum
    listing["files"] |= {"../precious.txt": checksum, str(outside): checksum, "x/../../precious.txt": checksum, "": ""}
    (place / CONTENTS).write_text(json.dumps(listing))
    written(place, b_txt="2")
    assert outside.read_text() == "1"
    assert tree(place) == {"b.txt": "2"}


NO_LISTS = ["", "[]", "{}", "nonsense", '{"format": "concio contents", "files": 3}', "[" * 20_000]


@pytest.mark.parametrize("text", NO_LISTS)
def test_a_list_that_is_none_is_no_licence(tmp_path: Path, text: str) -> None:
    place = tmp_path / "r"
    fill(place, a_txt="mine")
    (place / CONTENTS).write_text(text)
    with pytest.raises(InputError, match="holds other things"):
        written(place, a_txt="2")
    assert tree(place) == {"a.txt": "mine"}


@pytest.mark.long
@pytest.mark.usefixtures("blank_figures")
def test_a_link_to_a_directory_stays_a_link(model: Path) -> None:
    real = model.parent / "disk" / "real"
    real.mkdir(parents=True)
    link = model.parent / "lnk"
    link.symlink_to(real)
    for _ in range(2):
        assert run("run", model, "--out", link, "--no-figures")[0] == 0
    assert link.is_symlink()
    assert (real / "summary.json").is_file()
    assert sorted(p.name for p in model.parent.iterdir()) == ["disk", "lnk", "m.toml"]
    assert [p.name for p in real.parent.iterdir()] == ["real"]


@pytest.mark.long
@pytest.mark.usefixtures("blank_figures")
def test_the_working_directory_may_be_the_place(model: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (model.parent / "r").mkdir()
    monkeypatch.chdir(model.parent / "r")
    for _ in range(2):
        assert run("run", model, "--out", ".", "--no-figures")[0] == 0
    assert Path("summary.json").is_file()


def test_what_is_interrupted_leaves_everything_as_it_was(tmp_path: Path) -> None:
    def interrupted(place: Path) -> None:
        with owned_directory(place) as fresh:
            fill(fresh, a_txt="half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted(tmp_path / "deep" / "new")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.long
@pytest.mark.skipif(os.name != "posix", reason="kills a process")
def test_a_killed_run_is_cleaned_up_by_the_next_and_told(model: Path) -> None:
    code = (
        "import sys, time\nfrom concio.io.owned_dir import owned_directory\n"
        "with owned_directory(sys.argv[1]) as fresh:\n"
        "    (fresh / 'half.txt').write_text('half')\n    print('ready', flush=True)\n    time.sleep(60)\n"
    )
    target = model.parent / "r"
    with subprocess.Popen([sys.executable, "-c", code, str(target)], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        # while it lives, another run leaves it alone
        assert run("run", model, "--out", target, "--no-figures")[0] == 0
        assert any(p.name.startswith(".concio-") for p in target.iterdir())
        process.send_signal(signal.SIGKILL)
    code, _, err = run("run", model, "--out", target, "--no-figures")
    assert code == 0
    assert "a run that was stopped had left" in err
    assert not [p for p in target.iterdir() if p.name.startswith(".")]


def test_what_another_machine_left_is_removed_after_a_day(tmp_path: Path) -> None:
    place = tmp_path / "r"
    foreign = place / ".concio-elsewhere-1"
    foreign.mkdir(parents=True)
    assert look_at(place).left == ()
    old = time.time() - 2 * 86_400
    os.utime(foreign, (old, old))
    assert look_at(place).left == (foreign,)
    written(place, a_txt="1")
    assert not foreign.exists()


@pytest.mark.long
@pytest.mark.usefixtures("blank_figures")
def test_exports_never_replace_what_they_did_not_write(model: Path) -> None:
    assert run("run", model, "--out", "r", "--no-figures")[0] == 0
    mine = model.parent / "mine.dxf"
    for name, form in (("mine.dxf", "dxf"), ("m.toml", "toml")):
        path = model.parent / name
        if not path.exists():
            path.write_text("drawn by hand")
        before = path.read_text()
        code, _, err = run("export", "r", "--to", form, "--out", path)
        assert code == 2
        assert "there is a file of that name already" in err
        assert path.read_text() == before
    assert run("export", "r", "--to", "dxf", "--out", mine, "--force")[0] == 0
    (model.parent / "tables").mkdir()
    (model.parent / "tables" / "bodies.csv").write_text("mine")
    assert run("export", "r", "--to", "csv", "--out", "tables")[0] == 2
    assert (model.parent / "tables" / "bodies.csv").read_text() == "mine"


@pytest.mark.long
@pytest.mark.usefixtures("blank_figures")
def test_exports_into_a_result_go_when_it_goes(model: Path) -> None:
    assert run("run", model, "--out", "r", "--no-figures")[0] == 0
    for form in ("vtu", "csv", "dxf", "toml"):
        assert run("export", "r", "--to", form)[0] == 0
    place = model.parent / "r"
    assert is_own(place / "deformed.dxf")
    assert (place / "vtu" / "bodies.pvd").is_file()
    assert run("export", "r", "--to", "dxf")[0] == 0  # its own is replaced
    assert look_at(place).kept == ()
    assert run("run", model, "--out", "r", "--no-figures")[0] == 0
    assert not (place / "vtu").exists()
    assert not (place / "deformed.dxf").exists()


@pytest.mark.parametrize("suffix", first(1, ["svg", "png", "pdf"]))
def test_pictures_of_check_replace_pictures_of_check_alone(model: Path, suffix: str) -> None:
    picture = model.parent / f"p.{suffix}"
    assert run("check", model, "--out", picture)[0] == 0
    assert run("check", model, "--out", picture)[0] == 0
    picture.write_bytes(b"a photograph")
    code, _, err = run("check", model, "--out", picture)
    assert (code, picture.read_bytes()) == (2, b"a photograph")
    assert "--force" in err
    assert run("check", model, "--out", picture, "--force")[0] == 0
    assert [p.name for p in model.parent.iterdir() if p.name.startswith(".")] == []


def test_a_written_file_keeps_its_link_and_its_neighbours(tmp_path: Path) -> None:
    import concio

    model = concio.column(width=1, height=1, blocks=1)
    real, link, neighbour = tmp_path / "real.toml", tmp_path / "link.toml", tmp_path / "link.toml.part"
    real.write_text("old")
    real.chmod(0o640)
    neighbour.write_text("mine")
    link.symlink_to(real)
    concio.save(model, link)
    assert link.is_symlink()
    assert real.read_text().startswith("# concio model")
    assert real.stat().st_mode & 0o777 == 0o640
    assert neighbour.read_text() == "mine"
    shutil.rmtree(tmp_path)
