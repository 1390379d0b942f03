"""``concio diagnose FILE``: from cracks to cause."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from concio.cli.options import EngineOf, File, Json, Quiet, UnitsOf, in_units
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import progress_bar

if TYPE_CHECKING:
    from concio.analysis.cracks.diagnosis import Diagnosis

MOST_LINES = 8
"""More lines of one kind than this are counted; the report holds all."""


@guarded
def diagnose(
    file: File,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for the report and the numbers.")] = None,
    language: Annotated[
        str | None, typer.Option("--language", "-l", help="Language of text and report, en or it; else the file's.")
    ] = None,
    most: Annotated[int | None, typer.Option("--most", help="Maximum number of motions tried together.")] = None,
    steps: Annotated[int | None, typer.Option("--steps", help="Load steps, if the path is followed in steps.")] = None,
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Find which motions of supports, or changes of loads, explain the cracks that the file states in [survey].

    The exit code is 0 where one cause explains the measurements, 3 where none of the candidates does, 4 where several
    do, a measurement is in doubt, or something was not followed.

    Example: concio diagnose facade.toml --out diagnosis --language it
    """
    import concio
    from concio.analysis.cracks.diagnosis_asked import read_survey
    from concio.report.language import words_of

    if language is not None:
        words_of("diagnosis_words", language)
    if out is not None:
        check_directory(out)
    asked = read_survey(file)
    model = in_units(asked.model, units)
    model = model if engine is None else replace(model, engine=engine)
    given = {"most": most, "steps": steps}
    options = {**asked.options, **{k: v for k, v in given.items() if v is not None}}
    with progress_bar(shown=not (json or quiet)) as progress:
        found = concio.diagnose(model, asked.measurements, asked.candidates, progress=progress, **options)
    told, spoken = found.summary(), language or asked.head.get("language", "en")
    if not json:
        answer(diagnose_lines(found, spoken))
    written: list[str] = []
    if out is not None:
        from concio.cli.diagnose_files import write_diagnosis

        with replaced_directory(out) as fresh:
            written = write_diagnosis(found, told, fresh, spoken, asked.head)
    if json:
        print_json(told)
    elif written:
        say(f"  {words_of('diagnosis_words', spoken)['written']:<13}{out}: {', '.join(written)}")
    return found.verdict.exit_code


def diagnose_lines(found: Diagnosis, language: str = "en") -> list[str]:
    """Return what a diagnosis found, in words: the verdict, then every measurement beside what is predicted."""
    from concio.report.diagnosis_page import DiagnosisReport
    from concio.verdict.diagnosis_verdict import diagnosis_verdict
    from concio.verdict.verdict import WIDTH

    page = DiagnosisReport(found, language, {})
    verdict = diagnosis_verdict(found, language, write=page.n)
    lines = [found.model.title] if found.model.title else []
    lines += [verdict.headline, verdict.sentence]
    for line in (*verdict.lines(found.model.report, indent="", most=MOST_LINES), f"{'proof':<{WIDTH}}{verdict.proof}"):
        head, entry = line[:WIDTH].strip().replace(" ", "_"), line[WIDTH:]
        lines.append(f"  {page.words[head]:<{WIDTH}}{page.told(entry)}")
    best = found.best
    if best is not None:
        for m, p, r in zip(found.measurements, best.predicted, best.residual, strict=True):
            size = max(abs(m.value), abs(float(p)), m.error)
            values = [page.quantity(m.quantity, m.rounded(float(v)), size) for v in (m.value, p)]
            lines.append(f"  {m.name:<12} {values[0]:>10} | {values[1]:<10} {page.n(float(r), 2)}")
    return lines
