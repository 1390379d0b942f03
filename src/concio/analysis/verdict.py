"""What a verdict means here, in words: self-stress that nothing put there, and what asks for attention."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.contact.factors import load_factor
from concio.display import number
from concio.model.plausibility import implausible
from concio.problem.solution import Status
from concio.solvers.statics.self_stress import SelfStress, least_compression

if TYPE_CHECKING:
    from concio.analysis.result import Result

MUCH = 1000.0
"""Forces of a joint this many times all loads are pointed out."""

FORCED = 1e-2
"""Share of the largest displacement that a lent compliance takes up where rigid blocks are forced together; of blocks
that can move aside it takes up a share that falls with the compliance lent, some 1e-4."""

MOST_REACTIONS = 4
"""More reactions than this are counted in a short text."""

LARGEST = 20_000
"""Largest number of pairs for which the forces that could hold a structure are worked out (a linear programme)."""


def self_stress(result: Result) -> SelfStress | None:
    """Return forces that would hold a structure which collapses as it is loaded; None where there are none."""
    if result.status not in (Status.COLLAPSES, Status.NO_COULOMB_STATE) or len(result.assembly.pairs) > LARGEST:
        return None
    return least_compression(result.assembly.problem(result.factors))


def sentence(result: Result) -> str:
    """Return the outcome in words, with the self-stress that could hold what collapses."""
    found = result.self_stress
    if found is None:
        return result.status.value
    return (
        f"{result.status.value} Forces in balance within friction exist (with {found.compression:.4g} kN of "
        f"compression in the joints at least, {found.compression / found.load:.3g} times the loads), but only as "
        "self-stress that no load, prestress or settlement puts there."
    )


def attention(result: Result) -> tuple[str, ...]:
    """Return what asks for attention, a sentence each: numbers that are hardly meant, and more in a solved step."""
    odd = implausible(result.model)
    if not result.solved:
        return odd
    found = [result.joint_motion.sentence] if result.joint_motion.large else []
    return (*odd, *found, *_not_rigid(result), *_heavy(result))


def _not_rigid(result: Result) -> tuple[str, ...]:
    """Return a sentence on an answer that still has the compliance lent to joints of rigid blocks, else none."""
    if not (result.lent_compliance and result.assembly.lent_compliance):
        return ()
    answer, size = result.solution, f"{result.lent_compliance:.3g} m/kN"
    closing = float((result.assembly.laws.normal_compliance * answer.normal_force).max(initial=0.0))
    if closing > FORCED * float(np.abs(answer.displacement).max(initial=0.0)):
        return (
            "blocks that cannot yield are forced together: the forces between them grow without end as joints become "
            f"stiffer, and those given belong to a compliance of {size}",
        )
    return (
        f"joints between rigid blocks keep the compliance of {size} that was lent to them: no answer without it was "
        "certified, since which way they slip depends on it a little",
    )


def _heavy(result: Result) -> tuple[str, ...]:
    """Return a sentence on the pair with the largest force where that is a thousand times the loads, else none."""
    load = result.assembly.problem(result.factors).total_load
    t_n, t_t = result.solution.normal_force, result.solution.friction_force
    size = np.hypot(t_n, np.linalg.norm(t_t, axis=1))
    if not size.size or not load > 0 or not size.max() > MUCH * load:
        return ()
    k = int(np.argmax(size))
    pairs, bodies = result.assembly.pairs, result.model.bodies
    a, b = ("" if i < 0 else bodies[i].name for i in (int(pairs.body_a[k]), int(pairs.body_b[k])))
    at = ", ".join(f"{v:.4g}" for v in pairs.point[k])
    return (
        f"joint {a}|{b} carries {size[k]:.4g} kN at ({at}), {size[k] / load:.3g} times all loads: forces this large "
        "balance themselves, and how large they are rests on details such as corners and the mesh",
    )


def result_lines(result: Result) -> list[str]:
    """Return a result in some ten lines: outcome, certificate, sizes, loads; of a solved one motions and forces."""
    model, units, assembly = result.model, result.model.report, result.assembly
    size = f"{len(model.free_bodies):,} bodies, {len(assembly.pairs):,} contact pairs"
    factors = ", ".join(f"{g} = {number(load_factor(result.factors, g))}" for g in assembly.groups) or "none"
    lines = [
        f"Result: {result.status.name}. {result.status.value}",
        f"  {model.title or 'model without a title'}: {size}",
        f"  by {result.solved_by}, worst error of the certificate {result.certificate.worst:.1e}",
        f"  load factors {factors}; loads {units.force_vector(result.total_load)}",
    ]
    if result.solved:
        settlement = units.text("motion", result.max_settlement)
        lines.append(f"  pairs {result.contacts.counted}; largest settlement {settlement}")
        reactions = list(result.reactions.items())
        largest = max((float(np.linalg.norm(force)) for _, force in reactions), default=0.0)
        for name, force in reactions[:MOST_REACTIONS]:
            lines.append(f"  reaction of {name}: {units.force_vector(force, size=largest)}")
        if len(reactions) > MOST_REACTIONS:
            lines.append(f"  ... and {len(reactions) - MOST_REACTIONS} more reactions")
    elif result.mechanism is not None:
        lines.append("  its motion: result.mechanism_velocity, result.plot.mechanism()")
    return lines
