"""An outcome in words, as the report of a load path shows it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Verdict:
    """An outcome in words.

    Parameters
    ----------
    tone : {"good", "bad", "unsure"}
    headline : str
    meaning : str
    next_steps : tuple of str
    """

    tone: str
    headline: str
    meaning: str
    next_steps: tuple[str, ...]
