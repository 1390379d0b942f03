"""``concio path FILE``: follow a load path, settlement or pushover, event by event."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from concio.cli.options import EngineOf, File, Json, Language, Quiet, UnitsOf, factors_of, loaded, measured
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import progress_bar, verdict_so_far

if TYPE_CHECKING:
    from concio.analysis.path import ControlPoint


@guarded
def path(
    file: File,
    stage: Annotated[
        list[str] | None,
        typer.Option("--stage", "-s", help="Load factors at the end of a stage: dead=1,top=1 (repeatable, in order)."),
    ] = None,
    point: Annotated[
        str | None, typer.Option("--point", "-p", help="Control point: BODY,X,Y; in space BODY,X,Y,Z.")
    ] = None,
    along: Annotated[
        Literal["x", "y", "z", "-x", "-y", "-z"] | None,
        typer.Option("--along", help="Direction of its motion; x by default."),
    ] = None,
    until: Annotated[
        str | None, typer.Option("--until", help="Displacement of the point at which to stop: 0.02 or '20 mm'.")
    ] = None,
    method: Annotated[
        Literal["events", "steps"] | None,
        typer.Option("--method", "-m", help="events (exact, plane models, default) or steps (always in space)."),
    ] = None,
    steps: Annotated[
        int | None, typer.Option("--steps", help="Number of load steps of a stage, with --method steps; 20 by default.")
    ] = None,
    brittle: Annotated[
        bool, typer.Option("--brittle", help="Joints lose tension and cohesion once exceeded (--method steps).")
    ] = False,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for curve, events and last state.")] = None,
    every: Annotated[bool, typer.Option("--all", help="List every event.")] = False,
    language: Language = "en",
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Follow a load path event by event: which joint opens, closes, slips or sticks, and at which load.

    Without --stage, the [[stages]] of the file are followed; where there are none, each load group is a stage:
    self-weight first, then the others in the order of the file.

    The exit code is 0 where every stage reached its load, 3 where a stage is shown not to be
    carried, 4 where a requested load or displacement was not reached, where no stage applies the self-weight, or where
    the path could not be continued.

    Example: concio path wall.toml --stage dead=1 --stage live=5 --point c10-b05,2.0,2.5 --until "20 mm"
    """
    import concio
    from concio.analysis.path import Stage, run_path
    from concio.cli.path_lines import path_facts, path_lines, write_path
    from concio.errors import InputError
    from concio.model.self_weight import usual_order
    from concio.post.path_curve import most_moving

    if out is not None:
        check_directory(out)
    assembly = concio.assemble(loaded(file, units, engine))
    if along is not None and point is None:
        msg = "it is the direction of a control point, and no control point is given"
        raise InputError(msg, where="--along", hint="add --point BODY,X,Y")
    if steps is not None and assembly.model.dim == 2 and method != "steps":
        msg = "the path is followed event by event, which takes no number of steps"
        raise InputError(msg, where="--steps", hint="add --method steps, or leave it out")
    control = None if point is None else control_of(point, along or "x", file, assembly.model.dim)
    if control is None and until is not None:
        msg = "it is a displacement of a control point, and no control point is given"
        raise InputError(msg, where="--until", hint="add --point BODY,X,Y")
    wanted = [factors_of(text.split(",")) for text in stage or ()] or [
        {group: 1.0} for group in usual_order(assembly.model, assembly.groups)
    ]
    stages = [Stage(f"{k}: {_words(factors)}", factors) for k, factors in enumerate(wanted, 1)]
    if not stage and assembly.model.stages:
        stages = list(assembly.model.stages)
        control = control or stages[-1].control
    if until is not None:
        stages[-1] = replace(stages[-1], control=control, until=measured(until, "length", "--until", file))
    if steps is not None:
        stages = [replace(one, steps=steps) for one in stages]
    with progress_bar(shown=not json) as progress:
        found = run_path(assembly, stages, method=method, brittle=brittle, progress=progress)
    chosen = control or most_moving(found)
    verdict_so_far(found.verdict)
    if not json:
        answer(path_lines(found, chosen, every=every))
    if out is not None:
        with replaced_directory(out) as fresh:
            write_path(found, chosen, fresh, language)
    if json:
        print_json(path_facts(found, chosen))
    elif out is not None:
        say(f"  written      {out}: summary.json, path.csv, events.csv, path.png, path.svg, report.html, end/")
    return found.verdict.exit_code


def _words(factors: dict[str, float]) -> str:
    return ", ".join(f"{group} = {value:g}" for group, value in factors.items())


def control_of(text: str, along: str, file: Path, dim: int = 2) -> ControlPoint:
    """Return the control point that a text BODY,X,Y names, with the direction of its motion."""
    from concio.analysis.path import ControlPoint
    from concio.errors import InputError

    parts = text.rsplit(",", dim)
    if len(parts) != dim + 1:
        msg = f"'{text}' is not a point of a body"
        raise InputError(msg, where="--point", hint="write for example --point c03-b02,1.0,0.75" + ",0.3" * (dim - 2))
    at = tuple(measured(part.strip(), "length", "--point", file) for part in parts[1:])
    axis = "xyz".index(along[-1])
    if axis >= dim:
        msg = "the model is in the plane"
        raise InputError(msg, where="--along", hint="x, y, -x or -y")
    sign = -1.0 if along.startswith("-") else 1.0
    return ControlPoint(parts[0].strip(), at, tuple(sign * (k == axis) for k in range(dim)))
