"""``concio``: the commands and what all of them have in common."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import typer
from typer.core import TyperCommand

from concio.cli import memory, outcome
from concio.cli.assess_command import assess
from concio.cli.bridge_command import bridge
from concio.cli.cell_command import cell
from concio.cli.check_command import check
from concio.cli.compare_command import compare
from concio.cli.continuum_command import continuum
from concio.cli.diagnose_command import diagnose
from concio.cli.export_command import export
from concio.cli.limit_command import limit
from concio.cli.new_command import new
from concio.cli.path_command import path
from concio.cli.prove_command import prove
from concio.cli.push_command import push
from concio.cli.run_command import run
from concio.cli.schema_command import schema
from concio.cli.settle_command import settle
from concio.cli.shake_command import shake
from concio.cli.study_command import study
from concio.cli.verify_command import verify
from concio.cli.view_command import view
from concio.cli.window_command import window

EXIT_CODES = (
    "Exit codes: 0 what was asked for is shown, 2 bad input, 3 it is shown not to hold, 4 it is left open (not "
    "reached, not checked, undecided, still moving), 130 interrupted, 1 any other error."
)

HELP = (
    "Masonry of blocks held together by contact and friction: results with an independent certificate.\n\n"
    "Start:  concio new panel  |  concio check panel.toml  |  concio run panel.toml --out result"
)

COMMANDS = (
    new, check, run, path, settle, limit, push, shake, cell, continuum, assess, diagnose, bridge, prove, verify,
    compare, study, view, window, export, schema,
)  # fmt: skip


def _version(value: bool) -> None:
    if value:
        from concio import __version__

        typer.echo(f"concio {__version__}")
        raise typer.Exit


def _common(
    version: bool = typer.Option(False, "--version", callback=_version, is_eager=True, help="Print the version."),
) -> None:
    pass


class Command(TyperCommand):
    """A command whose messages about arguments have no word of the library that checks them."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments.

        Raises
        ------
        typer.BadParameter
            One of them is wrong.
        """
        try:
            return super().parse_args(ctx, args)
        except typer.BadParameter as error:
            error.message = error.message.removeprefix("Value error, ")
            raise


def command_line(commands: Iterable[Callable[..., object]]) -> typer.Typer:
    """Return the command line with these commands."""
    line = typer.Typer(
        name="concio",
        no_args_is_help=True,
        add_completion=True,
        rich_markup_mode="markdown",
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
        help=HELP,
        epilog=EXIT_CODES,
    )
    line.callback()(_common)
    for command in commands:
        line.command(command.__name__, cls=Command, epilog=EXIT_CODES)(command)
    return line


app = command_line(COMMANDS)


def asked_of(arguments: Sequence[str]) -> typer.Typer:
    """Return the command line with the command that is asked for alone, or all of it where none is.

    The options of every command take longer to build than some models to solve.
    """
    named = [command for command in COMMANDS if command.__name__ in arguments[:1]]
    return command_line(named) if named else app


def main() -> None:
    """Run the command line and leave with its exit code."""
    if _open_closed() and not {"--quiet", "-q"} & set(sys.argv):
        sys.stderr.write("Error: standard output: it is closed\n  -> send it somewhere: > file, or > /dev/null\n")
        sys.exit(2)
    memory.keep_memory()
    memory.fewer_collections()
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # it reads every installed package to find any
    try:
        asked_of(sys.argv[1:])()
    except KeyboardInterrupt:
        sys.stderr.write("Stopped.\n")
        sys.exit(130)
    except OSError as error:  # help and version are printed by typer itself
        outcome.silence()
        if not isinstance(error, BrokenPipeError):
            sys.stderr.write(f"Error: standard output: cannot be written to: {error.strerror or error}\n")
        sys.exit(0 if isinstance(error, BrokenPipeError) else 2)
    finally:
        try:
            sys.stdout.flush()
        except OSError:
            outcome.silence()


def _open_closed() -> bool:
    """Return whether standard output is closed.

    Closed ones of the three are opened to nowhere: otherwise the next file would get their numbers, and what a library
    prints would go into it.
    """
    found = sys.stdout is None
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    if sys.stdout is None:
        sys.stdout = os.fdopen(os.dup(1), "w")
    if sys.stderr is None:
        sys.stderr = os.fdopen(os.dup(2), "w")
    return found
