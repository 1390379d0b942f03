"""``concio limit FILE``: how much of a load the structure can carry, as a bracket."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from concio.cli.options import EngineOf, File, Json, Language, Quiet, UnitsOf, loaded
from concio.cli.outcome import flush, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import found_so_far, on_the_way, progress_bar, verdict_so_far
from concio.problem.limits_of_work import LARGEST_MARGIN

if TYPE_CHECKING:
    from collections.abc import Sequence

    from concio.analysis.limit import LimitResult


@guarded
def limit(
    file: File,
    group: Annotated[
        list[str] | None, typer.Option("--group", "-g", help="Load group that grows (repeatable); by default live.")
    ] = None,
    path: Annotated[
        bool | None,
        typer.Option("--path/--no-path", help="Follow the exact Coulomb load path; by default up to 400 pairs."),
    ] = None,
    steps: Annotated[
        bool | None,
        typer.Option("--steps/--no-steps", help="Grow the load in certified steps; by default if no path is followed."),
    ] = None,
    friction: Annotated[
        bool | None,
        typer.Option(
            "--friction/--no-friction", help="Find the smallest friction that holds; by default up to 10,000 pairs."
        ),
    ] = None,
    search: Annotated[
        bool | None,
        typer.Option("--search/--no-search", help="Search Coulomb collapse states; by default unless --no-path."),
    ] = None,
    solves: Annotated[
        bool, typer.Option("--solves", help="Also bisect load and friction with solved load steps (about twenty).")
    ] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="The upper bound alone: no path, no steps, no search, no friction margin.")
    ] = False,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for figures of the mechanisms.")] = None,
    language: Language = "en",
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Find the load multiplier: the associated bound, what Coulomb friction is shown to carry, and the friction margin.

    The design value is printed first, then each number with its meaning. Ctrl-C stops the search and prints the numbers
    found so far. Where standard error is not a terminal, each number is printed there as soon as it is found.

    Example: concio limit wall.toml --group live --out limit
    """
    import concio
    from concio.analysis.limit import limit_stages
    from concio.analysis.margins import friction_by_solving, load_margin
    from concio.cli.limit_files import write_limit
    from concio.contact.assembly import as_assembly
    from concio.display import counted
    from concio.verdict.limit_words import limit_lines, solving_line, stage_lines

    if out is not None:
        check_directory(out)
    assembly = concio.assemble(loaded(file, units, engine))
    groups = _multiplied(file, group, as_assembly(assembly).groups)
    if not json:
        size = counted(len(assembly.model.free_bodies), "block"), counted(len(assembly.pairs), "contact pair")
        on_the_way([f"  {'model':<20} {' and '.join(size)}; the associated bound is sought first"])
    if quick:
        path, steps, search, friction = path or False, steps or False, search or False, friction or False
    wanted = len(assembly.pairs) <= LARGEST_MARGIN if friction is None else friction
    found: LimitResult | None = None

    def tell(lines: list[str]) -> None:
        for line in [] if json else lines:
            say(line)
        flush()

    known_lines: list[str] = []
    try:
        with progress_bar(shown=not json) as progress:
            stages = limit_stages(
                assembly, groups, path=path, steps=steps, search=search, friction=wanted, progress=progress
            )
            for name, known in stages:
                found = known
                latest = stage_lines(name, known)
                known_lines += latest
                found_so_far(known_lines, latest, shown=not json)
    except KeyboardInterrupt:
        if known_lines:
            tell(["Stopped: found until then, without a verdict:", *known_lines])
        raise
    assert found is not None  # the bound comes first, or an error
    verdict = found.verdict
    verdict_so_far(verdict)
    tell(limit_lines(found))
    told = {"status": verdict.status, "groups": groups, **found.summary()}
    if solves:
        for word, margin in (("load", load_margin), ("friction", friction_by_solving)):
            solved = margin(assembly, groups)
            told[f"{word}_holds_by_solving"] = solved.holds
            told[f"{word}_fails_by_solving"] = solved.fails
            tell([solving_line(word, solved)])
    if out is not None:
        with replaced_directory(out) as fresh:
            written = write_limit(found, told, fresh, language)
        tell([f"  written              {out}: {', '.join(written)}"])
    if json:
        print_json(told)
    return verdict.exit_code


def _multiplied(file: Path, asked: list[str] | None, known: Sequence[str]) -> list[str]:
    """Return the load groups to multiply, "live" where none is named; one that the model does not have is refused."""
    from concio.analysis.limit import LIVE
    from concio.arguments import closest
    from concio.errors import InputError

    if not asked and LIVE not in known:
        msg = f"there is no load group '{LIVE}', which is multiplied where --group names no other"
        hint = f"name one with --group ({', '.join(known) or 'there is none'}), or add [[loads]] with group = '{LIVE}'"
        raise InputError(msg, where=str(file), hint=hint)
    for name in asked or ():
        if name not in known:
            msg = f"there is no load group '{name}'"
            raise InputError(msg, where=str(file), hint=closest(name, known, names="groups"))
    return asked or [LIVE]
