"""One line of the validation table."""

from __future__ import annotations

from dataclasses import dataclass

CHECKS = {
    "published": "a number printed in the source, at the page given there",
    "closed form": "a formula, evaluated by the case",
    "another program": "computed with a program of others on the same statement",
    "second method": "another method of concio, or a short independent program of the project",
    "experiment": "a test on a structure; compared, not asserted",
    "other model": "another model of the same structure; compared, not asserted",
}
"""Where an expected number comes from."""


@dataclass(frozen=True)
class Row:
    """A number that was expected from elsewhere and the one concio computed.

    Parameters
    ----------
    name : str
        Unique in its case; says what the number is.
    expected, computed : float
    tolerance : float
        Largest difference allowed: relative to ``expected``, or absolute where ``absolute`` is true or ``expected`` is
        zero.
    reason : str
        Why the tolerance is what it is.
    unit : str
    absolute : bool
    check : str
        One of :data:`CHECKS`; "experiment" and "other model" are compared, not asserted.
    """

    name: str
    expected: float
    computed: float
    tolerance: float
    reason: str
    unit: str = "-"
    absolute: bool = False
    check: str = "closed form"

    @property
    def difference(self) -> float:
        """Computed less expected, relative to expected unless absolute."""
        gap = self.computed - self.expected
        return gap if self.absolute or self.expected == 0 else gap / abs(self.expected)

    @property
    def relative(self) -> bool:
        """True where the difference is a share of the expected value."""
        return not (self.absolute or self.expected == 0)

    @property
    def asserted(self) -> bool:
        """True where concio has to give the expected number."""
        return self.check not in ("experiment", "other model")

    @property
    def passes(self) -> bool:
        """True within the tolerance (false for nan)."""
        return abs(self.difference) <= self.tolerance


def check(rows: list[Row]) -> None:
    """Assert that every row is within its tolerance; experiments and other models are compared, not asserted."""
    wrong = [
        f"{r.name}: {r.computed:.9g} instead of {r.expected:.9g}, "
        f"difference {r.difference:.2e}, allowed {r.tolerance:.0e} ({r.reason})"
        for r in rows
        if not r.passes and r.asserted
    ]
    assert rows
    assert not wrong, "\n".join(wrong)
