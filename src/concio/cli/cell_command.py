"""``concio cell FILE``: a periodic cell homogenised: moduli, strength, response to strains and stresses."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from concio.cli.options import EngineOf, File, Json, Quiet, UnitsOf, loaded, measured
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import progress_bar

if TYPE_CHECKING:
    from concio.analysis.cells.cell_path_result import CellPath
    from concio.analysis.cells.moduli import Moduli
    from concio.analysis.cells.periodic_cell import PeriodicCell
    from concio.analysis.cells.strength import StrengthDomain
    from concio.model.stages import Stage


@guarded
def cell(
    file: File,
    direction: Annotated[
        list[str] | None,
        typer.Option("--direction", "-d", help="Direction of stress: xx=1,yy=-1 (repeatable)."),
    ] = None,
    stress: Annotated[
        str | None, typer.Option("--stress", help="Stress from which the directions start: yy=-100 [kN/m2].")
    ] = None,
    stage: Annotated[
        list[str] | None,
        typer.Option("--stage", "-s", help="Stage of a path: 'stress yy=-100,strain xy=1e-3' (repeatable, in order)."),
    ] = None,
    strength: Annotated[bool, typer.Option("--strength/--no-strength", help="Compute the strength domain.")] = True,
    coulomb: Annotated[
        bool, typer.Option("--coulomb/--no-coulomb", help="Coulomb path and collapse state in each direction.")
    ] = True,
    programmes: Annotated[int, typer.Option("--programmes", help="Maximum number of linear programmes.")] = 400,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for tables and figures.")] = None,
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Homogenise a periodic cell: moduli, strength domain, and its response to macroscopic strains and stresses.

    The stages of the file, or those given, are followed as a path; components are xx, yy, xy, tension is positive.

    The exit code is 0, or for a path as of 'concio path'.

    Example: concio cell cell.toml --stress yy=-100 --direction xy=1 --out result
    """
    from concio.analysis.cells.cell_path import strain_path
    from concio.analysis.cells.periodic_cell import PeriodicCell
    from concio.analysis.cells.strength import strength as strength_of
    from concio.cli.cell_files import write_cell
    from concio.cli.cell_lines import cell_facts, cell_lines
    from concio.errors import InputError
    from concio.verdict.cell_verdict import cell_verdict

    if out is not None:
        check_directory(out)
    directions = [components(text, "--direction") for text in direction or ()]
    base = components(stress, "--stress", file) if stress is not None else (0.0, 0.0, 0.0)
    model = loaded(file, units, engine)
    if model.periods is None:
        msg = "this model is not a periodic cell"
        hint = "start from: concio new cell; or give the blocks of a model periods = [[x1, y1], [x2, y2]]"
        raise InputError(msg, where=str(file), hint=hint)
    asked = [stage_of(text, k, file) for k, text in enumerate(stage or (), 1)] or list(model.stages)
    own = PeriodicCell.of(model)
    moduli, none = _moduli(own)
    domain: StrengthDomain | None = None
    path: CellPath | None = None
    with progress_bar(shown=not json) as progress:
        if strength or directions:
            domain = strength_of(
                own, directions, stress=base, coulomb=coulomb, faces=strength, programmes=programmes, progress=progress
            )
        if asked:
            path = strain_path(own, asked, progress=progress)
    if not json:
        answer(cell_lines(own, moduli, domain, path, none=none))
    written: list[str] = []
    if out is not None:
        with replaced_directory(out) as fresh:
            written = write_cell(own, moduli, domain, path, fresh)
    if json:
        print_json(cell_facts(own, moduli, domain, path, none=none))
    elif written:
        say(f"  written      {out}: {', '.join(written)}")
    return cell_verdict(own, moduli, domain, path, none=none).exit_code


def _moduli(cell: PeriodicCell) -> tuple[Moduli | None, str]:
    """Return the moduli, or None and why there are none."""
    from concio.analysis.cells.moduli import homogenise
    from concio.errors import InputError

    try:
        return homogenise(cell), ""
    except InputError as error:
        return None, error.what


def components(text: str, where: str, file: Path | None = None) -> tuple[float, float, float]:
    """Return a stress from a text such as ``xx=1,yy=-50 kPa``; components that are not named are zero.

    Without a ``file`` it is a direction, of any size.

    Raises
    ------
    InputError
        The text is not of that form.
    """
    from concio.contact.macroscopic_strain import COMPONENTS
    from concio.errors import InputError
    from concio.units import quantity

    values = dict.fromkeys(COMPONENTS, 0.0)
    for part in text.split(","):
        name, sign, value = part.partition("=")
        if not sign or name.strip() not in COMPONENTS:
            msg = f"'{part}' is not a component of a stress"
            raise InputError(msg, where=where, hint=f"write for example {where} xx=1,yy=-0.5; components xx, yy, xy")
        number = value.strip()
        values[name.strip()] = (
            quantity(number, "stress", where=where) if file is None else measured(number, "stress", where, file)
        )
    return values["xx"], values["yy"], values["xy"]


def stage_of(text: str, number: int, file: Path) -> Stage:
    """Return a stage of a path from a text such as ``stress yy=-100,strain xy=1e-3``.

    Raises
    ------
    InputError
        The text is not of that form.
    """
    from concio.errors import InputError
    from concio.model.stages import Stage

    factors = {}
    for part in text.split(","):
        name, sign, value = part.partition("=")
        word = " ".join(name.split())
        if not sign or not word:
            msg = f"'{part}' is neither a strain nor a stress"
            raise InputError(msg, where="--stage", hint="write for example --stage 'stress yy=-100,strain xy=1e-3'")
        factors[word] = measured(value.strip(), "stress" if word.startswith("stress ") else "number", "--stage", file)
    return Stage(f"{number}: {text}", factors)
