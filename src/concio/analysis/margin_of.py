"""What a margin is of: the structure, the loads that are multiplied, and what is reduced or grows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from concio.contact.assembly import Assembly
from concio.representation import short_repr


@short_repr
@dataclass(frozen=True, eq=False)
class MarginOf:
    """What a margin is of.

    Parameters
    ----------
    assembly : Assembly
    live : tuple of str
        Load groups that are multiplied, or that have a factor of their own.
    what : {"load", "friction"}
        What grows or falls.
    factor : float
        Load factor of the live groups where friction falls.
    """

    assembly: Assembly
    live: tuple[str, ...]
    what: Literal["load", "friction"]
    factor: float = 1.0
