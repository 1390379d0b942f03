"""``concio settle FILE``: all loads, then supports move, with what supports and fixed bodies carry meanwhile."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from concio.cli.options import EngineOf, File, Json, Language, Quiet, UnitsOf, loaded
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import progress_bar, verdict_so_far


@guarded
def settle(
    file: File,
    group: Annotated[
        str | None,
        typer.Option(
            "--group", "-g", help="Load group of the supports that move; by default settlement, or else the only one."
        ),
    ] = None,
    amount: Annotated[
        float, typer.Option("--amount", "-a", help="Factor of the displacements and rotations of the file at the end.")
    ] = 1.0,
    method: Annotated[
        Literal["events", "steps"] | None,
        typer.Option("--method", "-m", help="events (exact, plane models, default) or steps (always in space)."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Directory for report, reactions, curve and events.")
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="List every event.")] = False,
    language: Language = "en",
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Apply all loads, then move supports, event by event, and list the reactions against the movement.

    What moves is stated in the file: supports with a displacement or a rotation. All other load groups act with
    factor 1 first, and remain.

    The exit code is 0 where the whole movement was imposed, 3 where the structure is shown to collapse on the way, 4
    where the movement could not be followed to its end.

    Example: concio settle arch.toml --amount 2 --out settled
    """
    import concio
    from concio.analysis.settlement import moved_groups
    from concio.cli.settle_lines import settle_facts, settle_lines, write_settlement

    if out is not None:
        check_directory(out)
    model = loaded(file, units, engine)
    groups = moved_groups(model)
    chosen = group or (groups[0] if len(groups) == 1 else "settlement")
    with progress_bar(shown=not json) as progress:
        found = concio.settle(model, chosen, amount=amount, method=method, progress=progress)
    verdict_so_far(found.verdict)
    if not json:
        answer(settle_lines(found, every=every))
    written: list[str] = []
    if out is not None:
        with replaced_directory(out) as fresh:
            written = write_settlement(found, fresh, language)
    if json:
        print_json(settle_facts(found))
    elif written:
        say(f"  written      {out}: {', '.join(written)}")
    return found.verdict.exit_code
