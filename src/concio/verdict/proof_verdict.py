"""The verdict of an exact certificate: what it claims of which loads; the claim itself is proved without rounding."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from concio.contact.assembly import Assembly
from concio.proof.exact_certificate import sealed
from concio.verdict.attention import attention, joints_not_made
from concio.verdict.question import question_of
from concio.verdict.verdict import Outcome, Verdict

PROOF = "every number recomputed as a fraction: weights, balance of every block, strength of every joint, work"

ASKED = {
    "limit": "exact bounds of the multiplier with which joint forces within friction balance the loads",
    "collapse": "a proof that no joint forces within friction balance the loads that act",
    "balance": "exact joint forces within friction that balance the loads that act",
    "equilibrium": "an exact Coulomb equilibrium under the loads that act, in one step from rest",
}
ONE_STATE = "one equilibrium in one step from rest: others may exist, and a history of loading may end in another"
LENT = "a compliance added to hard joints of rigid blocks, in proportion to one over their area"
DILATES = "friction that dilates: forces in balance are necessary for Coulomb friction and not sufficient"


def with_attention(made: Mapping[str, Any], assembly: Assembly) -> dict[str, Any]:
    """Return a certificate that also tells what is suspicious about its model, sealed again.

    Parameters
    ----------
    made : mapping
        What :func:`concio.proof.exact_certificate.prove_limit` and its like returned.
    assembly : Assembly
    """
    return sealed({**made, "attention": list(attention(assembly))})


def proof_verdict(
    made: Mapping[str, Any], sentence: str, assembly: Assembly, factors: Mapping[str, float] | None = None,
    live: Sequence[str] = (),
) -> Verdict:  # fmt: skip
    """Return the verdict of a certificate that was made of an assembly and accepted.

    Parameters
    ----------
    made : mapping
    sentence : str
        What the checking program said.
    assembly : Assembly
    factors : mapping of str to float, optional
        Of the constant groups.
    live : sequence of str
        Groups that are multiplied.
    """
    claim = str(made["claim"])
    whole = claim != "limit" or {"lower", "upper"} <= set(made)
    missing = "upper" if "lower" in made else "lower"
    return Verdict(
        outcome=Outcome.HOLDS if whole else Outcome.INCOMPLETE,
        status="proved" if whole else "incomplete",
        question=question_of(ASKED[claim], assembly, factors, multiplied=live),
        headline=f"{_how(sentence)}." if whole else f"Proved from one side: no {missing} bound was found.",
        answer=f"{sentence[0].upper()}{sentence[1:]}.",
        proof=PROOF,
        limits=(
            *joints_not_made(assembly.detection),
            ONE_STATE if claim == "equilibrium" else DILATES,
            *([LENT] if "lent" in made else []),
        ),
        unchecked=() if whole else (f"the {missing} bound",),
        attention=attention(assembly),
    )


def proved_line(sentence: str) -> str:
    """Return the line of a report about a certificate that was made and accepted.

    Parameters
    ----------
    sentence : str
        What the checking program said.
    """
    return f"{_how(sentence)}: {sentence.rsplit(': proved', 1)[0]}."


def _how(sentence: str) -> str:
    return "Proved exactly" if sentence.endswith("proved exactly") else "Proved, with intervals"
