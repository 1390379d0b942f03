"""Memory that a command has given back is kept for its next factorisation.

The C library of Linux returns every large array to the system and fetches its pages again for the next one: a limit
load of 1,934 pairs, some thousand factorisations of the same size, spends a tenth of its time in that. Other systems,
and other C libraries, are left as they are.
"""

from __future__ import annotations

import ctypes
import sys

TRIM, MMAP = -1, -3
"""Names of the two thresholds in ``malloc.h``."""

KEPT, LARGEST = 256 << 20, 32 << 20
"""Bytes kept at the end of the heap, and the largest array (the most that is granted) that comes from it."""


def keep_memory() -> None:
    """Raise the thresholds above which memory goes back to the system; do nothing where there are none."""
    if not sys.platform.startswith("linux"):
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(MMAP, LARGEST)
        mallopt(TRIM, KEPT)
