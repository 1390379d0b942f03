"""What ``concio push`` and ``concio shake`` say, and what they write."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Literal

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.push_result import PushEnding, PushResult
from concio.cli.outcome import note
from concio.display import number
from concio.errors import InputError
from concio.io.csv_table import write_csv
from concio.io.motion_file import save_motion
from concio.io.motion_series import write_motion_series
from concio.io.solids_out import write_solids
from concio.plot.motion_figure import plot_capacity, plot_energy, plot_ground, plot_history, write_film
from concio.report.motion_page import HOW, write_motion_report
from concio.units import GRAVITY
from concio.verdict.verdict import Verdict

MOST_LINES = 6
"""Lines of one kind in a short text."""

EVENTS = 12
"""Events listed by default."""


def push_lines(result: PushResult, *, every: bool = False) -> list[str]:
    """Return what a push comes to."""
    units = result.model.report
    d, load = result.displacement, result.multiplier
    what = ", ".join(result.live) if result.live else "a share of the weights"
    verdict = result.verdict
    peak = "peak     " if result.peak_passed or result.ending is PushEnding.NO_LARGER_LOAD else "largest  "
    lines = [
        verdict.sentence,
        *verdict.lines(units, most=MOST_LINES),
        f"  multiplied   {what}: {units.force_vector(result.force.tolist())} at multiplier 1",
        f"  {peak}    {number(result.peak, 6)} at {units.text('motion', float(d[result.peak_step]))}",
        f"  end          {number(float(load[-1]), 4, size=result.peak)} at {units.text('motion', float(d[-1]))}",
        f"  certificate  {result.certificate:.1e} (worst of {len(result)} points, where the bodies stand)",
    ]
    if result.lent_compliance:
        lines.append(f"  compliance   {result.lent_compliance:.1e} m/kN added to each contact point of hard joints")
    shown = result.events if every else result.events[:EVENTS]
    for e in shown:
        at = f"{units.text('motion', float(d[e.step]))}, {number(float(load[e.step]), 4)}"
        lines.append(f"  {at}: {e.bodies[0]} | {e.bodies[1]} {e.kind} at ({', '.join(f'{v:.4g}' for v in e.at)})")
    if len(shown) < len(result.events):
        lines.append(f"  {len(result.events) - len(shown)} more events: --all lists them")
    return lines + [f"Note: {n}" for n in result.notes]


def shake_lines(result: DynamicsResult) -> list[str]:
    """Return what a motion comes to."""
    units = result.model.report
    name, turned = result.largest_rotation
    shares = ", ".join(f"{HOW.get(how, how)} in {100 * s:.1f} %" for how, s in result.steps.shares().items())
    told = result.summary()
    verdict = result.verdict
    return [
        verdict.sentence,
        *(
            [f"  ground       {result.asked}; largest acceleration {number(result.ground_peak / GRAVITY, 4)} g"]
            if result.asked
            else []
        ),
        *verdict.lines(units, most=MOST_LINES),
        f"  time         {number(float(result.end.time), 6)} s in {len(result.steps):,} steps, "
        f"{result.seconds:.1f} s of computing time",
        f"  turned most  {name}: {number(float(np.rad2deg(turned)), 4)} degrees",
        f"  joints       open by {units.text('motion', told['largest_opening'])} at most, "
        f"slip by {units.text('motion', told['largest_slip'])}",
        f"  certificate  {result.certificate:.1e} (worst of all steps)",
        f"  energy       balance closes to {result.energy.error:.1e} of {number(result.energy.scale, 4)} kN m "
        + ("(less was exchanged)" if result.energy.still else "exchanged"),
        f"  steps        {shares} of steps; {float(result.steps.factorisations.mean()):.2f} factorisations per step",
    ]


def write_motion(
    result: PushResult | DynamicsResult, place: Path, films: tuple[str, ...], series: bool,
    language: Literal["en", "it"] = "en", verdict: Verdict | None = None,
) -> list[str]:  # fmt: skip
    """Write summary, histories, figures, report, the motion itself, films and VTU files; return their names."""
    (place / "summary.json").write_text(
        json.dumps(result.summary(), indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8"
    )
    if isinstance(result, PushResult):
        table = {
            "displacement [m]": result.displacement,
            "multiplier [-]": result.multiplier,
            **{f"point {k + 1} [m]": result.point(k) for k in range(len(result.points))},
            **{
                f"reaction {axis} of {name} [kN]": result.reaction[:, r, k]
                for r, name in enumerate(result.reactions_of)
                for k, axis in enumerate("xyz"[: result.model.dim])
            },
            "residual [-]": result.residual,
        }
        figures = {"capacity": plot_capacity(result)}
        write_csv(table, place / "curve.csv")
        write_csv(_events(result), place / "events.csv")
        names = ["curve.csv", "events.csv"]
    else:
        steps, shots = result.steps, result.shots
        table = {
            "time [s]": steps.time,
            **{f"point {k + 1} [m]": result.point(k) for k in range(len(result.points))},
            **{
                f"reaction {axis} of {name} [kN]": steps.reaction[:, r, k]
                for r, name in enumerate(result.reactions_of)
                for k, axis in enumerate("xyz"[: result.model.dim])
            },
            "residual [-]": steps.residual,
        }
        write_csv(table, place / "history.csv")
        energy = {f"{name} [kN m]": values for name, values in result.energy.values.items()}
        write_csv({"time [s]": shots.time, **energy, "balance [kN m]": result.energy.total}, place / "energy.csv")
        figures = {"rotations": plot_history(result), "energy": plot_energy(result)}
        if result.ground.any():
            figures["ground"] = plot_ground(result)
        names = ["history.csv", "energy.csv"]
    for name, axes in figures.items():
        for form in ("png", "svg"):
            figure = axes.get_figure(root=True)
            assert figure is not None
            figure.savefig(place / f"{name}.{form}", dpi=150)
        names.append(f"{name}.png")
    write_motion_report(result, place / "report.html", language=language, verdict=verdict)
    save_motion(result, place / "motion.npz")
    for film in films:
        try:
            if film == "glb":
                write_solids(place / "film.glb", result)
            else:
                write_film(result, place / f"film.{film}")
            names.append(f"film.{film}")
        except InputError as error:
            note(f"Note: no film.{film}: {error.what}")
    if series:
        write_motion_series(result, place / "paraview")
        names.append("paraview/")
    return ["summary.json", *names, "report.html", "motion.npz"]


def _events(result: PushResult) -> dict[str, np.ndarray]:
    events = result.events
    return {
        "point [-]": np.array([e.step for e in events], dtype=int),
        "displacement [m]": np.array([result.displacement[e.step] for e in events], dtype=float),
        "multiplier [-]": np.array([result.multiplier[e.step] for e in events], dtype=float),
        "kind": np.array([e.kind for e in events], dtype=str),
        "body_a": np.array([e.bodies[0] for e in events], dtype=str),
        "body_b": np.array([e.bodies[1] for e in events], dtype=str),
        **{f"{axis} [m]": np.array([e.at[k] for e in events], dtype=float)
           for k, axis in enumerate("xyz"[: result.model.dim])},
    }  # fmt: skip
