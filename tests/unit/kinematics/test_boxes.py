"""Boxes that meet: against comparing all with all."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from concio.kinematics.boxes import boxes_meeting, meeting_boxes
from samples import sample


@settings(max_examples=sample(30, 300), deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([2, 3]), st.integers(0, 40))
def test_all_pairs_of_boxes_that_meet_are_found_once(seed, dim, count):
    """Boxes of very different sizes, many of which touch or are points."""
    rng = np.random.default_rng(seed)
    low = np.round(rng.uniform(0.0, 3.0, (count, dim)), 1)
    size = rng.exponential(0.3, (count, dim)) * rng.choice([0.0, 1.0, 30.0], (count, 1))
    high = low + np.round(size, 1)
    meet = ((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2)
    assert np.array_equal(meeting_boxes(low, high), np.nonzero(np.triu(meet, 1)))
    k = count // 2
    assert np.array_equal(boxes_meeting(low[:k], high[:k], low[k:], high[k:]), np.nonzero(meet[:k, k:]))
