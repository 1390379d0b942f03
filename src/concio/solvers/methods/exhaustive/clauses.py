r"""Clauses over yes/no questions, and search that learns from its dead ends.

A question v has the answers yes, literal ``2 v``, and no, literal ``2 v + 1``. A clause is a set of literals one of
which must hold. Answers that clauses force are drawn at
once (unit propagation, two watched literals in each clause). A dead
end is traced back to the first answer that implies it at the current level (first unique implication point); its
negation is learned as a new clause, and the search returns to where that clause would have spoken. Dead ends of one
part of a structure are so met once, not once for every state of the other parts.

J. P. Marques-Silva, K. A. Sakallah, *IEEE Trans. Comput.* 48 (1999) 506-521; L. Zhang et al., ICCAD 2001, 279-285.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

Clause = list[int]

DECAY = 0.95
"""Weight that older dead ends keep at each new one in :attr:`ClauseSearch.activity`."""


class ClauseSearch:
    """Partial answers to questions, what follows from them, and what is learned from dead ends.

    Parameters
    ----------
    questions : int
        Number of questions.

    Attributes
    ----------
    answer : (questions,) list
        1 yes, 0 no, -1 open.
    trail : list of int
        Literals that hold, in the order in which they came to hold.
    activity : (questions,) array
        How often a question took part in recent dead ends.
    """

    def __init__(self, questions: int) -> None:
        self.answer = [-1] * questions
        self.level_of = [0] * questions
        self.reason: list[Clause | None] = [None] * questions
        self.trail: list[int] = []
        self.starts: list[int] = []
        self.watches: list[list[Clause]] = [[] for _ in range(2 * questions)]
        self.activity = np.zeros(questions)
        self.step = 1.0
        self.head = 0
        self.clauses = 0
        self.impossible = False

    @property
    def level(self) -> int:
        """Number of decisions taken."""
        return len(self.starts)

    def holds(self, literal: int) -> bool | None:
        """Return whether a literal holds, None where the question is open."""
        answer = self.answer[literal >> 1]
        return None if answer < 0 else answer != (literal & 1)

    def add(self, literals: Iterable[int]) -> None:
        """Add a clause before any decision is taken."""
        clause = [q for q in dict.fromkeys(literals) if self.holds(q) is not False]
        if any(self.holds(q) for q in clause):
            return
        self.clauses += 1
        if not clause:
            self.impossible = True
        elif len(clause) == 1:
            self._set(clause[0], None)
        else:
            self._watch(clause)

    def decide(self, literal: int) -> None:
        """Take a decision."""
        self.starts.append(len(self.trail))
        self._set(literal, None)

    def propagate(self) -> Clause | None:
        """Draw what follows; return a clause none of whose literals can hold, or None."""
        answer, trail = self.answer, self.trail
        while self.head < len(trail):
            false = trail[self.head] ^ 1
            self.head += 1
            watching = self.watches[false]
            kept: list[Clause] = []
            self.watches[false] = kept
            for at, clause in enumerate(watching):
                if clause[0] == false:
                    clause[0], clause[1] = clause[1], false
                first = clause[0]
                value = answer[first >> 1]
                if value >= 0 and value != (first & 1):
                    kept.append(clause)
                    continue
                for k in range(2, len(clause)):
                    q = clause[k]
                    value_q = answer[q >> 1]
                    if value_q < 0 or value_q != (q & 1):
                        clause[1], clause[k] = q, false
                        self.watches[q].append(clause)
                        break
                else:
                    kept.append(clause)
                    if value >= 0:
                        kept.extend(watching[at + 1 :])
                        return clause
                    self._set(first, clause)
        return None

    def learn(self, conflict: Clause) -> bool:
        """Learn from a clause all of whose literals fail, and go back; False where nothing is left to try."""
        deepest = max((self.level_of[q >> 1] for q in conflict), default=0)
        if deepest == 0:
            self.impossible = True
            return False
        self.back(deepest)
        clause = self._implication_point(conflict)
        self.clauses += 1
        self.step /= DECAY
        if self.step > 1e100:
            self.activity *= 1e-100
            self.step *= 1e-100
        if len(clause) == 1:
            self.back(0)
            self._set(clause[0], None)
            return True
        levels = [self.level_of[q >> 1] for q in clause]
        second = max(range(1, len(clause)), key=levels.__getitem__)
        clause[1], clause[second] = clause[second], clause[1]
        self.back(self.level_of[clause[1] >> 1])
        self._watch(clause)
        self._set(clause[0], clause)
        return True

    def back(self, level: int) -> None:
        """Take back all decisions after the first ``level``."""
        if self.level <= level:
            return
        start = self.starts[level]
        for literal in self.trail[start:]:
            self.answer[literal >> 1] = -1
            self.reason[literal >> 1] = None
        del self.trail[start:]
        del self.starts[level:]
        self.head = start

    def _set(self, literal: int, reason: Clause | None) -> None:
        v = literal >> 1
        if self.answer[v] >= 0:
            self.impossible |= not self.holds(literal)
            return
        self.answer[v] = 1 - (literal & 1)
        self.level_of[v] = self.level
        self.reason[v] = reason
        self.trail.append(literal)

    def _watch(self, clause: Clause) -> None:
        self.watches[clause[0]].append(clause)
        self.watches[clause[1]].append(clause)

    def _implication_point(self, conflict: Clause) -> Clause:
        """Return the clause learned from a dead end of the current level, the literal it forces first."""
        seen: set[int] = set()
        rest: Clause = []
        here = 0
        at = len(self.trail)
        clause: Clause = conflict
        while True:
            for q in clause:
                v = q >> 1
                if v in seen or self.holds(q) or self.level_of[v] == 0:
                    continue
                seen.add(v)
                self.activity[v] += self.step
                if self.level_of[v] == self.level:
                    here += 1
                else:
                    rest.append(q)
            at -= 1
            while self.trail[at] >> 1 not in seen:
                at -= 1
            literal = self.trail[at]
            here -= 1
            reason = self.reason[literal >> 1]
            if here == 0 or reason is None:
                return [literal ^ 1, *(q for q in rest if not self._implied(q, seen))]
            clause = reason

    def _implied(self, q: int, seen: set[int]) -> bool:
        """Return whether a literal of a learned clause follows from the others and can be left out."""
        reason = self.reason[q >> 1]
        return reason is not None and all(
            (p >> 1 in seen and self.level_of[p >> 1] < self.level) or self.level_of[p >> 1] == 0 or p == q ^ 1
            for p in reason
        )
