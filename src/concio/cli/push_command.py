"""``concio push FILE``: push a structure over, past its peak, until its strength is lost."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from concio.cli.options import EngineOf, Factors, File, Json, Language, Quiet, UnitsOf, factors_of, loaded, measured
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.path_command import control_of
from concio.cli.progress import progress_bar, verdict_so_far

Film = Annotated[
    list[str] | None,
    typer.Option(
        "--film", help="Write a film into --out: gif, mp4 where FFmpeg is installed, in space also glb (repeatable)."
    ),
]
Series = Annotated[bool, typer.Option("--vtu", help="Write a series of VTU files for ParaView into --out.")]


def check_out(out: Path | None, film: list[str] | None, series: bool) -> None:
    """Raise where what is to be written cannot be."""
    from concio.errors import InputError

    if out is not None:
        check_directory(out)
    elif film or series:
        msg = "a film or a series needs a directory"
        raise InputError(msg, where="--film, --vtu", hint="add --out DIRECTORY")
    for form in film or ():
        if form not in ("gif", "mp4", "glb"):
            msg = f"'{form}' is not a film"
            raise InputError(msg, where="--film", hint="gif, mp4 or, in space, glb")


@guarded
def push(
    file: File,
    group: Annotated[
        list[str] | None,
        typer.Option("--group", "-g", help="Load group that grows (repeatable); by default live, or else the weights."),
    ] = None,
    weights: Annotated[
        bool, typer.Option("--weights", help="Multiply all weights, with vertical loads, as assess does.")
    ] = False,
    direction: Annotated[
        str | None,
        typer.Option(
            "--direction", "-d", help="Direction of the load: x, -y, or components '1,0.5'; default x for the weights."
        ),
    ] = None,
    point: Annotated[
        str | None, typer.Option("--point", "-p", help="Control point: BODY,X,Y, in space BODY,X,Y,Z.")
    ] = None,
    along: Annotated[
        Literal["x", "y", "z", "-x", "-y", "-z"] | None,
        typer.Option("--along", help="Direction of its motion; x by default."),
    ] = None,
    load: Annotated[bool, typer.Option("--load", help="Control the load instead of a displacement.")] = False,
    step: Annotated[str | None, typer.Option("--step", help="Largest step: '5 mm', or a multiplier.")] = None,
    until: Annotated[str | None, typer.Option("--until", help="Displacement (or multiplier) at which to stop.")] = None,
    smallest: Annotated[float, typer.Option("--smallest", help="Multiplier at which the strength is lost.")] = 0.0,
    factor: Factors = None,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for curve, report and film.")] = None,
    film: Film = None,
    series: Series = False,
    every: Annotated[bool, typer.Option("--all", help="List every event.")] = False,
    language: Language = "en",
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Compute the capacity curve at large displacements, past the peak, until the strength is lost.

    The multiplied load is the group "live", the groups of --group, or a horizontal share of all weights that the
    structure carries: self-weights and loads from above, as in "concio assess".

    The exit code is 0 where the curve was followed to its end, 3 where the structure does not stand at the start, 4
    where the curve could not be continued or was stopped before its end, or a growing load (--load) ended below the
    multiplier of --until.

    Example: concio push pillar.toml --out pushed --film gif
    """
    import concio
    from concio.analysis.motion.push_result import PushEnding
    from concio.cli.motion_lines import push_lines, write_motion
    from concio.errors import InputError

    check_out(out, film, series)
    if load and point is not None:
        msg = "either the load grows or a point moves"
        raise InputError(msg, where="--load, --point", hint="leave one of them out")
    if along is not None and point is None:
        msg = "it is the direction of a control point, and no control point is given"
        raise InputError(msg, where="--along", hint="add --point BODY,X,Y; --direction is that of the load")
    if weights and group:
        msg = "either all weights are multiplied or load groups"
        raise InputError(msg, where="--weights, --group", hint="leave one of them out")
    model = loaded(file, units, engine)
    kind = "number" if load else "length"
    sizes = [None if t is None else measured(t, kind, w, file) for t, w in ((step, "--step"), (until, "--until"))]
    control = None if point is None else control_of(point, along or "x", file, model.dim)
    towards = None if direction is None else _direction(direction, model.dim)
    with progress_bar(shown=not json) as progress:
        found = concio.push(
            model, control="load" if load else control,
            live=() if weights else group or None, direction=towards, step=sizes[0], until=sizes[1], smallest=smallest,
            factors=factors_of(factor), progress=progress,
        )  # fmt: skip
    if not json:
        answer(push_lines(found, every=every))
    written: list[str] = []
    if out is not None:
        verdict_so_far(found.verdict)
        with replaced_directory(out) as fresh:
            written = write_motion(found, fresh, tuple(film or ()), series, language)
    if json:
        print_json(found.summary())
    elif out is not None:
        say(f"  written      {out}: {', '.join(written)}")
    if found.ending is PushEnding.STOPPED:
        return 130
    return found.verdict.exit_code


def _direction(text: str, dim: int) -> tuple[float, ...]:
    """Return the direction that a text names: an axis, or components with commas."""
    from concio.errors import InputError

    axes = {f"{sign}{axis}": tuple((-1.0 if sign else 1.0) * (k == i) for i in range(dim))
            for sign in ("", "-") for k, axis in enumerate("xyz"[:dim])}  # fmt: skip
    if text in axes:
        return axes[text]
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        msg = f"'{text}' is not a direction"
        hint = f"one of {', '.join(axes)}, or components such as '1,0.5'"
        raise InputError(msg, where="--direction", hint=hint) from None
