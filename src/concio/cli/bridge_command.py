"""``concio bridge FILE``: a vehicle on a masonry arch bridge, position by position."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any

import typer

from concio.cli.options import EngineOf, File, Json, Language, Quiet, UnitsOf, loaded, measured
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import progress_bar, verdict_so_far


@guarded
def bridge(
    file: File,
    required: Annotated[float, typer.Option("--required", help="Required load factor.")] = 1.0,
    step: Annotated[
        str | None, typer.Option("--step", help="Spacing of positions: '0.2 m'; default a 40th of a span.")
    ] = None,
    fine: Annotated[str, typer.Option("--fine", help="Spacing of positions near the worst one.")] = "10 mm",
    worst: Annotated[int, typer.Option("--worst", help="Number of worst positions with a Coulomb bracket.")] = 3,
    checked: Annotated[
        int, typer.Option("--checked", help="Positions checked with a Coulomb state; 0 leaves the answer open.")
    ] = 40,
    vehicle: Annotated[
        list[str] | None, typer.Option("--vehicle", "-v", help="Additional vehicle from the library (repeatable).")
    ] = None,
    second: Annotated[
        str | None, typer.Option("--second", help="A second vehicle together with the first: a name, or 'same'.")
    ] = None,
    apart: Annotated[
        str | None, typer.Option("--apart", help="Distances between the two: '8 m, 12 m, 16 m'.")
    ] = None,
    settle: Annotated[
        list[str] | None, typer.Option("--settle", help="A fixed block that settles: 'pier1 ground=10 mm'.")
    ] = None,
    sensitivity: Annotated[
        bool, typer.Option("--sensitivity/--no-sensitivity", help="Vary ring, fill, friction and strength.")
    ] = True,
    mexe_factor: Annotated[
        float | None, typer.Option("--mexe-factor", help="Span/rise factor of MEXE for flat arches.")
    ] = None,
    language: Language = "en",
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for report, curve and figures.")] = None,
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Find the load factor of a vehicle at every position on a bridge, the worst position, and the assumptions.

    Example: concio bridge bridge.toml --out result
    """
    import concio
    from concio.verdict.bridge_verdict import bridge_lines

    if out is not None:
        check_directory(out)
    model = loaded(file, units, engine)
    options: dict[str, Any] = {"required": required, "worst": worst, "checked": checked, "sensitivity": sensitivity}
    options |= {"step": None if step is None else measured(step, "length", "--step", file)}
    options |= {"fine": measured(fine, "length", "--fine", file), "others": tuple(vehicle or ())}
    distances = _distances(apart or "")
    options |= {"second": second, "apart": [measured(text, "length", "--apart", file) for text in distances]}
    options |= {"settled": dict(_settlement(text, file) for text in settle or ()), "span_rise": mexe_factor}
    with progress_bar(shown=not json) as progress:
        found = concio.assess_bridge(model, progress=progress, **options)
    told = {"status": found.verdict.status, **found.summary()}
    if not json:
        answer(bridge_lines(found))
    written: list[str] = []
    if out is not None:
        verdict_so_far(found.verdict)
        from concio.cli.bridge_files import write_bridge

        with replaced_directory(out) as fresh:
            written = write_bridge(found, told, fresh, language)
    if json:
        print_json(told)
    elif written:
        say(f"  written      {out}: {', '.join(written)}")
    return found.verdict.exit_code


def _distances(text: str) -> list[str]:
    """Return the distances of a list; a comma between two digits may be meant as a decimal one, and is refused."""
    from concio.errors import InputError
    from concio.units import DECIMAL_COMMA

    if re.search(r"\d,\d", text):
        msg = f"--apart {text!r} can be read in two ways"
        raise InputError(msg, hint=f"{DECIMAL_COMMA}; distances are separated by a comma and a space, '8 m, 12 m'")
    return [part.strip() for part in text.split(",") if part.strip()]


def _settlement(text: str, file: Path) -> tuple[str, float]:
    """Return the name of a fixed block and how far it settles [m]."""
    from concio.errors import InputError

    name, sign, far = text.rpartition("=")
    if not sign:
        msg = f"--settle {text!r} names no distance"
        raise InputError(msg, hint="write 'pier1 ground=10 mm'")
    return name.strip(), measured(far.strip(), "length", "--settle", file)
