"""``concio verify CERTIFICATE``: recompute an exact certificate without rounding."""

from __future__ import annotations

import json as json_text
from pathlib import Path
from typing import Annotated

import typer

from concio.cli.options import Json, Quiet
from concio.cli.outcome import guarded, print_json, say


@guarded
def verify(
    certificate: Annotated[Path, typer.Argument(help="Certificate that 'concio prove' wrote.", show_default=False)],
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Recompute an exact certificate with Python's fractions; exit code 2 where it proves nothing.

    The warnings about the model that 'concio prove' stored are printed as well.

    The check is done by two short programs in src/concio/proof that import nothing from concio and can be run alone:
    verify.py, and verify_equilibrium.py for the claim of an equilibrium with its displacements.

    Example: concio verify wall.proof.json
    """
    from concio.errors import InputError
    from concio.proof.programs import recompute

    try:
        data = json_text.loads(certificate.read_text(encoding="ascii"))
        sentence = recompute(data)
        noted = [str(line) for line in data.get("attention", [])]
    except OSError as error:
        msg = f"cannot be read: {error.strerror or error}"
        raise InputError(msg, where=str(certificate)) from None
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        msg = f"refused: {error}"
        raise InputError(msg, where=str(certificate), hint="make it again with 'concio prove'") from None
    if json:
        print_json({"certificate": str(certificate), "sentence": sentence, "attention": noted})
    else:
        say(sentence)
        for line in noted:
            say(f"  attention    {line}")
    return 0
