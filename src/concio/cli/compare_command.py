"""``concio compare FILE``: one problem, all methods, one certificate."""

from __future__ import annotations

from typing import Annotated

import typer

from concio.cli.options import Factors, File, Json, Quiet, UnitsOf, factors_of, in_units
from concio.cli.outcome import guarded, print_json, say
from concio.cli.progress import progress_bar


@guarded
def compare(
    file: File,
    methods: Annotated[
        str | None, typer.Option("--methods", help="Names separated by commas; default all.")
    ] = None,
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds for each method.")] = 60.0,
    factor: Factors = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Solve the problem of 'concio run' by several methods, and print one table.

    The exit code is that of 'concio run'.

    Every method gets the problem that ``run`` solves: hard joints between rigid blocks with the same vanishing
    compliance, each connected part by itself.

    Example: concio compare panel.toml --methods lemke,uzawa,admm
    """
    import concio
    from concio.analysis.lent_compliance import lend
    from concio.contact.assembly import as_assembly
    from concio.errors import InputError
    from concio.solvers.algebra.threads import one_thread
    from concio.solvers.methods import find
    from concio.studies.compare import compare as compared
    from concio.studies.compare import format_table

    names = None if methods is None else [name.strip() for name in methods.split(",") if name.strip()]
    if names is not None and not names:
        msg = "--methods names no method"
        raise InputError(msg, hint="give names separated by commas, or leave it out for all methods")
    for name in names or ():
        find(name)
    model = in_units(concio.load(file), units)
    assembly = as_assembly(model)
    with one_thread(), progress_bar(shown=not json) as progress:
        result = concio.solve(assembly, factors=factors_of(factor), on_failure="return", progress=progress)
        lent = lend(result.assembly)
        problem = lent.problem(result.factors)  # the one that 'concio run' decides
        table = compared(
            problem, names, time_limit=time_limit, progress=progress, title=model.title or str(file),
            decided=result.verdict,
        )  # fmt: skip
    if json:
        print_json({**table.as_dict(), "lent_compliance": lent.lent_compliance})
    else:
        verdict = table.verdict
        for line in (verdict.sentence, *verdict.lines(model.report), "", format_table(table)):
            say(line)
        if lent.lent_compliance:
            say(f"  compliance of {lent.lent_compliance:.3g} m/kN added to hard joints between rigid blocks, as in "
            "'concio run'")
    return table.verdict.exit_code
