"""``concio compare FILE``: one problem, all methods, one certificate."""

from __future__ import annotations

from typing import Annotated

import typer

from concio.cli.outcome import guarded, print_json, say
from concio.cli.progress import progress_bar
from concio.cli.run import Factors, File, Json, factors_of


@guarded
def compare(
    file: File,
    methods: Annotated[
        str | None, typer.Option("--methods", "-m", help="Names separated by commas; default all.")
    ] = None,
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds for each method.")] = 60.0,
    factor: Factors = None,
    json: Json = False,
) -> int:
    """Solve one model by several methods and print one table.

    Example: concio compare panel.toml --methods lemke,uzawa,admm
    """
    import concio
    from concio.contact.assembly import as_assembly
    from concio.solvers.algebra.sparse_factor import factorised_by
    from concio.studies.compare import compare as compared
    from concio.studies.compare import format_table

    names = None if methods is None else [name.strip() for name in methods.split(",") if name.strip()]
    model = concio.load(file)
    problem = as_assembly(model).problem(factors_of(factor))
    with factorised_by(model.engine), progress_bar(shown=not json) as progress:
        table = compared(problem, names, time_limit=time_limit, progress=progress, title=model.title or str(file))
    if json:
        print_json(table.as_dict())
    else:
        say(format_table(table))
    return 0
