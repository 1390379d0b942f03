"""What to do after a path, for every way in which it may end."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from concio.analysis.path_loads import GroupLoad
from concio.solvers.path.record import Outcome as Ended
from concio.verdict.path_verdict import _load_words, _next_steps
from concio.verdict.verdict import Outcome


@pytest.mark.parametrize(
    ("outcome", "told", "words"),
    [
        (Outcome.FAILS, {"short": True}, "last step in the view"),
        (Outcome.INCOMPLETE, {"short": True}, "Without a control point"),
        (Outcome.INCOMPLETE, {"ended": Ended.BROKEN}, "Delete the tie"),
        (Outcome.INCOMPLETE, {}, "--stage dead=1"),
        (Outcome.INCOMPLETE, {"complete": False}, "'--method steps'"),
        (Outcome.INCOMPLETE, {"certified": False}, "'--method steps'"),
        (Outcome.UNDECIDED, {"complete": False, "certified": False}, "'--method steps'"),
        (Outcome.HOLDS, {}, "not how far it is from collapse"),
        (Outcome.HOLDS, {"complete": False, "certified": False}, "not how far it is from collapse"),
    ],
)
def test_next_steps_follow_from_how_a_path_ended(outcome: Outcome, told: dict[str, object], words: str) -> None:
    found = {"short": False, "complete": True, "certified": True, "ended": Ended.REACHED} | told
    path = SimpleNamespace(outcomes=[Ended.REACHED, found.pop("ended")], **found)
    assert words in " ".join(_next_steps(path, outcome))


@pytest.mark.parametrize(
    ("begin", "asked", "end", "words"),
    [
        (0.0, 1.0, 1e-17, "live = 0 of 1"),
        (2.0, 0.0, 1e-17, "live = 0"),
        (0.0, 1.0, 0.25, "live = 0.25 of 1"),
        (1.0, -1.0, -1.0, "live = -1"),
    ],
)
def test_rounding_of_a_load_is_no_load(begin: float, asked: float, end: float, words: str) -> None:
    assert _load_words(GroupLoad("live", begin, asked, end, end)) == words
