"""Motions in files: what is saved loads again, films, VTU series and reports hold what was computed."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from html import unescape
from importlib.resources import files

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.motion.dynamics_result import Ending
from concio.io.motion_series import write_motion_series
from concio.plot.motion_figure import plot_frame, write_film
from concio.report.motion_page import motion_html
from models import box, model_of, weight
from motion_models import standing

PILLAR = """
title = "pillar of <two> blocks"
[materials.stone]
kind = "rigid"
unit_weight = "20 kN/m3"
[joints.dry]
friction = 0.7
[[blocks]]
name = "floor"
kind = "fixed"
outline = [[-3, -0.4], [3, -0.4], [3, 0], [-3, 0]]
[[blocks]]
name = "base"
kind = "rigid"
material = "stone"
outline = [[-0.2, 0], [0.2, 0], [0.2, 0.4], [-0.2, 0.4]]
[[blocks]]
name = "pillar"
kind = "rigid"
material = "stone"
outline = [[-0.2, 0.4], [0.2, 0.4], [0.2, 1.6], [-0.2, 1.6]]
[[loads]]
kind = "weight"
value = [0, -1]
[motion]
pulse = { shape = "sine", amplitude = "0.2 g", length = "200 ms" }
duration = "300 ms"
points = [{ body = "pillar", at = [0.0, 1.6] }]
"""


@pytest.fixture(scope="module")
def shaken() -> concio.DynamicsResult:
    pulse = concio.Pulse("sine", 6.0, 0.3)
    top = concio.ControlPoint("block", (0.0, 1.2))
    return concio.dynamics(standing(), pulse, 0.5, 2e-3, points=(top,))


@pytest.fixture(scope="module")
def pushed() -> concio.PushResult:
    return concio.push(standing(0.2, 1.0), step=0.03, points=(concio.ControlPoint("block", (0.0, 1.0)),))


def test_a_motion_is_loaded_as_it_was_saved_and_goes_on(tmp_path, shaken):
    path = concio.save_motion(shaken, tmp_path / "motion.npz")
    again = concio.load_motion(path)
    assert isinstance(again, concio.DynamicsResult)
    assert again.summary() == shaken.summary()
    assert np.array_equal(again.shots.centre, shaken.shots.centre)
    assert np.array_equal(again.point(0), shaken.point(0))
    on, same = (concio.dynamics(standing(), duration=0.1, step=2e-3, start=r.end) for r in (again, shaken))
    assert np.array_equal(on.end.centre, same.end.centre)


def test_a_push_is_loaded_as_it_was_saved(tmp_path, pushed):
    again = concio.load_motion(concio.save_motion(pushed, tmp_path / "motion.npz"))
    assert isinstance(again, concio.PushResult)
    assert again.events == pushed.events
    assert again.ending is pushed.ending
    assert np.array_equal(again.multiplier, pushed.multiplier)
    assert again.points == pushed.points


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 nothing", b"text"])
def test_what_is_no_motion_is_refused(tmp_path, content):
    path = tmp_path / "motion.npz"
    path.write_bytes(content)
    with pytest.raises(concio.InputError, match="holds no motion"):
        concio.load_motion(path)


def test_vtu_series_has_the_bodies_where_they_stand(tmp_path, pushed):
    written = write_motion_series(pushed, tmp_path / "series", most=5)
    root = ET.parse(written[0]).getroot()
    times = [float(e.get("timestep")) for e in root.iter("DataSet")]
    assert len(written) == 6
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(pushed.displacement[-1])
    assert all(p.stat().st_size > 500 for p in written[1:])


@pytest.mark.long
def test_a_film_and_a_frame(tmp_path, pushed, shaken):
    from PIL import Image

    path = write_film(pushed, tmp_path / "film.gif", most=6)
    with Image.open(path) as film:
        assert film.n_frames == 6
    axes = plot_frame(shaken, 3)
    assert "s" in axes.texts[0].get_text()
    with pytest.raises(concio.InputError, match=r"ends in \.gif or \.mp4"):
        write_film(pushed, tmp_path / "film.avi")


def test_the_report_plays_the_frames(shaken, pushed):
    for result, at in ((shaken, shaken.shots.time), (pushed, pushed.displacement)):
        html = motion_html(result)
        data = json.loads(re.search(r'id="data">(.*?)</script>', html, re.S).group(1))
        assert data["at"][-1] == pytest.approx(float(at[-1]))
        assert len(data["frames"]) == len(data["at"]) == len(data["words"])
        last = np.array(data["frames"][-1][1][0]).reshape(-1, 2)
        assert last == pytest.approx(result.configuration(-1).outline(1), abs=1e-4)
        assert result.verdict.sentence in unescape(html)


def test_elastic_bodies_and_holes_are_drawn_as_they_are():
    ring = np.array([(0.3, 0.3), (0.3, 0.7), (0.7, 0.7), (0.7, 0.3)])
    frame = concio.Body("frame", box("b", 0, 1, 0, 1).outline, kind="rigid", material="stone", holes=(ring,))
    soft = box("soft", 0.0, 1.0, 1.0, 1.5, mesh_size=0.25)
    model = model_of(box("ground", -3, 3, -1, 0, kind="fixed"), frame, soft, law=0.6, loads=(weight(),))
    found = concio.push(replace(model), until=0.02)
    assert found.certified
    standing_ = found.configuration(-1)
    moved = standing_.rings(1)
    assert len(moved) == 2
    assert np.linalg.norm(moved[1][1] - moved[1][0]) == pytest.approx(0.4)
    assert len(standing_.rings(2)[0]) == 2 * (4 + 2)


@pytest.mark.long
def test_push_and_shake_from_the_command_line(tmp_path):
    file = tmp_path / "pillar.toml"
    file.write_text(PILLAR)
    code, out, err = run("push", file, "--out", tmp_path / "pushed", "--vtu")
    assert code == 0, err
    assert "peak         0.2499" in out
    assert (tmp_path / "pushed" / "curve.csv").exists()
    assert (tmp_path / "pushed" / "paraview" / "motion.pvd").exists()
    assert "<two>" not in (tmp_path / "pushed" / "report.html").read_text()
    code, out, err = run("shake", file, "--out", tmp_path / "shaken", "--json")
    told = json.loads(out)
    assert (code, told["status"]) == (4, "moving"), err  # at its 300 ms
    assert told["verdict"]["unchecked"]
    assert told["energy_error"] < 1e-6
    head = (tmp_path / "shaken" / "history.csv").read_text().splitlines()[0]
    assert "point 1 [m]" in head
    code, out, err = run("shake", file, "--from", tmp_path / "shaken" / "motion.npz", "--duration", "50 ms")
    assert code == 4, err
    assert "0.35 s" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("push", "--film", "gif"), "needs a directory"),
        (("push", "--film", "avi", "--out", "o"), "'avi' is not a film"),
        (("push", "--load", "--point", "pillar,0,1"), "either the load grows or a point moves"),
        (("shake", "--motion", "nowhere.at2"), "there is no such file"),
        (("shake", "--pulse", "half sine"), "is not a pulse"),
        (("shake", "--pulse", "half sine,0.4 feet,1 s"), "is not an acceleration"),
        (("shake", "--duration", "10 parsecs"), "is not a time"),
        (("shake", "--from", "nowhere.npz"), "there is no such file"),
    ],
)
def test_bad_options(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pillar.toml").write_text(PILLAR)
    code, _, err = run(arguments[0], "pillar.toml", *arguments[1:])
    assert code == 2
    assert words in err


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('duration = "300 ms"', "durration = 1.0", "did you mean 'duration'"),
        ('duration = "300 ms"', 'duration = "soon"', "is not a time"),
        ('shape = "sine"', 'shape = "sin"', "shape"),
    ],
)
def test_bad_motion_tables(tmp_path, old, new, words):
    file = tmp_path / "pillar.toml"
    file.write_text(PILLAR.replace(old, new))
    with pytest.raises(concio.InputError, match=words):
        concio.load(file)


@pytest.mark.long  # test_cli interrupts a command, too
def test_ctrl_c_keeps_what_was_computed(tmp_path):
    """The command is stopped in the middle: exit code 130, and the motion written so far loads and goes on."""
    file, out = tmp_path / "motion.toml", tmp_path / "out"
    text = files("concio.model").joinpath("templates", "motion.toml").read_text(encoding="utf-8")
    file.write_text(text.replace('duration = "3 s"', 'duration = "600 s"'), encoding="utf-8")
    code = f"""
import os, signal, sys
from concio.analysis.motion.stepper import Stepper
from concio.cli.main import main
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests run in the background of a shell
step, made = Stepper.step, []
def counted(*arguments):
    made.append(1)
    if len(made) == 40:
        os.kill(os.getpid(), signal.SIGINT)
    return step(*arguments)
Stepper.step = counted
sys.argv = ["concio", "shake", {str(file)!r}, "--out", {str(out)!r}]
main()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 130, done.stderr
    assert "Traceback" not in done.stderr
    kept = concio.load_motion(out / "motion.npz")
    assert kept.ending is Ending.STOPPED
    assert 0 < kept.end.time < 1
    assert len(kept.steps) == len(kept.steps.reaction)
    assert concio.dynamics(kept.model, duration=0.01, start=kept.end).certified


def damaged(path, change) -> None:
    """Write a motion again with its head and arrays changed."""
    with np.load(path) as archive:
        head = json.loads(str(archive["head"]))
        arrays = {name: archive[name] for name in archive.files if name != "head"}
    change(head, arrays)
    np.savez(path, head=np.array(json.dumps(head)), **arrays)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda _, a: a.pop("end.centre"), "damaged: KeyError"),
        (lambda _, a: a.update({"end.centre": a["end.centre"].astype(str)}), "'end.centre' does not hold numbers"),
        (lambda _, a: a.update({"end.memory.key": a["end.memory.key"] + 0.5}), "memory.key' does not hold integers"),
        (lambda _, a: a.update({"end.spin": a["end.spin"][:-1]}), r"'end.spin' has the shape \(1,\), not \(2\)"),
        (lambda _, a: a.update({"end.velocity": a["end.velocity"] * np.nan}), "velocity' holds what no motion has"),
        (lambda _, a: a.update({"steps.how": a["steps.how"] + 99}), "names methods that are not there"),
        (lambda h, _: h["values"].pop("end"), "damaged: TypeError"),
        (lambda h, _: h["values"].update(end=None), "'end' is missing"),
        (lambda h, _: h["values"]["ending"].update(name="__class__"), "damaged: KeyError"),
        (lambda h, _: h["values"].update(gravity="much"), "'gravity' is not what it must be"),
    ],
)  # fmt: skip
def test_what_is_damaged_is_refused(tmp_path, shaken, change, words):
    path = concio.save_motion(shaken, tmp_path / "motion.npz")
    damaged(path, change)
    with pytest.raises(concio.InputError, match=words):
        concio.load_motion(path)
