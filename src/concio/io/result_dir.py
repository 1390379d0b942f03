"""The result directory: everything a run leaves behind, all of it or nothing.

| file | what |
|---|---|
| summary.json | the numbers people ask for first |
| result.json, result.npz | the whole result; :func:`concio.io.load_result` gives the same object back |
| model.toml | the model, to read and to run again |
| bodies.csv, joints.csv, contacts.csv, reactions.csv | tables with units |
| figures/ | every figure that suits the outcome, PNG and SVG |
| report.html | one file to open, to mail, to keep |
| concio.json | which of the files in the directory are concio's |

Everything is written into a hidden directory first and moved into place when it is complete; what belongs to concio is
listed in ``concio.json`` (:mod:`concio.io.owned_dir`). An interruption or a full disk therefore leaves what was there
before, and nothing that concio did not write is ever touched.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from concio.arguments import strict
from concio.io.csv_table import write_csv
from concio.io.owned_dir import owned_directory
from concio.io.result_file import save_result
from concio.model.file.writing import dumps

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result


@strict
def write_result(
    result: Result,
    directory: Path | str,
    *,
    figures: bool = True,
    report: bool = True,
    language: Literal["en", "it"] = "en",
    beside: Callable[[Path], list[Path]] | None = None,
) -> list[Path]:
    """Write a result directory; what an earlier run wrote there is replaced, anything else stays.

    Parameters
    ----------
    result : Result
    directory : Path or str
    figures, report : bool
        Whether to draw the figures and to write the HTML report.
    language : {"en", "it"}
        Of the report.
    beside : callable, optional
        Writes what was found beside the result into the directory it is given, and returns the files.

    Returns
    -------
    list of Path
        The files, in the order written.

    Raises
    ------
    InputError
        The place is taken by something that concio did not write, or that was changed since.
    ConcioError
        It cannot be written, for instance because the disk is full.
    """
    directory = Path(directory)
    with owned_directory(directory) as fresh:
        written = _write_all(result, fresh, figures, report, language)
        written += beside(fresh) if beside is not None else []
    return [directory / path.relative_to(fresh) for path in written]


def _write_all(
    result: Result, place: Path, figures: bool, report: bool, language: Literal["en", "it"]
) -> list[Path]:
    summary = place / "summary.json"
    text = json.dumps(result.summary(), indent=2, ensure_ascii=False, allow_nan=False)
    summary.write_text(text + "\n", encoding="utf-8")
    model = place / "model.toml"
    model.write_text(dumps(result.model), encoding="utf-8")
    written = [summary, model, *save_result(result, place)]
    tables = result.tables.all() if result.solved else {"bodies": result.tables.bodies()}
    written += [write_csv(table, place / f"{name}.csv") for name, table in tables.items()]
    drawn: list[str] = []
    if figures:
        from concio.plot.figures import write_figures
        from concio.report.html_parts import LARGEST_SVG
        from concio.report.page import captioned

        folder = place / "figures"
        folder.mkdir()

        def into_the_report(name: str, axes: Axes) -> None:
            drawing = folder / f"{name}.svg"
            drawn.append(captioned(name, axes, language, dots=drawing.stat().st_size > LARGEST_SVG))

        written += write_figures(result, folder, then=into_the_report if report else None)
    if report:
        from concio.report.page import report_of

        page = place / "report.html"
        page.write_text(report_of(result, drawn if figures else None, language), encoding="utf-8")
        written.append(page)
    return written
