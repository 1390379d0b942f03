"""Motions and pushes in space as they are seen: reports that play them, films and single frames."""

from __future__ import annotations

import json
import re
from functools import cache

import numpy as np
import pytest

import concio
from concio.plot.motion_figure import plot_frame, write_film
from concio.post.solid_frames import solid_frames
from concio.report.motion_page import motion_html
from space_motions import blocks

TALL = blocks(((-0.25, -0.2, 0.0), (0.25, 0.2, 2.0)))


@cache
def shaken():
    return concio.dynamics(
        TALL, {"x": concio.Pulse("sine", 6.0, 0.3)}, duration=0.3, step=5e-3, every=0.05, stop_overturned=False
    )


@cache
def pushed():
    return concio.push(TALL, direction=(0, 1))


@pytest.fixture(params=[shaken, pushed], ids=["motion", "push"])
def moved(request):
    return request.param()


def data_of(page):
    return json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL).group(1))


def test_a_report_plays_a_motion_in_space_where_its_bodies_stand(moved):
    page = motion_html(moved)
    data = data_of(page)
    assert "isPointInPath" in page  # the script that draws it
    assert len(data["frames"]) == len(data["at"]) == len(data["words"]) > 3
    points = np.array(data["bodies"][1]["points"]).reshape(-1, 3)
    last = np.array(data["frames"][-1]).reshape(-1, 12)[1]
    placed = last[:3] + points @ last[3:].reshape(3, 3).T
    assert placed == pytest.approx(moved.configuration(-1).vertices(1), abs=1e-4)
    assert data["bodies"][data["first"]]["name"] == "b0"
    turned = moved.rotation_of("b0") if moved is pushed() else moved.rotation("b0")
    assert data["turned"][-1][1] == pytest.approx(np.rad2deg(np.linalg.norm(turned[-1])), abs=1e-3)
    for fixed in ("speed", "history", "picked", "play", "frame"):
        assert f'id="{fixed}"' in page


def test_a_plane_report_still_plays():
    pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    page = motion_html(concio.push(pillar))
    assert data_of(page)["frames"]
    assert 'id="speed"' not in page


def test_frames_are_where_bodies_stand(moved):
    seen = solid_frames(moved, 5)
    assert len(seen.at) == 5
    own = seen.shown.starts[1:3]
    assert seen.points[-1, own[0] : own[1]] == pytest.approx(moved.configuration(-1).vertices(1), abs=1e-12)


def test_a_film_of_a_motion_in_space_shows_its_frames(moved, tmp_path, monkeypatch):
    from PIL import Image, ImageChops, ImageSequence

    monkeypatch.setattr("concio.plot.motion_in_space.POINTS", 120)
    path = write_film(moved, tmp_path / "film.gif", most=4)
    with Image.open(path) as film:
        pictures = [frame.convert("RGB") for frame in ImageSequence.Iterator(film)]
    assert len(pictures) == 4
    assert ImageChops.difference(pictures[0], pictures[-1]).getbbox() is not None


def test_a_frame_of_a_motion_in_space_is_drawn(monkeypatch):
    monkeypatch.setattr("concio.plot.motion_in_space.POINTS", 120)
    axes = plot_frame(shaken(), -1)
    assert axes.images
    low, high = axes.get_ylim()
    assert high - low < 6.0  # about what moves, not the floor of ten metres
