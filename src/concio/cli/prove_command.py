"""``concio prove FILE``: an exact certificate, which ``concio verify`` or its short program alone recomputes."""

from __future__ import annotations

import json as json_text
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from concio.cli.options import Factors, File, Json, Quiet, factors_of, loaded
from concio.cli.outcome import guarded, print_json, say
from concio.cli.output import check_file, replaced_file
from concio.cli.progress import on_the_way

if TYPE_CHECKING:
    from concio.contact.assembly import Assembly


@guarded
def prove(
    file: File,
    claim: Annotated[
        Literal["limit", "collapse", "balance", "equilibrium"] | None,
        typer.Option(
            "--claim",
            help="Claim to prove; default limit where loads are multiplied, else equilibrium, balance or collapse.",
        ),
    ] = None,
    group: Annotated[
        list[str] | None,
        typer.Option("--group", "-g", help="Load group that is multiplied (repeatable); default live."),
    ] = None,
    factor: Factors = None,
    numbers: Annotated[
        Literal["binary", "decimal"],
        typer.Option("--numbers", help="Numbers as stored (binary), or rounded to twelve decimal digits."),
    ] = "binary",
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Certificate to write; by default FILE.proof.json.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Write an exact certificate in fractions: of bounds of a multiplier, of an equilibrium, or of its non-existence.

    The certificate contains the numbers of the model, the forces and the motion. 'concio verify' recomputes all of it
    with Python's fractions.

    Example: concio prove wall.toml --group live --out wall.proof.json
    """
    import concio
    from concio.analysis.exact_proofs import balance_proof, collapse_proof
    from concio.analysis.limit import limit
    from concio.errors import InputError
    from concio.proof.programs import recompute
    from concio.verdict.proof_verdict import proof_verdict, with_attention
    from concio.verdict.unanswered import with_a_verdict

    if claim is None and group:
        claim = "limit"
    if factor and claim == "limit":
        msg = "--factor does not go with --claim limit: what is not multiplied acts once"
        raise InputError(msg, hint="write the loads into the file as they are to act")
    if group and claim not in ("limit", None):
        msg = f"--group does not go with --claim {claim}: nothing is multiplied"
        raise InputError(msg, hint="give the loads their factors with --factor")
    place = file.with_suffix(".proof.json") if out is None else out
    check_file(place, force=force)
    assembly, live = concio.assemble(loaded(file)), list(group or ["live"])
    factors = factors_of(factor) or None
    if claim is None and not factors and "live" in assembly.groups:
        claim = "limit"
    with with_a_verdict(assembly, "prove"):
        if claim != "limit":
            ways = {"collapse": collapse_proof, "balance": balance_proof, "equilibrium": _equilibrium, None: _outcome}
            live, made = [], ways[claim](assembly, factors, numbers=numbers)
        else:
            found = limit(assembly, live=live, path=False, steps=False, search=False)
            sizes = f"{len(assembly.model.free_bodies):,} blocks, {len(assembly.pairs):,} contact pairs"
            if not json:
                on_the_way([f"  associated bound  {found.associated.multiplier:.6g}; fractions are sought: {sizes}"])
            made = found.proof(numbers)
    made = with_attention(made, assembly)
    sentence = recompute(made)
    verdict = proof_verdict(made, sentence, assembly, factors, live)
    with replaced_file(place) as fresh:
        fresh.write_text(json_text.dumps(made, indent=1, ensure_ascii=True) + "\n", encoding="ascii")
    if json:
        bounds = {key: made.get(key) for key in ("lower", "upper")}
        told = {"claim": made["claim"], "sentence": sentence, **bounds, "file": str(place), "digest": made["digest"]}
        print_json({"status": verdict.status, **told, "verdict": verdict.as_dict()})
    else:
        for line in (sentence, *verdict.lines(assembly.model.report)):
            say(line)
        say(f"  certificate  {place}, {place.stat().st_size:,} bytes; 'concio verify {place}' recomputes it")
    return verdict.exit_code


def _equilibrium(
    assembly: Assembly, factors: dict[str, float] | None, *, numbers: Literal["binary", "decimal"]
) -> dict[str, Any]:
    """Return the certificate of a load step that has an equilibrium; raise where it has none."""
    import concio
    from concio.errors import SolverError

    result = concio.solve(assembly, factors=factors, on_failure="return")
    if not result.solved:
        msg = f"there is no equilibrium to prove: {result.sentence}"
        raise SolverError(msg, hint="ask for the contrary with --claim collapse")
    return result.proof(numbers)


def _outcome(
    assembly: Assembly, factors: dict[str, float] | None, *, numbers: Literal["binary", "decimal"]
) -> dict[str, Any]:
    """Return the certificate of an equilibrium, of forces in balance or of a collapse, whichever holds first."""
    import concio
    from concio.analysis.exact_proofs import balance_proof, collapse_proof
    from concio.errors import InputError, SolverError

    result = concio.solve(assembly, factors=factors, on_failure="return")
    if not result.solved:
        return collapse_proof(assembly, factors, numbers=numbers)
    try:
        return result.proof(numbers)
    except (InputError, SolverError):  # not of this structure: in space, or on the edge of its states
        return balance_proof(assembly, factors, numbers=numbers)
