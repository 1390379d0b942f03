"""``concio schema``: the JSON Schema of model files, or of what ``--json`` prints."""

from __future__ import annotations

import json
from typing import Annotated, Literal

import typer

from concio.cli.outcome import guarded, say


@guarded
def schema(
    of: Annotated[
        Literal["model", "output"], typer.Argument(help="Model files, or what commands print with --json.")
    ] = "model",
) -> int:
    """Print the JSON Schema of model files, or of what commands print with --json.

    Example: concio schema > concio.schema.json
    """
    if of == "output":
        from importlib.resources import files

        say(files("concio.cli").joinpath("output_schema.json").read_text(encoding="utf-8").rstrip())
        return 0
    from concio.model.file.file_table import json_schema

    say(json.dumps(json_schema(), indent=2, ensure_ascii=False))
    return 0
