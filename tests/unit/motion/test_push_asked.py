"""Which block is said to move away, and how many go with it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis.motion.push_asked import what_moves


@pytest.mark.parametrize(
    ("moved", "words", "names"),
    [
        ([0, 0, 0, 0, 0, 0], "", ()),
        ([0, 0, -3, 0, 0.2, 0], ": 'b' moves away", ("b",)),
        ([0.5, 0, -3, 0, 0.2, 0], ": 'b' moves away, and 1 other", ("b", "a")),
        ([-0.5, 0, 1, 0, 0.2, -4], ": 'c' moves away, and 2 others", ("c", "a", "b")),
        ([0, 0, 0, 0, 0.4, 4], ": 'c' moves away", ("c",)),
    ],
)
def test_blocks_that_move_by_a_tenth_of_the_first_go_with_it(
    moved: list[float], words: str, names: tuple[str, ...]
) -> None:
    model = SimpleNamespace(bodies=[SimpleNamespace(name=n) for n in "abcd"])
    disc = SimpleNamespace(offsets=np.array([0, 2, 4, 6, 6]))
    reference = SimpleNamespace(model=model, disc=disc, free=np.array([0, 1, 2]))
    assert what_moves(reference, SimpleNamespace(moved=np.array(moved, dtype=float))) == (words, names)
