"""``concio export DIR --to vtu``: a result in the format of another program."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from concio.cli.outcome import guarded, note, say
from concio.cli.output import check_directory, check_file, replaced_directory, replaced_file
from concio.errors import InputError

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.model.model import Array


NAMES = {"vtu": "vtu", "csv": "csv", "toml": "model.toml"}
"""What is written where no name is given; everything else is a displaced shape."""


@guarded
def export(
    directory: Annotated[Path, typer.Argument(help="Directory that 'concio run --out' wrote.", show_default=False)],
    to: Annotated[
        Literal["vtu", "csv", "dxf", "toml", "obj", "stl", "glb", "json", "3dm"],
        typer.Option("--to", "-t", help="Format."),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Directory (vtu, csv) or file (all others) to write.")
    ] = None,
    scale: Annotated[
        float | None,
        typer.Option("--scale", help="Scale of displacements, default 1; 0 draws the model as it was."),
    ] = None,
    unit: Annotated[
        str | None, typer.Option("--unit", help="Unit of a drawing; default that of the drawing read, else m.")
    ] = None,
    results: Annotated[
        bool, typer.Option("--results", help="In a DXF drawing: the undeformed model, with results on separate layers.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> int:
    """Write a result for ParaView (vtu), spreadsheets (csv), drawing programs (dxf), or its model (toml).

    In space also obj, stl, glb (glTF), json (COMPAS) and 3dm. A dxf, obj, stl, glb or 3dm file holds the displaced
    blocks alone: no loads, supports or ties; --results adds joints, forces and ties to a plane drawing.

    Numbers are in kN and m, whatever the units of the model file; a drawing has the unit of --unit.

    Example: concio export result --to vtu
    """
    from concio.io.listing import CONTENTS
    from concio.io.owned_dir import add_own
    from concio.io.result_file import load_result

    target = out if out is not None else directory / NAMES.get(to, "results.dxf" if results else f"deformed.{to}")
    result = load_result(directory)
    _check_results(result, to, results=results)
    _check_options(result, to, target, scale=scale, unit=unit)
    if to in ("vtu", "csv"):
        check_directory(target)
        with replaced_directory(target) as fresh:
            written = [target / path.relative_to(fresh) for path in _write_tables(result, to, fresh)]
        add_own(directory, [*written, target / CONTENTS])
    else:
        check_file(target, force=force)
        with replaced_file(target) as fresh:
            if results:
                from concio.io.dxf_results import write_results_dxf

                write_results_dxf(fresh, result, scale=scale, unit=unit)
            else:
                _write_file(result, to, fresh, 1.0 if scale is None else scale, unit)
        written = [target]
        add_own(directory, written)
    for path in written:
        say(str(path))
    if not (result.solved or results or to == "toml" or scale == 0.0):
        note(_without_an_answer(result, to, 1.0 if scale is None else scale))
    return 0


def _without_an_answer(result: Result, to: str, scale: float) -> str:
    """Return in two sentences what the files of a result hold that is not solved."""
    if to in ("vtu", "csv"):
        held = "Displacements, stresses and forces are left out"
        held += "; 'velocity' is the mechanism." if to == "vtu" and result.mechanism is not None else "."
    elif result.mechanism is not None:
        times = "" if scale == 1 else f"{scale:g} times "
        held = f"The blocks are displaced by {times}the velocities of the mechanism [m]."
    else:
        held = "The blocks are displaced as in the last iteration, which is no answer."
    return f"{result.status.value} {held}"


def _check_results(result: Result, to: str, *, results: bool) -> None:
    """Raise where layers of results are asked for and cannot be drawn."""
    if results and (to != "dxf" or result.model.dim == 3):
        msg = "--results draws layers into a DXF drawing of a plane model"
        hint = "write --to dxf" if to != "dxf" else "in space, --to vtu has joints with their forces and states"
        raise InputError(msg, where=f"--to {to}", hint=hint)


def _check_options(result: Result, to: str, target: Path, *, scale: float | None, unit: str | None) -> None:
    """Raise where an option would be left aside, and where the name of a file of solids says another format."""
    where = f"--to {to}"
    if scale is not None and not math.isfinite(scale):
        msg = f"--scale {scale:g} is not a finite number"
        raise InputError(msg, hint="give what displacements are multiplied by")
    if unit is not None and (to != "dxf" or result.model.dim == 3):
        msg = "--unit is that of a DXF drawing of a plane model; all else is written in m"
        raise InputError(msg, where=where, hint="leave it out")
    if scale is not None and to in ("vtu", "csv", "toml"):
        msg = "--scale is that of displaced shapes, which this format does not hold"
        hint = "leave it out" + (": ParaView scales displacements by 'Warp By Vector'" if to == "vtu" else "")
        raise InputError(msg, where=where, hint=hint)
    solids = to not in ("vtu", "csv", "toml") and (to != "dxf" or result.model.dim == 3)
    if solids and target.suffix.lower() != f".{to}":
        msg = f"'{target.name}' does not end in .{to}"
        raise InputError(msg, where=where, hint=f"write --out {target.stem}.{to}")


def _write_tables(result: Result, to: str, place: Path) -> list[Path]:
    if to == "vtu":
        from concio.io.paraview import write_paraview

        return write_paraview(result, place)
    from concio.io.csv_table import write_csv
    from concio.post.tables_of import tables_of

    return [write_csv(table, place / f"{name}.csv") for name, table in tables_of(result).all().items()]


def _write_file(result: Result, to: str, fresh: Path, scale: float, unit: str | None) -> None:
    if to == "toml":
        from concio.model.file.writing import dumps

        fresh.write_text(dumps(result.model), encoding="utf-8")
        return
    if to != "dxf" or result.model.dim == 3:
        from concio.io.solids_out import write_solids

        write_solids(fresh, result, scale=scale)
        return
    from concio.io.dxf_out import layer_of, unit_of, write_dxf
    from concio.post.outlines import outlines

    bodies = result.model.outlines
    drawn: list[Sequence[Array]] = [body.rings for body in bodies]
    if scale:
        drawn = [[ring[:-1] for ring in rings] for rings in outlines(result).moved(scale)]
    write_dxf(
        fresh,
        [body.name for body in bodies],
        [rings[0] for rings in drawn],
        layers=[layer_of(result.model, body) for body in bodies],
        unit=unit or unit_of(result.model),
        holes=[rings[1:] for rings in drawn],
    )
