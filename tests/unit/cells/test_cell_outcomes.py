"""Which stage of a cell decides its outcome: the last one that was begun, however many there are."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from concio.solvers.path.record import Outcome as Ended
from concio.verdict.cell_verdict import _outcome
from concio.verdict.verdict import Outcome


@pytest.mark.parametrize("stages", [1, 2, 3, 4])
@pytest.mark.parametrize(
    ("last", "wanted"),
    [(Ended.LIMIT, Outcome.FAILS), (Ended.MECHANISM, Outcome.FAILS), (Ended.LOST, Outcome.INCOMPLETE),
     (Ended.CANCELLED, Outcome.INCOMPLETE)],
)  # fmt: skip
def test_the_last_stage_decides(stages: int, last: Ended, wanted: Outcome) -> None:
    path = SimpleNamespace(complete=False, outcomes=(*[Ended.REACHED] * (stages - 1), last))
    assert _outcome(None, path) is wanted  # type: ignore[arg-type]
    done = SimpleNamespace(complete=True, outcomes=(Ended.REACHED,) * stages)
    assert _outcome(None, done) is Outcome.HOLDS  # type: ignore[arg-type]
    for checked, domain in ((True, Outcome.HOLDS), (False, Outcome.INCOMPLETE)):
        assert _outcome(SimpleNamespace(checked=checked), done) is domain  # type: ignore[arg-type]


def test_nothing_begun_is_nothing_shown() -> None:
    assert _outcome(None, SimpleNamespace(complete=False, outcomes=())) is Outcome.INCOMPLETE  # type: ignore[arg-type]
