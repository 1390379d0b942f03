"""How many cases a test draws: a few in the quick suite, all of them wherever the tests marked long run, too."""

from __future__ import annotations

whole = True
"""Whether all are drawn; ``conftest`` says no where ``-m "not long"`` leaves the long tests out."""


def sample(few: int, every: int) -> int:
    """Return the number of cases to draw: ``few`` of them in the quick suite, ``every`` one in the whole."""
    return every if whole else few
