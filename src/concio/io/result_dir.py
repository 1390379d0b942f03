"""The result directory: everything a run leaves behind, all of it or nothing.

| file | what |
|---|---|
| summary.json | the numbers people ask for first |
| result.json, result.npz | the whole result; :func:`concio.io.load_result` gives the same object back |
| model.toml | the model, to read and to run again |
| bodies.csv, joints.csv, contacts.csv, reactions.csv | tables with units |
| figures/ | every figure that suits the outcome, PNG and SVG |
| report.html | one file to open, to mail, to keep |

Everything is written into a directory beside the wanted one, which takes its place at the end by renaming. An
interruption or a full disk therefore leaves what was there before, untouched.
"""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from concio.arguments import strict
from concio.errors import ConcioError, InputError
from concio.io.csv_table import write_csv
from concio.io.result_file import save_result
from concio.model.file.writing import dumps
from concio.post.tables import Tables

if TYPE_CHECKING:
    from concio.analysis.result import Result


@strict
def write_result(result: Result, directory: Path | str, *, figures: bool = True, report: bool = True) -> list[Path]:
    """Write a result directory; one that is there from an earlier run is replaced.

    Parameters
    ----------
    result : Result
    directory : Path or str
    figures, report : bool
        Whether to draw the figures and to write the HTML report.

    Returns
    -------
    list of Path
        The files, in the order written.

    Raises
    ------
    InputError
        The place is taken by something that is not a result directory.
    ConcioError
        It cannot be written, for instance because the disk is full.
    """
    directory = Path(directory)
    _check_free(directory)
    partial = directory.with_name(f".{directory.name}.{os.getpid()}.partial")
    try:
        partial.parent.mkdir(parents=True, exist_ok=True)
        if partial.exists():
            shutil.rmtree(partial)
        partial.mkdir()
        written = _write_all(result, partial, figures, report)
        _put_in_place(partial, directory)
    except OSError as error:
        shutil.rmtree(partial, ignore_errors=True)
        msg = f"the result cannot be written: {error.strerror or error}"
        hint = "choose another place with --out; nothing was changed"
        raise ConcioError(msg, where=str(directory), hint=hint) from error
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise
    return [directory / path.relative_to(partial) for path in written]


def _write_all(result: Result, place: Path, figures: bool, report: bool) -> list[Path]:
    summary = place / "summary.json"
    text = json.dumps(result.summary(), indent=2, ensure_ascii=False, allow_nan=False)
    summary.write_text(text + "\n", encoding="utf-8")
    model = place / "model.toml"
    model.write_text(dumps(result.model), encoding="utf-8")
    written = [summary, model, *save_result(result, place)]
    tables = Tables(result).all() if result.solved else {"bodies": Tables(result).bodies()}
    written += [write_csv(table, place / f"{name}.csv") for name, table in tables.items()]
    if figures:
        from concio.plot.figures import write_figures

        folder = place / "figures"
        folder.mkdir()
        written += write_figures(result, folder)
    if report:
        from concio.report.page import write_report

        written.append(write_report(result, place / "report.html"))
    return written


def _check_free(directory: Path) -> None:
    if not directory.exists():
        return
    if not directory.is_dir():
        msg = "there is a file of this name"
        raise InputError(msg, where=str(directory), hint="choose another directory for the result")
    if any(directory.iterdir()) and not (directory / "summary.json").is_file():
        msg = "the directory holds other files, and no result that could be replaced"
        raise InputError(msg, where=str(directory), hint="choose an empty or new directory for the result")


def _put_in_place(partial: Path, directory: Path) -> None:
    old = partial.with_suffix(".old")
    if directory.exists():
        directory.rename(old)
    try:
        partial.rename(directory)
    except OSError:
        if old.exists():
            old.rename(directory)
        raise
    shutil.rmtree(old, ignore_errors=True)
