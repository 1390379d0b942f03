"""``concio run FILE``: solve one load step."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from concio.cli.options import EngineOf, Factors, File, Json, Language, Out, Quiet, UnitsOf, factors_of, in_units
from concio.cli.outcome import answer, guarded, print_json
from concio.cli.output import check_directory
from concio.cli.progress import being_written, progress_bar, verdict_so_far

if TYPE_CHECKING:
    from concio.analysis.motion.let_go import LetGo
    from concio.analysis.result import Result
    from concio.problem.solution import ProgressCallback


@guarded
def run(
    file: File,
    out: Out = None,
    method: Annotated[str, typer.Option("--method", "-m", help="Solver by name.")] = "auto",
    language: Language = "en",
    engine: EngineOf = None,
    factor: Factors = None,
    json: Json = False,
    quiet: Quiet = False,
    units: UnitsOf = None,
    let_go: Annotated[
        bool,
        typer.Option(
            "--let-go", help="If the step remains undecided, release the structure at rest and follow its motion."
        ),
    ] = False,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw figures into --out.")] = True,
) -> int:
    """Solve one load step and print the result.

    Example: concio run panel.toml --out result
    """
    import concio
    from concio.cli.lines import result_lines

    if out is not None:
        check_directory(out)
    model = in_units(concio.load(file), units)
    chosen = {} if engine is None else {"engine": engine}
    with progress_bar(shown=not json) as progress:
        result = concio.solve(
            model, method=method, factors=factors_of(factor), on_failure="return", progress=progress, **chosen
        )
        followed = _followed(result, progress) if let_go else None
    verdict = result.verdict if followed is None else followed.verdict
    verdict_so_far(verdict)
    if not json:
        answer(result_lines(result))
        if followed is not None:
            answer([f"  let go: {verdict.status}. {verdict.sentence}", *verdict.lines(model.report)])
        elif let_go:
            answer(["  let go: not released, as the load step is decided"])
    written: list[Path] = []
    if out is not None:
        from concio.io.result_dir import write_result

        def beside(place: Path) -> list[Path]:
            from concio.cli.let_go_files import write_let_go

            return [] if followed is None else write_let_go(followed, place, language)

        if not json:
            being_written(out)
        written = write_result(result, out, figures=figures, language=language, beside=beside)
    if json:
        print_json((followed or result).summary())
    else:
        answer(where_written(written))
    return verdict.exit_code


def _followed(result: Result, progress: ProgressCallback | None) -> LetGo | None:
    """Return what a structure does that is let go; None where its load step is decided."""
    import concio
    from concio.problem.solution import Status

    undecided = result.status in (Status.UNDECIDED, Status.GAVE_UP)
    return concio.let_go(result, progress=progress) if undecided else None


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
