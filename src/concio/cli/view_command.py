"""``concio view DIR``: open the report of a result."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from concio.cli.outcome import guarded, say


@guarded
def view(
    directory: Annotated[Path, typer.Argument(help="Directory that 'concio run --out' wrote.", show_default=False)],
    show: Annotated[bool, typer.Option("--open/--no-open", help="Open it in the browser.")] = True,
) -> int:
    """Open the HTML report of a result in the browser.

    Example: concio view result
    """
    import webbrowser

    from concio.errors import InputError

    report = directory / "report.html" if directory.is_dir() else directory
    if report.suffix != ".html" or not report.is_file():
        msg = "there is no report.html here"
        raise InputError(msg, where=str(directory), hint="write one with: concio run FILE --out DIR")
    say(str(report))
    if show and not webbrowser.open(report.absolute().as_uri()):
        say("No browser could be started; open this file in a browser.")
    return 0
