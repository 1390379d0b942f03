"""``concio new panel``: a commented model file to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from concio.cli.outcome import guarded, say
from concio.cli.output import check_file, replaced_file

Kind = Literal[
    "panel", "wall", "arch", "column", "cell", "assessment", "motion", "blocks", "arch_on_piers", "bridge", "arcade",
    "walls", "tower", "barrel", "dome", "cloister_vault", "cross_vault", "drums", "blocks_in_space",
]  # fmt: skip


@guarded
def new(
    kind: Annotated[Kind, typer.Argument(help="Kind of structure.", show_default=False)],
    file: Annotated[
        Path | None, typer.Argument(help="File to write; by default KIND.toml.", show_default=False)
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> int:
    """Write a commented model file to start from.

    Example: concio new arch bridge.toml
    """
    from importlib.resources import files

    target = file if file is not None else Path(f"{kind}.toml")
    check_file(target, force=force)
    text = files("concio.model").joinpath("templates", f"{kind}.toml").read_text(encoding="utf-8")
    with replaced_file(target) as fresh:
        fresh.write_text(text, encoding="utf-8")
    say(f"Wrote {target}. Edit it, then: concio check {target}")
    return 0
