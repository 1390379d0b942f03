"""``concio limit FILE``: how much of a load the structure can carry, as a bracket."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from concio.cli.outcome import guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import progress_bar
from concio.cli.run import File, Json, UnitsOf, in_units

if TYPE_CHECKING:
    from concio.analysis.limit import LimitResult
    from concio.analysis.margins import Margin
    from concio.solvers.statics.friction import FrictionMargin

LARGEST_MARGIN = 10_000
"""Up to this number of pairs the friction margin is found unasked: it takes some twenty linear programmes."""


@guarded
def limit(
    file: File,
    group: Annotated[
        list[str] | None, typer.Option("--group", "-g", help="Load group that grows (repeatable); by default live.")
    ] = None,
    path: Annotated[bool, typer.Option("--path/--no-path", help="Follow the Coulomb load path too.")] = True,
    friction: Annotated[
        bool | None,
        typer.Option(
            "--friction/--no-friction", help="Find the smallest friction that holds; by default up to 10,000 pairs."
        ),
    ] = None,
    search: Annotated[
        bool | None,
        typer.Option("--search/--no-search", help="Search Coulomb collapse states; by default with --path."),
    ] = None,
    solves: Annotated[
        bool, typer.Option("--solves", help="Also bisect load and friction with solved load steps (some twenty).")
    ] = False,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for figures of the mechanisms.")] = None,
    units: UnitsOf = None,
    json: Json = False,
) -> int:
    """Find the load multiplier: the associated bound and the Coulomb load path, as a bracket, and the friction margin.

    Example: concio limit wall.toml --group live --out limit
    """
    import concio
    from concio.analysis.limit import friction_margin
    from concio.analysis.limit import limit as limit_of
    from concio.analysis.margins import friction_by_solving, load_margin
    from concio.cli.limit_files import write_limit

    groups = list(group or ["live"])
    if out is not None:
        check_directory(out)
    assembly = concio.assemble(in_units(concio.load(file), units))
    with progress_bar(shown=not json) as progress:
        found = limit_of(assembly, groups, path=path, search=search, progress=progress)
    wanted = len(assembly.pairs) <= LARGEST_MARGIN if friction is None else friction
    margin = friction_margin(assembly, groups) if wanted else None
    told = {"status": "solved" if found.associated.checked else "gave_up", "groups": groups, **found.summary()}
    if margin is not None:
        told |= {"friction_factor": _number(margin.factor), "friction_factor_below": _number(margin.below)}
    by_solving = []
    if solves:
        by_solving = [load_margin(assembly, groups), friction_by_solving(assembly, groups)]
        for name, solved in zip(("load", "friction"), by_solving, strict=True):
            told[f"{name}_holds_by_solving"] = _number(solved.holds)
            told[f"{name}_fails_by_solving"] = _number(solved.fails)
    written: list[str] = []
    if out is not None:
        with replaced_directory(out) as fresh:
            written = write_limit(found, groups, told, fresh)
    if json:
        print_json(told)
    else:
        for line in limit_lines(found, groups):
            say(line)
        if margin is not None:
            say(margin_line(margin))
        for name, solved in zip(("load", "friction"), by_solving, strict=False):
            say(solving_line(name, solved))
        if written:
            say(f"  written              {out}: {', '.join(written)}")
    return 0 if found.associated.checked else 4


def margin_line(margin: FrictionMargin) -> str:
    """Return the friction margin in words: it is that of admissible forces, hence a bound."""
    head = "  friction             "
    if margin.factor == 0:
        return f"{head}the load as given can be carried without any"
    if margin.factor == float("inf"):
        shown = margin.below > 0
        return f"{head}no friction carries the load as given" if shown else f"{head}undecided: no factor could be shown"
    if not margin.settled:
        low = f"{margin.below:.6g} is shown to be too little" if margin.below > 0 else "none is shown to be too little"
        return f"{head}{margin.factor:.6g} times the coefficients given is shown to do, {low}: undecided between"
    return f"{head}the load as given needs at least {margin.factor:.6g} times the coefficients given"


def solving_line(name: str, margin: Margin) -> str:
    """Return what bisection with solved load steps found, in words."""
    head = f"  {name + ', by solving':21s}"
    if margin.holds != margin.holds:
        return f"{head}no equilibrium was found with {'friction' if name == 'friction' else 'dead load'} as given"
    if margin.holds == float("inf"):
        return f"{head}no load is the last"
    found = f"{head}a certified Coulomb equilibrium at {margin.holds:.6g} times what is given"
    return found if margin.fails != margin.fails else f"{found}, none found at {margin.fails:.6g}"


def _number(value: float) -> float | None:
    """Return a number, or None for what JSON cannot say."""
    return value if abs(value) < float("inf") else None


def limit_lines(found: LimitResult, groups: list[str]) -> list[str]:
    """Return the bracket in words: two numbers, each with what it is and how it was checked."""
    import math

    bound, named = found.associated, "' and '".join(groups)
    lines = [found.assembly.model.title or "model without a title"]
    if math.isinf(bound.multiplier):
        return [*lines, f"  associated bound     locked: friction and geometry carry any multiple of '{named}'"]
    violation = bound.mechanism.violation if bound.mechanism else math.nan
    residuals = f"forces {bound.residual:.0e}, mechanism {violation:.0e}, gap {bound.gap:.0e}"
    if bound.checked or not bound.bounds_hold:
        state = "checked from both sides" if bound.checked else "NOT checked"
        lines += [
            f"  associated bound     {bound.multiplier:.6g}: no equilibrium beyond it",
            f"                       {state}: {residuals}",
        ]
    else:
        lines += [
            f"  associated bound     between {bound.multiplier:.9g}, carried, and {bound.upper:.9g}, not exceeded",
            f"                       each is checked, but they do not meet: {residuals}",
        ]
    if bound.multiplier > 0:
        lines.append(f"  margin               '{named}' as given is {1.0 / bound.multiplier:.4g} of that bound")
    state_line = collapse_line(found)
    if found.path is None:
        asked = bool(found.path_note) and found.path_note != "not asked for"
        lines += [f"  Coulomb load path    {found.path_note}"] if asked else []
        return [*lines, state_line] if state_line else lines
    lines += path_lines(found)
    if state_line:
        lines.append(state_line)
    least = "" if found.collapse_shown else ", the path having been lost there"
    lines.append(
        f"  in short             between {found.bracket[0]:.6g}{least} and {bound.multiplier:.6g} times the load of "
        f"'{named}'"
    )
    if found.lent_compliance:
        lines.append("  rigid joints         were followed with a vanishing compliance, as the limit of stiff joints")
    return lines


def collapse_line(found: LimitResult) -> str:
    """Return the collapse state in words, or why there is none; empty where none was asked for."""
    if found.collapse_state is not None:
        number = found.collapse_state.multiplier
        return f"  collapse state       {number:.6g}: there Coulomb friction lets it begin to move ({found.search})"
    return "" if found.search == "not asked for" else f"  collapse state       {found.search}"


def path_lines(found: LimitResult) -> list[str]:
    """Return the Coulomb path in words: a collapse multiplier where one is shown, else what is carried at least."""
    path = found.path
    assert path is not None
    end = {
        "REACHED": "followed on, its load no longer growing, until it had moved far",
        "MECHANISM": "a mechanism has formed that moves on without change of load",
        "LIMIT": "no certified state carries more, and the structure can move at that load or provably not carry it",
        "CANCELLED": "stopped on request",
        "TOO_MANY": "stopped after more events than allowed",
    }.get(path.outcome.name, "lost: no certified state was found further on")
    if found.collapse_shown:
        lines = [f"  Coulomb load path    collapses at {found.coulomb:.6g}, {len(path.events):,} events"]
    else:
        known = f"carries at least {found.carried:.6g}, {len(path.events):,} events; its collapse was not met"
        lines = [f"  Coulomb load path    {known}"]
    lines.append(f"                       {end}")
    if path.jumps:
        first = path.jumps[0].parameter
        lines.append(
            f"                       parts of the structure snap {len(path.jumps)} times, first at {first:.6g}"
        )
    return lines
