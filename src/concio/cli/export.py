"""``concio export DIR --to vtu``: a result in the format of another program."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from concio.cli.outcome import guarded, say
from concio.cli.output import check_writable, replaced_file

if TYPE_CHECKING:
    from concio.analysis.result import Result


@guarded
def export(
    directory: Annotated[Path, typer.Argument(help="Directory that 'concio run --out' wrote.", show_default=False)],
    to: Annotated[Literal["vtu", "csv", "dxf", "toml"], typer.Option("--to", "-t", help="Format.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Directory (vtu, csv) or file (dxf, toml) to write.")
    ] = None,
    scale: Annotated[float, typer.Option("--scale", help="Scale of the displacements of a drawing.")] = 1.0,
) -> int:
    """Write a result for ParaView (vtu), spreadsheets (csv), drawing programs (dxf), or its model (toml).

    Example: concio export result --to vtu
    """
    from concio.io.result_file import load_result

    target = out if out is not None else directory / {"dxf": "deformed.dxf", "toml": "model.toml"}.get(to, to)
    result = load_result(directory)
    check_writable(target)
    for path in _write(result, to, target, scale):
        say(str(path))
    return 0


def _write(result: Result, to: str, target: Path, scale: float) -> list[Path]:
    if to == "vtu":
        from concio.io.paraview import write_paraview

        return write_paraview(result, target)
    if to == "csv":
        from concio.io.csv_table import write_csv
        from concio.post.tables import Tables

        target.mkdir(parents=True, exist_ok=True)
        return [write_csv(table, target / f"{name}.csv") for name, table in Tables(result).all().items()]
    if to == "toml":
        from concio.model.file.writing import save

        save(result.model, target)
        return [target]
    return [_write_drawing(result, target, scale)]


def _write_drawing(result: Result, target: Path, scale: float) -> Path:
    from concio.io.dxf_out import write_dxf
    from concio.post.outlines import outlines

    drawn = outlines(result)
    points = drawn.points + scale * drawn.displacement
    closed = [points[a : b - 1] for a, b in pairwise(drawn.starts.tolist())]
    bodies = result.model.bodies
    layers = ["FIXED" if body.kind == "fixed" else (body.layer or body.material or "BLOCKS") for body in bodies]
    with replaced_file(target) as fresh:
        write_dxf(fresh, [body.name for body in bodies], closed, layers=layers)
    return target
