"""``concio shake FILE``: the motion of a structure under a motion of the ground."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from concio.cli.options import EngineOf, Factors, File, Json, Language, Quiet, UnitsOf, factors_of, loaded
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import replaced_directory
from concio.cli.path_command import control_of
from concio.cli.progress import progress_bar, verdict_so_far
from concio.cli.push_command import Film, Series, check_out

if TYPE_CHECKING:
    from concio.model.motion.signals import Pulse, Record

    Signal = Pulse | Record


@guarded
def shake(
    file: File,
    motion: Annotated[
        Path | None, typer.Option("--motion", help="Record: AT2, VT2, DT2, or a text of one or two columns.")
    ] = None,
    transverse: Annotated[
        Path | None, typer.Option("--transverse", help="Record of the motion along y, of a model in space.")
    ] = None,
    vertical: Annotated[Path | None, typer.Option("--vertical", help="Record of the vertical motion.")] = None,
    pulse: Annotated[
        str | None,
        typer.Option("--pulse", help="SHAPE,AMPLITUDE,LENGTH: 'half sine,0.4 g,0.5 s' (rectangular, sine, ricker)."),
    ] = None,
    scale: Annotated[float | None, typer.Option("--scale", help="Factor of the ground motion.")] = None,
    record_unit: Annotated[str | None, typer.Option("--record-unit", help="g, m/s2, cm/s2, m/s, m...")] = None,
    record_step: Annotated[str | None, typer.Option("--record-step", help="Sampling interval: '10 ms'.")] = None,
    duration: Annotated[str | None, typer.Option("--duration", help="Duration of the analysis: '10 s'.")] = None,
    step: Annotated[str | None, typer.Option("--step", help="Largest time step: '2 ms'.")] = None,
    restitution: Annotated[
        float | None, typer.Option("--restitution", help="Coefficient of restitution of impacts, from 0 to 1.")
    ] = None,
    point: Annotated[
        list[str] | None,
        typer.Option("--point", "-p", help="Point to follow along x: BODY,X,Y, in space BODY,X,Y,Z (repeatable)."),
    ] = None,
    start: Annotated[Path | None, typer.Option("--from", help="Continue from the end of a motion.npz.")] = None,
    factor: Factors = None,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for histories, report and film.")] = None,
    film: Film = None,
    series: Series = False,
    language: Language = "en",
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Compute rocking, sliding and impacts under a recorded ground motion or a pulse, with every step certified.

    Options take precedence over the table [motion] of the file. Ctrl-C stops the analysis and keeps the steps computed
    so far.

    Without a duration the motion is followed until everything rests or a block has fallen. The exit code is 0 where the
    structure comes to rest, 3 where it falls or does not stand at the start, 4 where it still moves or a step failed.

    Example: concio shake pillar.toml --motion record.at2 --scale 0.3 --out shaken --film gif
    """
    import concio
    from concio.analysis.motion.continued import goes_on, otherwise
    from concio.analysis.motion.dynamics_result import DynamicsResult, Ending
    from concio.cli.motion_lines import shake_lines, write_motion
    from concio.errors import InputError
    from concio.io.motion_file import load_motion
    from concio.model.file.motion_table import motion_table, records_by_axis
    from concio.model.file.reading import file_units, read_tables
    from concio.model.motion.records import read_record

    check_out(out, film, series)
    model = loaded(file, units, engine)
    data = read_tables(file)
    table = motion_table(data, str(file), file_units(data, str(file)))
    options: dict[str, Any] = table.arguments(model.dim)
    if motion is not None and pulse is not None:
        msg = "there is a record and a pulse along x"
        raise InputError(msg, where="--motion, --pulse", hint="keep one of them")
    notes: list[str] = []
    apart = None if record_step is None else _time(record_step, "--record-step")
    if motion is transverse is vertical is None:
        for option, text in (("--record-unit", record_unit), ("--record-step", record_step)):
            if text is not None:
                msg = "it is that of the records of --motion, --transverse and --vertical, and none is given"
                raise InputError(msg, where=option, hint="give the record, or write it in [motion] of the file")
    given: dict[str, Signal] = {}
    for axis, record in records_by_axis(motion, transverse, vertical, model.dim, "--transverse"):
        if record is not None:
            given[axis] = read_record(record, unit=record_unit, step=apart)
    if pulse is not None:
        given["x"] = _pulse(pulse)
    whole = "x" in given
    own = {} if whole else table.ground(file.parent, model.dim)
    kept = own.keys() - given.keys()
    if scale is None and table.scale != 1.0 and given and not kept:
        notes.append(
            f"the scale of {table.scale:g} in the file belongs to its own ground motion and was not applied: --scale"
        )
    left = [word for word, there in (("transverse", transverse), ("vertical", vertical))
            if whole and there is None and getattr(table, word) is not None]  # fmt: skip
    if left:
        notes.append(
            f"the {' and '.join(left)} record of the file belongs to its own ground motion and was not applied: "
            + ", ".join(f"--{word}" for word in left)
        )
    ground, factor_of_motion = _scaled(given, {axis: own[axis] for axis in kept}, scale, table.scale)
    for name, text in (("duration", duration), ("step", step)):
        if text is not None:
            options[name] = _time(text, f"--{name}")
    if restitution is not None:
        options["restitution"] = restitution
    if point:
        options["points"] = tuple(control_of(text, "x", file, model.dim) for text in point)
    earlier: DynamicsResult | None = None
    if start is not None:
        read = load_motion(start)
        if not isinstance(read, DynamicsResult):
            msg = "this is a push, no motion in time"
            raise InputError(msg, where=str(start), hint="give the motion.npz that shake wrote")
        earlier = read
        notes += goes_on(earlier.model, model, str(start))
        if options.pop("velocities", None):
            notes.append("the velocities of the file are those of a beginning: this motion goes on with those it had")
        options["start"] = earlier.end
    with progress_bar(shown=not json) as progress:
        found = concio.dynamics(
            model, ground, scale=factor_of_motion, factors=factors_of(factor), progress=progress,
            **options,
        )  # fmt: skip
    notes += [] if earlier is None else otherwise(earlier, found)
    found = replace(found, notes=(*found.notes, *notes))
    if not json:
        answer(shake_lines(found))
    written: list[str] = []
    if out is not None:
        verdict_so_far(found.verdict)
        with replaced_directory(out) as fresh:
            written = write_motion(found, fresh, tuple(film or ()), series, language)
    if json:
        print_json(found.summary())
    elif out is not None:
        say(f"  written      {out}: {', '.join(written)}")
    return 130 if found.ending is Ending.STOPPED else found.verdict.exit_code


def _scaled(
    given: dict[str, Signal], own: dict[str, Signal], scale: float | None, scale_of_own: float
) -> tuple[dict[str, Signal], float]:
    """Return the ground motion and a factor of all of it: the scale of a file applies to the signals of the file."""
    if scale is not None or not own:
        return {**given, **own}, 1.0 if scale is None else scale
    if not given:
        return own, scale_of_own
    return {**given, **{axis: signal.scaled(scale_of_own) for axis, signal in own.items()}}, 1.0


def _time(text: str, where: str) -> float:
    from concio.errors import InputError
    from concio.model.file.motion_table import seconds

    try:
        return float(seconds(text))
    except ValueError as error:
        raise InputError(str(error), where=where, hint="for example '10 ms'") from None


def _pulse(text: str) -> Any:
    from concio.errors import InputError
    from concio.model.file.motion_table import acceleration, seconds
    from concio.model.motion.signals import Pulse

    parts = [p.strip() for p in text.split(",")]
    if len(parts) not in (3, 4):
        msg = f"'{text}' is not a pulse"
        raise InputError(msg, where="--pulse", hint="write for example 'half sine,0.4 g,0.5 s'")
    try:
        cycles = float(parts[3]) if len(parts) == 4 else 1.0
        return Pulse(parts[0], float(acceleration(parts[1])), float(seconds(parts[2])), cycles)
    except ValueError as error:
        raise InputError(str(error), where="--pulse", hint="write for example 'half sine,0.4 g,0.5 s'") from None
