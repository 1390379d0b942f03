"""Runs the command line in the process of the tests."""

from __future__ import annotations

from typer.testing import CliRunner

from concio.cli.main import app


def run(*arguments: object) -> tuple[int, str, str]:
    """Return exit code, standard output and standard error of a command."""
    found = CliRunner().invoke(app, [str(a) for a in arguments])
    return found.exit_code, found.stdout, found.stderr
