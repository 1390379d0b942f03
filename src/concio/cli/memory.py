"""What a command does to memory: freed pages are kept for its next factorisation, cycles are looked for less often.

The C library of Linux returns every large array to the system and fetches its pages again for the next one: a limit
load of 1,934 pairs, some thousand factorisations of the same size, spends a tenth of its time in that. Other systems,
and other C libraries, are left as they are. Python looks for cycles of objects after every 700 new ones; where they
are as few as here, that takes 5 per cent of a short command and finds nothing.
"""

from __future__ import annotations

import ctypes
import gc
import sys

TRIM, MMAP = -1, -3
"""Names of the two thresholds in ``malloc.h``."""

KEPT, LARGEST = 256 << 20, 32 << 20
"""Bytes kept at the end of the heap, and the largest array (the most that is granted) that comes from it."""

NEW_OBJECTS = 20_000
"""New objects after which Python looks for cycles."""


def keep_memory() -> None:
    """Raise the thresholds above which memory goes back to the system; do nothing where there are none."""
    if not sys.platform.startswith("linux"):
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(MMAP, LARGEST)
        mallopt(TRIM, KEPT)


def fewer_collections() -> None:
    """Let Python look for cycles of objects less often."""
    gc.set_threshold(NEW_OBJECTS, *gc.get_threshold()[1:])
