"""``concio assess FILE``: seismic assessment of local mechanisms."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from concio.cli.options import EngineOf, File, Json, Quiet, UnitsOf, in_units
from concio.cli.outcome import answer, guarded, print_json, say
from concio.cli.output import check_directory, replaced_directory
from concio.cli.progress import progress_bar, verdict_so_far

if TYPE_CHECKING:
    from concio.analysis.seismic.assessment import Assessment
    from concio.analysis.seismic.local_mechanism import LocalMechanism
    from concio.analysis.seismic.strengthening import Strengthened
    from concio.analysis.seismic.variations import TieForce, Variation

MOST_FINDINGS = 12
"""More lines of one kind than this are counted; the report holds all."""

CONFIDENCE = {
    "given": "as given",
    "knowledge": "of the level of knowledge",
    "crushing": "that of least knowledge: joints do not crush",
}

NO_DERIVATIVES = (
    "no derivatives: in the weakest mechanism joints slide under pressure in space, or its state does not settle how "
    "forces are shared"
)
"""What the console says where an assessment has no derivatives."""


@guarded
def assess(
    file: File,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Directory for the report and the numbers.")] = None,
    language: Annotated[
        str | None, typer.Option("--language", "-l", help="Language of the report, en or it; by default the file's.")
    ] = None,
    docx: Annotated[bool, typer.Option("--docx", help="Write the report as a docx file as well.")] = False,
    engine: EngineOf = None,
    units: UnitsOf = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Find the local mechanisms under an earthquake and check them at the site that the file states.

    Example: concio assess facade.toml --out assessment --language it
    """
    import concio
    from concio.analysis.seismic.assessment_asked import read_asked
    from concio.analysis.seismic.strengthening import strengthen
    from concio.analysis.seismic.variations import tie_force, variations
    from concio.report.language import words_of

    if language is not None:
        words_of("assessment_words", language)
    if docx:  # before minutes of work
        _check_docx(out)
    if out is not None:
        check_directory(out)
    asked = read_asked(file)
    model = in_units(asked.model if engine is None else replace(asked.model, engine=engine), units)
    tie: TieForce | None = None
    with progress_bar(shown=not json) as progress:
        found = concio.assess(model, progress=progress, **asked.arguments)
        if asked.size_tie:
            arguments = {**asked.arguments, "progress": progress}
            tie = tie_force(model, asked.size_tie, largest=asked.largest_tie, **arguments)
        stronger: Strengthened | None = None
        if asked.strengthen is not None:
            stronger = strengthen(model, **asked.strengthen, **{**asked.arguments, "progress": progress})
        varied: tuple[Variation, ...] = ()
        sensitivity = found.sensitivity() if asked.sensitivity else None
        if asked.sensitivity and out is not None:
            varied = variations(found, progress=progress)
    verdict = found.verdict
    told: dict[str, Any] = {"status": verdict.status, **found.summary()}
    if tie is not None:
        finite = tie.force if tie.force < float("inf") else None
        told["tie_force"] = {"tie": tie.tie, "force": finite, "zeta_E": tie.reached}
    if stronger is not None:
        told["strengthening"] = {
            "kind": stronger.measure.kind, "of": list(stronger.measure.of), "unit": stronger.measure.unit,
            "zeta_E_wanted": stronger.wanted, "amount": finite_or_none(stronger.amount),
            "fails_at": finite_or_none(stronger.fails_at), "zeta_E": finite_or_none(stronger.reached),
            **({"height": stronger.height, "by_height": {f"{z:g}": finite_or_none(f) for z, f
                                                        in stronger.by_height.items()}} if stronger.by_height else {}),
        }  # fmt: skip
    if sensitivity is not None:
        told["sensitivity"] = {row.name: {"value": row.value, "below": finite_or_none(row.below),
                                          "above": finite_or_none(row.above)}
                               for row in (*sensitivity.rows, *sensitivity.without)}  # fmt: skip
    if not json:
        answer(assess_lines(found, tie))
        if stronger is not None:
            answer([f"  strengthening        {stronger.sentence}"])
        if sensitivity is not None:
            answer([f"  depends on           {sensitivity.sentence}"])
        elif asked.sensitivity and found.worst is not None and found.worst.found.flow != "no sliding":
            answer([f"  depends on           {NO_DERIVATIVES}"])
    written: list[str] = []
    if out is not None:
        verdict_so_far(verdict)
        from concio.cli.assess_files import write_assessment

        with replaced_directory(out) as fresh:
            written = write_assessment(found, told, fresh, language or asked.head.language, head=asked.head, tie=tie,
                                       anchors=asked.anchors, varied=varied, sensitivity=sensitivity,
                                       stronger=stronger, docx=docx)  # fmt: skip
    if json:
        print_json(told)
    elif written:
        say(f"  written              {out}: {', '.join(written)}")
    return verdict.exit_code


def _check_docx(out: Path | None) -> None:
    """Refuse a docx file that cannot be written.

    Raises
    ------
    InputError
        Its library is not installed, or no directory is given.
    """
    from concio.errors import InputError
    from concio.report.docx_file import docx_library

    docx_library()
    if out is None:
        msg = "--docx writes beside the report, and no directory is given"
        raise InputError(msg, hint="give one with --out")


def finite_or_none(value: float) -> float | None:
    """Return a number, or None for what is none."""
    return value if value == value and abs(value) != float("inf") else None


def assess_lines(found: Assessment, tie: TieForce | None = None) -> list[str]:
    """Return what an assessment found, in words: the verdict with what pushes, then each mechanism."""
    from concio.display import number

    verdict = found.verdict
    lines = [found.model.title or "model without a title", verdict.sentence]
    lines += verdict.lines(found.model.report, most=MOST_FINDINGS)
    lines.append(f"  proof        {verdict.proof}")
    by = CONFIDENCE[found.confidence_by]
    lines.append(f"  code         {found.site.rules.name}, {found.knowledge}, FC {number(found.confidence)} ({by})")
    for m in found.mechanisms:
        lines += mechanism_lines(m)
    lines += [f"  {n.name}, push {n.direction}: {n.sentence}" for n in found.locked]
    if found.others:
        least = number(min(m.zeta for m in found.others), 4)
        lines.append(f"  also followed        {len(found.others)} more in parts of the structure, zeta_E from {least}")
    lines.append(f"  in short             {verdict.headline}")
    if tie is not None:
        lines.append(f"  tie '{tie.tie}'          {_tie_words(tie)}")
    return lines


def _tie_words(tie: TieForce) -> str:
    from concio.display import number

    reached = f"zeta_E {number(tie.reached, 4)}"
    if tie.force == 0:
        return f"not needed: without it {reached}"
    if math.isfinite(tie.force):
        return f"{number(tie.force, 4)} kN bring zeta_E to {number(tie.reached, 4)}"
    least = min(tie.assessment.mechanisms, key=lambda m: m.least)
    return f"no force up to {number(tie.largest, 4)} kN is enough: {reached}, of '{least.name}', push {least.direction}"


def mechanism_lines(m: LocalMechanism) -> list[str]:
    """Return one mechanism in words."""
    from concio.analysis.seismic.curve import REASONS
    from concio.display import number
    from concio.verdict.assessment_verdict import check_words

    lines = [f"  {m.name}, push {m.direction}"]
    lines.append(f"    alpha_0            {m.multiplier:.6g}, e* {number(m.e_star, 4)}, a_0* {number(m.onset, 4)} m/s2")
    for c in m.checks:
        place = "" if c.place == "ground" else ", at height"
        lines.append(
            f"    {c.level + ', ' + c.kind + place:18s} demand {number(c.demand, 4)} {c.unit}, capacity "
            f"{number(c.capacity, 4)} {c.unit}: {check_words(c, decides=m.decided_by(c))}"
        )
    if not m.followed.ends:
        lines.append(f"    no check in displacements: {REASONS[m.followed.reason]}")
    for o in m.outcomes:
        period = f", return period {number(o.T_R)} years" if o.T_R == o.T_R else ""
        lines.append(f"    {o.level:18s} a_g of capacity {number(o.a_g, 4)} g, zeta_E {number(o.zeta, 4)}{period}")
    lines += [f"    {level:18s} not checked" for level in m.unchecked]
    if not m.at_its_height:
        lines.append(f"    at z = {number(m.level)} m         not checked: all of this is as on the ground")
    if m.found.flow == "associated":
        lines.append("    upper bound        a joint slides, and no Coulomb state was found: alpha_0 may be less")
    return lines
