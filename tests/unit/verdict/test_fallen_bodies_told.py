"""What has fallen is named up to a number, and the rest counted."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from concio.verdict.dynamics_verdict import MOST_FALLEN, _answer
from concio.verdict.verdict import Outcome


@pytest.mark.parametrize("count", range(1, MOST_FALLEN + 3))
def test_what_is_not_named_is_counted(count: int) -> None:
    fallen = tuple(f"body {k}" for k in range(count))
    found = SimpleNamespace(
        end=SimpleNamespace(time=1.5), refuted="", stands=True, fallen=fallen, ending=SimpleNamespace(name="RESTS"),
        notes=(), rests=False, largest_rotation=("body 0", 0.5),
    )  # fmt: skip
    told = _answer(found, Outcome.FAILS)  # type: ignore[arg-type]
    named = "; ".join(fallen[:MOST_FALLEN])
    rest = count - MOST_FALLEN
    assert f"At 1.5 s it has fallen: {named}{f', and {rest} more' if rest > 0 else ''}." in told
