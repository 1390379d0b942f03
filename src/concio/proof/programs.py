"""Which of the two checking programs reads a certificate: its claim says it."""

from __future__ import annotations

from typing import Any

from concio.proof import verify, verify_equilibrium


def recompute(data: Any) -> str:
    """Return what a certificate proves in a sentence.

    Parameters
    ----------
    data : object
        What a certificate file holds as JSON.

    Raises
    ------
    ValueError
        It proves nothing; an entry that is missing or of another kind raises what Python raises.
    """
    if not isinstance(data, dict):
        msg = "this is not a certificate"
        raise ValueError(msg)
    if data.get("claim") == "equilibrium":
        return verify_equilibrium.check(data)
    return verify.check(data)
