"""What commands have in common: options that mean one thing everywhere, and the model they name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

if TYPE_CHECKING:
    from concio.model.model import Model
    from concio.problem.contact_problem import Engine

File = Annotated[Path, typer.Argument(help="Model file (TOML); - reads standard input.", show_default=False)]
Out = Annotated[Path | None, typer.Option("--out", "-o", help="Directory for figures, report and numbers.")]
Language = Annotated[Literal["en", "it"], typer.Option("--language", "-l", help="Language of the report.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing; only the exit code is set.")]
UnitsOf = Annotated[
    str | None,
    typer.Option("--units", help="Units of texts, figures and reports: 'N, mm, MPa'; by default those of the file."),
]
EngineOf = Annotated[
    Literal["superlu", "pardiso"] | None,
    typer.Option("--engine", help="Solver of linear systems: superlu or pardiso; by default that of the file."),
]
Factors = Annotated[
    list[str] | None, typer.Option("--factor", "-f", help="Factor of a load group: live=1.5 (repeatable).")
]


def loaded(file: Path, units: str | None = None, engine: Engine | None = None) -> Model:
    """Return the model of a file, reported in the units of ``--units`` and solved by ``--engine``, where there are any.

    Raises
    ------
    InputError
        The file is not a model, or an option says nothing.
    """
    from dataclasses import replace

    import concio

    model = in_units(concio.load(file), units)
    return model if engine is None else replace(model, engine=engine)


def in_units(model: Model, units: str | None) -> Model:
    """Return the model reported in the units of ``--units``, where there are any.

    Raises
    ------
    InputError
        A part of the text is not a unit.
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
        A text is not of that form, or a group has two factors.
    """
    from concio.errors import InputError
    from concio.units import quantity

    factors: dict[str, float] = {}
    for text in texts or ():
        group, sign, value = text.partition("=")
        if not sign or not group.strip():
            msg = f"'{text}' is not a factor of a load group"
            raise InputError(msg, where="--factor", hint="write for example --factor live=1.5")
        name = group.strip()
        if name in factors:
            msg = f"two factors are given for the load group '{name}'"
            raise InputError(msg, where=f"--factor {name}", hint="give one: factors do not multiply each other")
        factors[name] = quantity(value, "number", where=f"--factor {name}")
    return factors


def measured(text: str, kind: str, where: str, file: Path) -> float:
    """Return a quantity of the command line [kN, m]; a bare number where the file has a system of its own is refused.

    Raises
    ------
    InputError
        Not a quantity of this kind, or a number without a unit that the file would read otherwise.
    """
    from concio.errors import InputError
    from concio.model.file.reading import STDIN, file_units, read_tables
    from concio.units import SYMBOL, is_bare, quantity

    value = quantity(text, kind, where=where)
    if not value or kind == "number" or not is_bare(text):
        return value
    if file == STDIN:
        msg = f"'{text}' has no unit, and a file from standard input may have units of its own"
        raise InputError(msg, where=where, hint=f"write for example '{text} {SYMBOL[kind]}'")
    tables = read_tables(file)
    if file_units(tables, str(file)).factor(kind) == 1.0:
        return value
    msg = f"'{text}' has no unit, and {file} has units of its own"
    length = tables["units"].get("length", "m")
    unit = length if kind == "length" else f"{tables['units'].get('force', 'kN')}/{length}2"
    raise InputError(msg, where=where, hint=f"write '{text} {unit}', or another unit")
