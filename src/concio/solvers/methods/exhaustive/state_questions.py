"""Joint states as yes/no questions, what an answer fixes in the linear programme, and what that may say.

Of every pair: is it open (no force)? Of a rough pair also: is s+ used up (p = 0), is s- used up (q = 0)? The answers of
a rough pair leave four states: open (yes, yes, yes), stick (no, no, no), slip + (no, yes, no) and slip - (no, no, yes);
a pair with both used up carries nothing and counts as open. Every answer fixes at most one column of
:class:`.relaxation.Relaxation` at zero, and every column but the rigid motions has its answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.methods.exhaustive.clauses import Clause


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a relaxation, scaled: columns p, q, y_n, y+, y- (n,), forces t (c,) and rigid motions alpha (r,)."""

    columns: Array
    t: Array
    alpha: Array


@dataclass(frozen=True, eq=False)
class Empty:
    """Proof that a relaxation is empty: the columns that must not all be zero, and up to where it holds."""

    reasons: Array
    reach: float


class StateQuestions:
    """The questions: 0..m-1 open? m..m+k-1 s+ used up? m+k..m+2k-1 s- used up?.

    Parameters
    ----------
    m : int
        Number of pairs.
    rough : (k,) integer array
        Pairs with friction.
    """

    def __init__(self, m: int, rough: Array) -> None:
        k = int(rough.size)
        self.m, self.k, self.rough = m, k, rough
        self.count = m + 2 * k
        is_open, plus, minus = np.arange(m), m + np.arange(k), m + k + np.arange(k)
        no_p = 2 * is_open
        no_p[rough] = 2 * plus
        self.literal = np.concatenate([no_p, 2 * minus, 2 * is_open + 1, 2 * plus + 1, 2 * minus + 1])
        """Literal that fixes each column p (m), q (k), y_n (m), y+ (k), y- (k) at zero."""
        self.column = np.full(2 * self.count, -1)
        self.column[self.literal] = np.arange(self.literal.size)

    def clauses(self) -> list[Clause]:
        """Return the clauses that tie the questions of a pair: open if and only if s+ and s- are used up."""
        found: list[Clause] = []
        for i, pair in enumerate(self.rough.tolist()):
            o, a, b = 2 * pair, 2 * (self.m + i), 2 * (self.m + self.k + i)
            found += [[o + 1, a], [o + 1, b], [o, a + 1, b + 1]]
        return found

    def fixed(self, literals: list[int]) -> Array:
        """Return which columns the literals fix at zero, boolean."""
        columns = self.column[literals]
        mask = np.zeros(self.literal.size, dtype=bool)
        mask[columns[columns >= 0]] = True
        return mask

    def products(self, columns: Array) -> tuple[Array, Array]:
        """Return force and gap of each question's complementarity, both (count,), one of which a state has zero."""
        m, k = self.m, self.k
        p, q, y_n, y_plus, y_minus = np.split(np.maximum(columns, 0.0), np.cumsum([m, k, m, k]))
        t_n = p.copy()
        t_n[self.rough] += q
        return np.concatenate([t_n, p[self.rough], q]), np.concatenate([y_n, y_plus, y_minus])
