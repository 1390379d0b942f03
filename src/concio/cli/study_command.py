"""``concio study FILE``: many runs of one model."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from concio.cli.options import File, Json, Language, Quiet
from concio.cli.outcome import QUIET, guarded, print_json, say
from concio.cli.output import replaced_file
from concio.cli.progress import duration

if TYPE_CHECKING:
    from concio.studies.study import Progress, StudyProgress
    from concio.studies.study_result import StudyResult


WRITTEN = ("table.csv", "report.html")
"""What is written beside the rows when a sitting ends."""


@guarded
def study(
    file: File,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Directory for rows and report; by default FILE-study.")
    ] = None,
    workers: Annotated[int | None, typer.Option("--workers", "-w", help="Number of worker processes.")] = None,
    scheduler: Annotated[
        str | None, typer.Option("--scheduler", help="Address of a Dask scheduler, tcp://HOST:PORT, or 'local'.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Resume the study in --out.")] = False,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw figures into the report.")] = True,
    language: Language = "en",
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Run the study that the table [study] of a model file defines; each row is written when its run ends.

    Example: concio study wall.toml --workers 2
    """
    import concio
    from concio.errors import InputError
    from concio.io.csv_table import write_csv
    from concio.io.owned_dir import add_own, is_own
    from concio.model.file.reading import STDIN
    from concio.report.study_page import write_study_report

    if out is None and file == STDIN:
        msg = "a model from standard input has no name for its directory"
        raise InputError(msg, hint="give one with --out")
    directory = out if out is not None else file.with_name(f"{file.stem}-study")
    for name in WRITTEN:
        if (directory / name).exists() and not is_own(directory / name):
            msg = "there is a file of that name that concio did not write, or that was changed since"
            raise InputError(msg, where=str(directory / name), hint="move it, or give another directory with --out")
    executor = "dask" if scheduler == "local" else scheduler
    with study_bar(shown=not json) as progress:
        found = concio.study(
            file, directory=directory, executor=executor, workers=workers, resume=resume, progress=progress
        )
    table, report = (directory / name for name in WRITTEN)
    with replaced_file(table) as fresh:
        write_csv(found.table(), fresh, units={})
    title = f"Study of {file.name}" if language == "en" else f"Studio di {file.name}"
    with replaced_file(report) as fresh:
        write_study_report(found, fresh, title=title, figures=figures, language=language)
    add_own(directory, [table, report], begin=True)
    if json:
        print_json({"status": found.verdict.status, **found.summary()})
    else:
        for line in study_lines(found, directory):
            say(line)
    return found.verdict.exit_code


def study_lines(found: StudyResult, directory: Path) -> list[str]:
    """Return what a study found, in words."""
    from concio.verdict.study_verdict import WORDS, output_words, required_words

    verdict = found.verdict
    of = "" if len(found) == len(found.sample) else f" of {len(found.sample)}"
    lines = [f"{len(found)}{of} runs, {found.sample.design} sample, seed {found.sample.seed}", verdict.headline]
    lines += [f"  {line}" for line in verdict.lines(indent="")]
    if found.stopped:
        lines.append("  stopped early: the stopping criterion was met")
    lines += [f"  {WORDS.get(word, word.replace('_', ' ')):22s} {n}" for word, n in found.verdicts.items()]
    lines += [f"  {o.name:22s} {output_words(found, o)}" for o in found.outputs]
    index = required_words(found)
    lines += [f"  required               {index}"] if index else []
    failed = found.failures
    if failed:
        lines.append(f"  {len(failed)} runs have a fault; the first: run {failed[0].index}, {failed[0].message}")
    lines.append(f"  report                 {directory / 'report.html'}")
    lines.append(f"  table                  {directory / 'table.csv'}")
    return lines


@contextmanager
def study_bar(*, shown: bool) -> Iterator[Progress | None]:
    """Give a callback that moves a bar with the time left, or None where there is nobody to see it."""
    if not shown or QUIET.get() or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("runs", total=None)

        def move(state: StudyProgress) -> None:
            failed = f", {state.failed} without an answer" if state.failed else ""
            text = f"runs{failed}, {duration(state.seconds_left)} left"
            bar.update(task, completed=state.done, total=state.total, description=text)

        yield move
