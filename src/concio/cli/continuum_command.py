"""``concio continuum FILE``: a wall of blocks compared with its homogenised continuum, side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from concio.cli.options import EngineOf, Factors, File, Json, Quiet, UnitsOf, factors_of, loaded, measured
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import progress_bar


@guarded
def continuum(
    file: File,
    cell: Annotated[
        Path | None, typer.Option("--cell", "-c", help="File of the cell; by default the cell of the wall's bond.")
    ] = None,
    group: Annotated[
        list[str] | None, typer.Option("--group", "-g", help="Load group that grows (repeatable); by default live.")
    ] = None,
    halve: Annotated[int, typer.Option("--halve", help="Halve the blocks this many times at fixed outline.")] = 0,
    mesh_size: Annotated[
        str | None, typer.Option("--mesh-size", help="Mesh size of the continuum: '0.2 m'; default an eighth of the "
        "wall.")
    ] = None,
    factor: Factors = None,
    elastic: Annotated[bool, typer.Option("--elastic/--no-elastic", help="Compare elastic solutions.")] = True,
    strength: Annotated[bool, typer.Option("--strength/--no-strength", help="Compare limit loads.")] = True,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for tables and figures.")] = None,
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Solve a wall block by block and as a homogenised continuum, and compare the two.

    The exit code is 0, or 4 where something was not solved or not proven.

    Example: concio continuum wall.toml --halve 2 --out twin
    """
    import concio
    from concio.analysis.continuum.comparison import ContinuumComparison
    from concio.analysis.continuum.halving import BlockHalving
    from concio.cli.continuum_files import write_continuum
    from concio.cli.continuum_lines import continuum_facts, continuum_lines
    from concio.cli.halved import halved_file
    from concio.errors import InputError
    from concio.verdict.continuum_verdict import continuum_verdict

    if out is not None:
        check_directory(out)
    if not 0 <= halve <= 6:
        msg = f"--halve {halve} is not between 0 and 6"
        raise InputError(msg, hint="each halving has four times as many blocks")
    if not (elastic or strength):
        msg = "neither elastic answers nor limit loads are to be compared"
        raise InputError(msg, hint="leave out --no-elastic or --no-strength")
    if halve and factor:
        msg = "--factor does not go with --halve"
        raise InputError(msg, hint="write the loads into the file as they are to act")
    size = None if mesh_size is None else measured(mesh_size, "length", "--mesh-size", file)
    own = None if cell is None else concio.load(cell)
    live = tuple(group) if group else None
    found: ContinuumComparison
    halving: BlockHalving | None = None
    with progress_bar(shown=not json) as progress:
        if halve:
            make = halved_file(file, units, engine)
            halving = concio.halve_blocks(
                make, own, sizes=[2**k for k in range(halve + 1)], live=live, mesh_size=size, elastic=elastic,
                strength=strength, progress=progress,
            )  # fmt: skip
            found = halving.comparisons[0]
        else:
            found = concio.compare_with_continuum(
                loaded(file, units, engine), own, factors=factors_of(factor), live=live, mesh_size=size,
                elastic=elastic, strength=strength, progress=progress,
            )  # fmt: skip
    if not json:
        answer(continuum_lines(found, halving))
    written: list[str] = []
    if out is not None:
        with replaced_directory(out) as fresh:
            written = write_continuum(found, halving, fresh)
    if json:
        print_json(continuum_facts(found, halving))
    elif written:
        say(f"  written      {out}: {', '.join(written)}")
    return continuum_verdict(found, halving).exit_code
