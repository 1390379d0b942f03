"""``concio run FILE``: solve one load step."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from concio.cli.outcome import guarded, print_json, say
from concio.cli.output import check_directory
from concio.cli.progress import progress_bar

if TYPE_CHECKING:
    from concio.model.model import Model
    from concio.solvers.algebra.sparse_factor import Engine

File = Annotated[Path, typer.Argument(help="Model file (TOML).", show_default=False)]
Out = Annotated[Path | None, typer.Option("--out", "-o", help="Directory for figures, report and numbers.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing; the exit code tells.")]
UnitsOf = Annotated[
    str | None,
    typer.Option("--units", help="Units of texts, figures and reports: 'N, mm, MPa'; by default those of the file."),
]
EngineOf = Annotated[
    Literal["superlu", "pardiso"] | None,
    typer.Option("--engine", help="Engine of linear systems: superlu or pardiso; by default that of the file."),
]
Factors = Annotated[
    list[str] | None, typer.Option("--factor", "-f", help="Factor of a load group: live=1.5 (repeatable).")
]


@guarded
def run(
    file: File,
    out: Out = None,
    method: Annotated[str, typer.Option("--method", "-m", help="Solver by name.")] = "auto",
    engine: EngineOf = None,
    factor: Factors = None,
    json: Json = False,
    quiet: Quiet = False,
    units: UnitsOf = None,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw figures into --out.")] = True,
) -> int:
    """Solve one load step and say what was found.

    Example: concio run panel.toml --out result
    """
    import concio
    from concio.cli.lines import result_lines

    if out is not None:
        check_directory(out)
    model = in_units(concio.load(file), units)
    chosen = {} if engine is None else {"engine": engine}
    with progress_bar(shown=not (json or quiet)) as progress:
        result = concio.solve(
            model, method=method, factors=factors_of(factor), on_failure="return", progress=progress, **chosen
        )
    written: list[Path] = []
    if out is not None:
        from concio.io.result_dir import write_result

        written = write_result(result, out, figures=figures)
    if json:
        print_json(result.summary())
    elif not quiet:
        for line in result_lines(result):
            say(line)
        for line in where_written(written):
            say(line)
    return result.verdict.exit_code


def loaded(file: Path, units: str | None = None, engine: Engine | None = None) -> Model:
    """Return the model of a file, told in the units of ``--units`` and solved by ``--engine``, where there are any.

    Raises
    ------
    InputError
        The file is no model, or an option says nothing.
    """
    from dataclasses import replace

    import concio

    model = in_units(concio.load(file), units)
    return model if engine is None else replace(model, engine=engine)


def in_units(model: Model, units: str | None) -> Model:
    """Return the model told in the units of ``--units``, where there are any.

    Raises
    ------
    InputError
        A part of the text is no unit.
    """
    from dataclasses import replace

    from concio.display import Units
    from concio.errors import InputError

    if units is None:
        return model
    try:
        return replace(model, report=Units.parse(units))
    except InputError as error:
        raise InputError(error.what, where="--units", hint=error.hint) from None


def factors_of(texts: list[str] | None) -> dict[str, float]:
    """Return load factors from texts such as ``live=1.5``.

    Raises
    ------
    InputError
        A text is not of that form.
    """
    from concio.errors import InputError
    from concio.units import quantity

    factors = {}
    for text in texts or ():
        group, sign, value = text.partition("=")
        if not sign or not group.strip():
            msg = f"'{text}' is not a factor of a load group"
            raise InputError(msg, where="--factor", hint="write for example --factor live=1.5")
        factors[group.strip()] = quantity(value, "number", where=f"--factor {group.strip()}")
    return factors


def where_written(paths: list[Path]) -> list[str]:
    """Return lines that say which files were written: the report first, figures in one line."""
    if not paths:
        return []
    lines = []
    reports = [p for p in paths if p.suffix == ".html"]
    figures = [p for p in paths if p.suffix in (".png", ".svg", ".pdf")]
    others = [p for p in paths if p not in reports and p not in figures]
    lines += [f"  report       {p}" for p in reports]
    if figures:
        names = ", ".join(dict.fromkeys(p.stem for p in figures))
        lines.append(f"  figures      {figures[0].parent}: {names}")
    if others:
        lines.append(f"  numbers      {others[0].parent}: {', '.join(p.name for p in others)}")
    return lines
