"""``concio``: the commands and what all of them have in common."""

from __future__ import annotations

import sys

import typer

from concio.cli import check, compare, export, limit, new, path, run, schema, study, view

app = typer.Typer(
    name="concio",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help=(
        "Masonry of blocks held together by contact and friction: answers that prove themselves.\n\n"
        "Start:  concio new panel  |  concio check panel.toml  |  concio run panel.toml --out result"
    ),
    epilog=(
        "Exit codes: 0 solved, 2 bad input, 3 no equilibrium (proved), 4 gave up or undecided, 130 interrupted, "
        "1 anything else."
    ),
)


def _version(value: bool) -> None:
    if value:
        from concio import __version__

        typer.echo(f"concio {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: bool = typer.Option(False, "--version", callback=_version, is_eager=True, help="Print the version."),
) -> None:
    pass


app.command("new")(new.new)
app.command("check")(check.check)
app.command("run")(run.run)
app.command("path")(path.path)
app.command("limit")(limit.limit)
app.command("compare")(compare.compare)
app.command("study")(study.study)
app.command("view")(view.view)
app.command("export")(export.export)
app.command("schema")(schema.schema)


def main() -> None:
    """Run the command line and leave with its exit code."""
    try:
        app()
    except KeyboardInterrupt:
        sys.stderr.write("Stopped.\n")
        sys.exit(130)
