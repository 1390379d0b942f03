"""``concio check FILE``: what was read, what is wrong, where."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from concio.cli.options import File, Json, Quiet, UnitsOf, in_units
from concio.cli.outcome import guarded, print_json, say
from concio.cli.output import PICTURES, check_file, replaced_file

if TYPE_CHECKING:
    from concio.model.interfaces.detect import Detection
    from concio.model.model import Model


@guarded
def check(
    file: File,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Picture of the model to write: .png, .svg or .pdf.")
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="List every finding and every body.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Check a model file: print its contents and its faults, without solving.

    Example: concio check wall.toml --out wall.png
    """
    from concio.analysis.seismic.assessment_asked import check_site
    from concio.cli.check_lines import check_facts, check_lines
    from concio.contact.assembly import assemble
    from concio.contact.detection import detect
    from concio.errors import ConcioError
    from concio.model.file.reading import model_of_file, read_tables
    from concio.verdict.question import resultants

    if out is not None:
        _check_picture(out, force=force)
    path = Path(file)
    data = read_tables(path)  # once: it may be standard input
    model = in_units(model_of_file(data, path), units)
    detection = detect(model)
    fault: ConcioError | None = None
    facts: dict[str, Any] = {}
    try:
        assembly = assemble(model)
        facts = {
            "pairs": len(assembly.pairs),
            "contact_model": assembly.pairs.contact_model,
            "unknowns": assembly.disc.unknowns,
            "total_load": resultants(assembly),
        }
    except ConcioError as error:
        fault = error
    if out is not None:
        _draw(model, detection, out)
    if not json:
        for line in check_lines(model, detection, facts, every=every, fault=fault.what if fault else ""):
            say(line)
        if out is not None:
            say(f"picture      {out}")
    if fault is not None:
        raise fault
    check_site(data, path)
    if json:
        print_json({"status": "ok", **check_facts(model, detection), **facts})
    return 0


def _check_picture(out: Path, *, force: bool) -> None:
    from concio.errors import InputError

    if out.suffix not in PICTURES:
        msg = f"a picture ends in .png, .svg or .pdf, not in '{out.suffix}'"
        raise InputError(msg, where="--out", hint=f"write for example --out {out.stem}.png")
    check_file(out, force=force)


def _draw(model: Model, detection: Detection, out: Path) -> None:
    import numpy as np
    from matplotlib.figure import Figure

    from concio.plot.model_figure import plot_model
    from concio.plot.space_figures import directions, plot_space_model

    axes = plot_model(model) if model.dim == 2 else plot_space_model(model)
    seen = np.eye(2) if model.dim == 2 else np.array(directions("axonometry")[:2])
    for things, mark, word in ((detection.overlaps, "X", "overlap"), (detection.near_misses, "o", "near miss")):
        if things:
            at = np.array([t.at for t in things])
            x, y = seen @ at.T
            axes.plot(x, y, mark, mec="#c1272d", mfc="none", ms=9, label=word, ls="")
    figure = axes.figure
    assert isinstance(figure, Figure)
    with replaced_file(out) as fresh:
        figure.savefig(fresh, dpi=150, metadata=PICTURES[out.suffix][0])
