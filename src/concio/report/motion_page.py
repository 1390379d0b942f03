"""The report of a motion: one HTML file with verdict, a film with slider and play, curves or histories, and tables."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import concio
from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.push_result import PushResult
from concio.arguments import strict
from concio.display import number
from concio.model.polyhedron import Polyhedron
from concio.plot.motion_figure import plot_capacity, plot_energy, plot_ground, plot_history
from concio.post.motion_frames import box_of, frames, positions
from concio.post.solid_frames import solid_frames
from concio.report.html_parts import figure_html, page_html, resource, verdict_html
from concio.report.italian_page import Language, figure_in, page_in, script_words, text_in
from concio.verdict.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SECONDS = 12.0
"""How long the film of a push takes; a motion plays at its own speed."""

LARGEST = 4_000_000
"""Coordinates in the page at most: with more blocks there are fewer frames."""

SHOWN = 300
"""Events listed."""

CANVAS = (
    '<canvas id="film" style="width:100%;display:block" role="img" aria-label="the structure as it moves"></canvas>'
)
PLAY = (
    '<button id="play" type="button" aria-pressed="false">Play</button> '
    '<input id="frame" type="range" min="0" value="0" style="width:60%;vertical-align:middle" '
    'aria-label="frame"> <span id="word"></span>'
)
SPEED = '<label>speed <select id="speed">' + "".join(
    f"<option value={v}{' selected' if v == 1 else ''}>{v:g} ×</option>" for v in (0.1, 0.25, 0.5, 1, 2, 4)
) + "</select></label>"

HISTORY = (
    '<p><label>Block <select id="picked"></select></label></p>'
    '<canvas id="history" style="width:100%;display:block" role="img" aria-label="how far the block moved and turned">'
    "</canvas>"
)

HOW = {
    "same states": "contact states unchanged",
    "active set": "active set",
    "softer joints": "joints that give way more, less and less",
    "small problem": "small complementarity problem",
    "interior point": "interior point",
    "pivoting": "pivoting",
}
"""How a time step was solved, in words, by the names of ``solved_by``."""


@strict
def write_motion_report(
    result: PushResult | DynamicsResult, path: Path | str, *, language: Language = "en", verdict: Verdict | None = None
) -> Path:
    """Write the report of a push or a time history.

    Parameters
    ----------
    result : PushResult or DynamicsResult
    path : Path or str
    language : {"en", "it"}
    verdict : Verdict, optional
        What the motion was followed for; by default its own.

    Returns
    -------
    Path
        ``path``.
    """
    path = Path(path)
    path.write_text(motion_html(result, language, verdict), encoding="utf-8")
    return path


def motion_html(
    result: PushResult | DynamicsResult, language: Language = "en", verdict: Verdict | None = None
) -> str:
    """Return the report as a text; see :func:`write_motion_report`."""
    title = result.model.title or ("Pushed over" if isinstance(result, PushResult) else "Motion")

    def drawn(axes: Axes, name: str, caption: str) -> str:
        return figure_html(figure_in(axes, language), name, caption)

    if isinstance(result, PushResult):
        figures = drawn(plot_capacity(result), "capacity", "Multiplier over the controlled displacement.")
        tables = _events(result)
    else:
        figures = drawn(plot_history(result), "rotations", "Blocks that turn most.")
        if result.ground.any():
            figures += drawn(plot_ground(result), "ground", "Acceleration of the ground.")
        figures += drawn(plot_energy(result), "energy", "Energy stored, dissipated and put in.")
        tables = _shares(result)
    film, told, script = _space_film(result) if result.model.dim == 3 else _plane_film(result)
    moves = f"<section class=moves><h2>The structure as it moves, true to scale</h2>{film}</section>"
    kept = " translate=no" if result.model.title else ""
    data = {**told, **script_words(language), "words": [text_in(word, language) for word in told["words"]]}
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    body = (
        f'<header><p class="brand">concio</p><h1{kept}>{escape(title)}</h1></header>'
        f"<section id=verdict>{_verdict(result, verdict or result.verdict)}</section>"
        f"{moves}<section id=figures><h2>Figures</h2>{figures}</section>"
        f"<section id=tables>{tables}</section>"
        f"<footer>Written by concio {escape(concio.__version__)}. Forces in kN, lengths in m, time in s.</footer>"
        f'<script type="application/json" id="data">{text}</script>'
    )
    return page_in(page_html(title, body, script=resource(script)), language)


def _plane_film(result: PushResult | DynamicsResult) -> tuple[str, dict[str, Any], str]:
    """Return the frame of the film of a plane motion, what the script plays, and its name."""
    return CANVAS + f"<p>{PLAY}</p>", _film(result), "motion.js"


def _space_film(result: PushResult | DynamicsResult) -> tuple[str, dict[str, Any], str]:
    """Return the frame of the film of a motion in space, what the script plays, and its name."""
    model = result.model
    each = 12 * len(model.bodies)
    most = int(np.clip(LARGEST // max(2 * each, 1), 2, 400))
    seen = solid_frames(result, most)
    moving = np.array([body.kind != "fixed" for body in model.bodies])
    low, high = seen.box(moving)
    digits = max(0, 5 - int(np.floor(np.log10(float((high - low).max())))))
    turned = np.rad2deg(seen.turned)
    placed = np.concatenate([seen.centre, seen.rotation.reshape(*seen.rotation.shape[:2], 9)], axis=2)
    placed[..., :3], placed[..., 3:] = np.round(placed[..., :3], digits), np.round(placed[..., 3:], 5)
    data = {
        "bodies": [_surface(body, digits) for body in model.polyhedra],
        "low": low.tolist(), "high": high.tolist(), "at": seen.at.tolist(), "words": list(seen.words),
        "rate": 1.0 if isinstance(result, DynamicsResult) else float(seen.at[-1] - seen.at[0]) / SECONDS,
        "frames": [frame.ravel().tolist() for frame in placed], "turned": np.round(turned, 4).tolist(),
        "first": int(np.argmax(np.where(moving, turned.max(axis=0), -1.0))),
    }  # fmt: skip
    count = len(positions(result)[0])
    told = "Drag to turn, wheel to come nearer, click a block for its history."
    told += f" Of {count:,} places {len(seen.at):,} are shown." if len(seen.at) < count else ""
    return CANVAS + f"<p>{PLAY} {SPEED}</p><p>{told}</p>{HISTORY}", data, "motion_space.js"


def _surface(body: Polyhedron, digits: int) -> dict[str, Any]:
    """Return what the script draws of a block: points from its centroid, and faces, those with holes as triangles."""
    triangles, face = body.triangles
    rings = [body.loops_of(f) for f in range(len(body.faces))]
    parts = [[list(loops[0])] if len(loops) == 1 else triangles[face == f].tolist() for f, loops in enumerate(rings)]
    points = np.round(body.vertices - body.centroid, digits)
    faces = [ring for part in parts for ring in part]
    return {"name": body.name, "kind": body.kind, "points": points.ravel().tolist(), "faces": faces}


def _film(result: PushResult | DynamicsResult) -> dict[str, Any]:
    """Return what the script plays."""
    size = 2 * sum(len(r) for b in range(len(result.model.bodies)) for r in result.configuration(0).rings(b))
    pictures = frames(result, int(np.clip(LARGEST // max(size, 1), 2, 400)))
    box = box_of(pictures, result.model)
    digits = max(0, 4 - int(np.floor(np.log10(float((box[1] - box[0]).max())))))
    span = pictures[-1].at - pictures[0].at
    rate = 1.0 if isinstance(result, DynamicsResult) else span / SECONDS
    return {
        "kinds": [body.kind for body in result.model.bodies],
        "box": box.tolist(),
        "at": [p.at for p in pictures],
        "words": [p.word for p in pictures],
        "rate": rate,
        "frames": [[[np.round(r, digits).ravel().tolist() for r in rings] for rings in p.rings] for p in pictures],
    }


def _verdict(result: PushResult | DynamicsResult, verdict: Verdict) -> str:
    """Return the verdict of a motion as its own section, word for word what every other place says."""
    return verdict_html(verdict, verdict.proof, units=result.model.report)


def _events(result: PushResult) -> str:
    rows = "".join(
        f"<tr><td class=n>{number(1e3 * float(result.displacement[e.step]), 4)}</td><td class=n>"
        f"{number(float(result.multiplier[e.step]), 4)}</td><td translate=no>{escape(e.bodies[0])}</td>"
        f"<td translate=no>{escape(e.bodies[1])}</td>"
        f"<td>{escape(e.kind)}</td>{''.join(f'<td class=n>{number(v, 4)}</td>' for v in e.at)}</tr>"
        for e in result.events[:SHOWN]
    )
    more = f"<p>{len(result.events) - SHOWN:,} more.</p>" if len(result.events) > SHOWN else ""
    words = ("at [mm]", "multiplier", "between", "and", "happens", *("x [m]", "y [m]", "z [m]")[: result.model.dim])
    head = "".join(f"<th>{w}</th>" for w in words)
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
    return f"<h2>Events</h2><div class=scroll>{table}</div>{more}"


def _shares(result: DynamicsResult) -> str:
    rows = "".join(
        f"<tr><td>{escape(HOW.get(name, name))}</td><td class=n>{100 * share:.1f} %</td></tr>"
        for name, share in result.steps.shares().items()
    )
    mean = float(result.steps.factorisations.mean()) if len(result.steps) else 0.0
    return (
        "<h2>Solution of the time steps</h2><div class=scroll><table><thead><tr><th>method</th><th>share</th></tr>"
        f"</thead><tbody>{rows}</tbody></table></div><p>{mean:.2f} factorisations per step, "
        f"{result.seconds:.1f} s in all.</p>"
    )
