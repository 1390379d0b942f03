"""The verdict of a wall beside its homogenised continuum: elastic answers and limit loads of both."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from concio.display import number
from concio.verdict.attention import attention
from concio.verdict.question import question_of
from concio.verdict.step_words import WORDS
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.continuum.answers import ElasticComparison, StrengthComparison
    from concio.analysis.continuum.comparison import ContinuumComparison
    from concio.analysis.continuum.halving import BlockHalving


def continuum_verdict(found: ContinuumComparison, halving: BlockHalving | None = None) -> Verdict:
    """Return the verdict of a comparison with the continuum, or of all comparisons of halved blocks.

    Parameters
    ----------
    found : ContinuumComparison
    halving : BlockHalving or None
    """
    every = (found,) if halving is None else halving.comparisons
    done = all(c.checked for c in every)
    unchecked = [line for c in every for line in _unchecked(c)]
    notes = [
        f"no comparison of {word}: {note.rstrip('.')}"
        for word, note in (("elastic answers", found.elastic_note), ("limit loads", found.strength_note))
        if note
    ]
    live = found.strength.live if found.strength is not None else ()
    factors = found.elastic.blocks.factors if found.elastic is not None else None
    question = question_of(
        "a wall of blocks compared with its homogenised continuum", found.assembly, factors, multiplied=live
    )
    return Verdict(
        outcome=Outcome.HOLDS if done else Outcome.INCOMPLETE,
        status="solved" if done else "incomplete",
        question=question,
        headline="Blocks and continuum compared." if done else "Some results are not proven.",
        answer=" ".join([*_elastic(found.elastic), *_strength(found.strength), *(f"{n.capitalize()}." for n in notes)]),
        proof=_proof(found),
        meaning="The continuum has the moduli and the strength of the cell. It has no lintels, no edges and no arch: "
        "what differs is what it leaves out.",
        limits=(*_limits(found), *notes),
        unchecked=tuple(dict.fromkeys(unchecked)),
        attention=attention(found.assembly),
    )


def _limits(found: ContinuumComparison) -> list[str]:
    """Return what limit loads say nothing about: friction that is not associated, and the factors of the others."""
    if found.strength is None:
        return []
    lines = ["the limit loads are those of associated friction: upper bounds of what Coulomb friction carries"]
    if found.elastic is not None:
        other = {k: v for k, v in found.elastic.blocks.factors.items() if v != 1.0}
        told = ", ".join(f"'{name}' {value:g}" for name, value in other.items())
        if told:
            lines.append(f"factors of the elastic answers alone: {told}; limit loads are those with the loads as given")
    return lines


def _unchecked(found: ContinuumComparison) -> list[str]:
    lines = []
    if found.elastic is not None and found.elastic.blocks.status.exit_code not in (0, 3):
        lines.append(f"elastic answer of the blocks: {WORDS[found.elastic.blocks.status].headline}")
    if found.strength is not None:
        lower, upper = found.strength.proven
        if not found.strength.blocks.associated.checked:
            lines.append("the associated bound of the blocks: its residuals are too large")
        if not lower:
            lines.append("the lower bound of the continuum")
        if not upper:
            lines.append("the upper bound of the continuum")
    return lines


def _elastic(found: ElasticComparison | None) -> list[str]:
    if found is None:
        return []
    blocks, _, smooth = found.settlements
    if not found.blocks.solved:
        return [f"Blocks: {WORDS[found.blocks.status].headline} The continuum settles by {1e3 * smooth:.5g} mm."]
    return [f"Blocks settle by {1e3 * blocks:.5g} mm, the continuum by {1e3 * smooth:.5g} mm."]


def _strength(found: StrengthComparison | None) -> list[str]:
    if found is None:
        return []
    own, (low, high) = found.blocks.associated.multiplier, found.bracket
    blocks = "no associated bound" if math.isinf(own) else f"associated bound {number(own, 6)}"
    if high == -math.inf:
        return [f"Blocks: {blocks}; the continuum does not even carry the constant loads."]
    ends = " to ".join("none" if math.isnan(v) else number(v, 6) if math.isfinite(v) else "any" for v in (low, high))
    return [f"Blocks: {blocks}; continuum: {ends}."]


def _proof(found: ContinuumComparison) -> str:
    lines = []
    if found.elastic is not None:
        lines.append(f"continuum: residual of its stiffness equations {found.elastic.continuum.residual:.0e}")
    if found.strength is not None:
        ends = (
            ("stresses in balance", found.strength.static.residual, "from below"),
            ("a mechanism", found.strength.kinematic.residual, "from above"),
        )
        shown = [f"{word} {residual:.0e} {side}" for word, residual, side in ends if math.isfinite(residual)]
        lines.append(f"limit loads: {', '.join(shown) or 'none'}; blocks {found.strength.blocks.associated.worst:.0e}")
    return "; ".join(lines)


def continuum_strength_words(found: StrengthComparison) -> list[str]:
    """Return the limit loads of blocks and continuum, a phrase each."""
    low, high = (v + 0.0 for v in found.bracket)
    own = found.blocks.associated.multiplier
    lower, upper = found.proven
    words = "any multiple" if math.isinf(own) else f"{own:.6g}"
    named = "' and '".join(found.live)
    lines = [f"of '{named}' (associated): blocks {words}"]
    if high == -math.inf:
        said = "a mechanism proves it" if upper else "NOT proven"
        return [*lines, f"continuum: does not even carry the constant loads ({said}); it has no lintels"]
    carries = "not even the constant loads, on these meshes" if math.isnan(low) else "any multiple"
    carries = f"{low:.6g}" if math.isfinite(low) else carries
    bound = "no mechanism found" if math.isinf(high) else f"no equilibrium beyond {high:.6g} ({_proven(upper)})"
    return [*lines, f"continuum: carries {carries} ({_proven(lower)}); {bound}"]


def _proven(yes: bool) -> str:
    return "proven" if yes else "NOT proven"
