"""``concio limit FILE``: how much of a load the structure can carry, as a bracket."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from concio.cli.outcome import guarded, print_json, say
from concio.cli.progress import progress_bar
from concio.cli.run import File, Json

if TYPE_CHECKING:
    from concio.analysis.limit import LimitResult


@guarded
def limit(
    file: File,
    group: Annotated[
        list[str] | None, typer.Option("--group", "-g", help="Load group that grows (repeatable); by default live.")
    ] = None,
    path: Annotated[bool, typer.Option("--path/--no-path", help="Follow the Coulomb load path too.")] = True,
    friction: Annotated[bool, typer.Option("--friction", help="Find the smallest friction that holds, too.")] = False,
    json: Json = False,
) -> int:
    """Find the load multiplier: the associated bound and the Coulomb load path, as a bracket.

    Example: concio limit wall.toml --group live
    """
    import concio
    from concio.analysis.limit import friction_margin
    from concio.analysis.limit import limit as limit_of

    groups = list(group or ["live"])
    assembly = concio.assemble(concio.load(file))
    with progress_bar(shown=not json) as progress:
        found = limit_of(assembly, groups, path=path, progress=progress)
    margin = friction_margin(assembly, groups) if friction else None
    if json:
        told = {"status": "solved" if found.associated.checked else "gave_up", "groups": groups, **found.summary()}
        if margin is not None:
            told |= {"friction_factor": margin.factor, "friction_factor_below": margin.below}
        print_json(told)
    else:
        for line in limit_lines(found, groups):
            say(line)
        if margin is not None:
            say(f"  friction             equilibrium needs at least {margin.factor:.6g} times the coefficients given")
    return 0 if found.associated.checked else 4


def limit_lines(found: LimitResult, groups: list[str]) -> list[str]:
    """Return the bracket in words: two numbers, each with what it is and how it was checked."""
    import math

    bound, named = found.associated, "' and '".join(groups)
    lines = [found.assembly.model.title or "model without a title"]
    if math.isinf(bound.multiplier):
        return [*lines, f"  associated bound     none: friction and geometry carry any multiple of '{named}'"]
    state = "checked from both sides" if bound.checked else "NOT checked"
    violation = bound.mechanism.violation if bound.mechanism else math.nan
    lines += [
        f"  associated bound     {bound.multiplier:.6g}: no equilibrium beyond it",
        f"                       {state}: forces {bound.residual:.0e}, mechanism {violation:.0e}, gap {bound.gap:.0e}",
    ]
    if found.path is None:
        return lines
    lines += [
        f"  Coulomb load path    {found.coulomb:.6g} at its peak, {len(found.path.events):,} events; the first point "
        f"with no way on under growing load is {found.first_limit:.6g}",
        f"  it ended             {found.path.outcome.value}",
        f"  in short             between {min(found.first_limit, found.coulomb):.6g} and {bound.multiplier:.6g} times "
        f"the load of '{named}'",
    ]
    if found.lent_compliance:
        lines.append(f"  rigid joints         were lent a compliance of {found.lent_compliance:.1e} m/kN for the path")
    return lines
