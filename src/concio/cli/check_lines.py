"""What ``concio check`` prints: the parts of a model, and everything that was noticed about its geometry."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np

from concio.contact.edge_loads import line_tolerance, loaded_faces
from concio.display import number
from concio.errors import InputError
from concio.model.described import law_words, material_words, tie_words
from concio.model.interfaces.detect import Detection, Interface
from concio.model.model import Body, Model
from concio.model.polyhedron import Polyhedron
from concio.verdict.attention import attention_of, noted, torsion
from concio.verdict.lost_loads import load_words
from concio.verdict.question import assumed_words

MOST_LINES = 20
"""More findings than this are counted, unless all are asked for."""


def check_facts(model: Model, detection: Detection) -> dict[str, Any]:
    """Return what a model holds as plain types."""
    return {
        "title": model.title,
        "bodies": len(model.free_bodies),
        "fixed_bodies": len(model.bodies) - len(model.free_bodies),
        "interfaces": len(detection.interfaces),
        **({} if model.periods is None else {"periods": [list(p) for p in model.periods]}),
        "near_misses": [m.sentence for m in detection.near_misses],
        "overlaps": [o.sentence for o in detection.overlaps],
        "attention": list(attention_of(model, detection)),
        "drawing_faults": list(noted(model, "faults")),
        "left_out": list(noted(model, "left_out")),
        "moved": list(noted(model, "moved")),
    }


def check_lines(
    model: Model, detection: Detection, facts: Mapping[str, Any], *, every: bool, fault: str = ""
) -> list[str]:
    """Return what a model holds as lines of text: sizes, parts, loads, and every finding of interface detection.

    Parameters
    ----------
    model : Model
    detection : Detection
    facts : mapping
        Numbers of the assembly, empty where there is none.
    every : bool
        Whether all bodies and findings are listed, however many.
    fault : str
        The error that will be reported after these lines; an overlap that it names is not listed.
    """
    units = model.report
    scale, symbol = units.factor("length")
    sizes = np.ptp(np.vstack([body.vertices for body in model.bodies]), axis=0)
    kind = f"plane {model.plane}" if model.dim == 2 else "in space"
    deforms = any(body.kind == "elastic" for body in model.bodies)
    lines = [
        model.title or "model without a title",
        f"size         {' x '.join(number(scale * v, 4) for v in sizes)} {symbol}, {kind}"
        + (f", elements {model.element}" if deforms else ""),
        *_bodies(model, float(sizes.max()), every=every),
    ]
    if model.periods is not None:
        (a, b), (c, d) = model.periods
        share = sum(body.area for body in model.outlines) / abs(a * d - b * c)
        voids = "" if share > 1 - 1e-6 else f", {100 * (1 - share):.3g} % of it empty"
        lines.append(f"cell         repeats by ({a:.6g}, {b:.6g}) and ({c:.6g}, {d:.6g}) m{voids}")
    lines += [f"material     {name}: {material_words(given, units)}" for name, given in model.materials.items()]
    lines += [f"joint law    {name}: {law_words(law, units)}" for name, law in model.laws.items()]
    lines += [f"assumed      {line}" for line in assumed_words(model)]
    lines += _interfaces(model, detection)
    if facts:
        stated = ", ".join(f"{count:,} {name}" for name, count in facts["contact_model"].items())
        lines.append(f"contact      {facts['pairs']:,} pairs ({stated}), {facts['unknowns']:,} displacements")
        lines += [f"attention    {line}" for line in torsion(model, detection, facts["contact_model"])]
    for group in model.load_groups:
        kinds = Counter(load.kind for load in model.loads if load.group == group)
        words = [f"{n} {kind}" for kind, n in kinds.items()]
        moved = sum(s.group == group for s in model.supports)
        words += [f"{moved} support{'s' if moved > 1 else ''}"] if moved else []
        warmed = sum(change.group == group for change in model.temperatures)
        words += [f"{warmed} change{'s' if warmed > 1 else ''} of temperature"] if warmed else []
        total = facts.get("total_load", {}).get(group)
        force = f", {units.force_vector(total)} in all" if total else ""
        lines.append(f"load group   {group}: {', '.join(words)}{force}")
    lines += _edge_loads(model, every=every) if model.dim == 2 else []
    soil = [tie for tie in model.ties if tie.kind == "soil"]
    if soil:
        most = units.text("force", sum(tie.strength for tie in soil), 4)
        lines.append(f"soil         presses {len(soil)} faces, {most} in all at most")
    for tie in (t for t in model.ties if t.kind == "bar"):
        ends = f"{tie.body_a or 'a fixed point'} to {tie.body_b or 'a fixed point'}"
        lines.append(f"tie          {tie.name}: {ends}; {tie_words(tie, units)}")
    geometry = [f"overlap      {o.sentence}" for o in detection.overlaps if o.sentence not in fault]
    geometry += [f"near miss    {m.sentence}" for m in detection.near_misses]
    noticed = (*attention_of(model, detection), *noted(model, "faults"))
    findings = [f"attention    {sentence}" for sentence in noticed] + geometry
    lines += _drawing(model, every=every)
    shown = findings if every else findings[:MOST_LINES]
    lines += shown
    if len(findings) > len(shown):
        lines.append(f"             ... and {len(findings) - len(shown)} more (--all lists them)")
    if not geometry and not detection.overlaps:
        lines.append("geometry     no overlaps and no near misses")
    return lines


def _bodies(model: Model, size: float, *, every: bool) -> list[str]:
    sorts = Counter((b.kind, b.role, "" if b.kind == "fixed" else b.material) for b in model.bodies)
    lines = []
    for (kind, role, material), count in sorts.items():
        of = f" of '{material}'" if material else ""
        lines.append(f"bodies       {count:,} {kind}, role '{role}'{of}")
    if every or len(model.bodies) <= MOST_LINES:
        for body in model.bodies:
            at = ", ".join(f"{v:.4g}" for v in np.round(body.centroid / size, 9) * size + 0.0)
            if isinstance(body, Polyhedron):
                shape = f"{len(body.vertices)} vertices, {len(body.faces)} faces, volume {body.volume:.4g} m3"
            else:
                shape = f"{_corners(body)}, area {body.area:.4g} m2"
            lines.append(f"  '{body.name}': {shape}, centroid ({at}) m")
    return lines


def _corners(body: Body) -> str:
    holes = f" with {len(body.holes)} hole{'s' if len(body.holes) > 1 else ''}" if body.holes else ""
    return f"{len(body.outline)} vertices{holes}"


def _interfaces(model: Model, detection: Detection) -> list[str]:
    found: Counter[str] = Counter()
    length: dict[str, float] = defaultdict(float)
    apart: Counter[str] = Counter()
    for interface in detection.interfaces:
        rule = model.rule_between(model.bodies[interface.a], model.bodies[interface.b])
        found[rule.law] += 1
        length[rule.law] += interface.length if isinstance(interface, Interface) else interface.area
        apart[rule.law] += bool(rule.gap or interface.gap.max() > 0)
    lines = []
    for law, count in found.items():
        text = f"joints       {count:,} with law '{law}', {length[law]:.4g} {'m' if model.dim == 2 else 'm2'} in all"
        lines.append(text + (f", {apart[law]:,} of them open at first" if apart[law] else ""))
    if bare := Counter(c.kind for c in detection.point_contacts):
        kinds = ", ".join(f"{count:,} {kind}" for kind, count in bare.items())
        lines.append(f"             of them contacts without area, at corners and along edges: {kinds}")
    return lines or ["joints       none: no two bodies touch"]


def _edge_loads(model: Model, *, every: bool) -> list[str]:
    """Return a line for each load along a line that lies in a joint, or not on blocks all along."""
    lines = []
    for load in model.loads:
        if load.kind not in ("pressure", "traction") or load.edge is None:
            continue
        try:
            faces = loaded_faces(model, load)
        except InputError:  # told by the assembly
            continue
        head = load_words(load)
        tolerance = line_tolerance(model, load)
        in_joint = sum(face.in_joint for face in faces)
        if in_joint > tolerance and load.face == "both":
            lines.append(f"load         {head}: in a joint, on both of its faces, as asked")
        elif in_joint > tolerance:
            named = load.face or "lower"
            other = {"lower": "upper", "upper": "lower", "left": "right", "right": "left"}[named]
            lines.append(
                f"load         {head}: in a joint, on its {named} face only (face = '{other}' or 'both' says otherwise)"
            )
    shown = lines if every else lines[:MOST_LINES]
    more = [f"             ... and {len(lines) - len(shown)} more (--all lists them)"] if shown != lines else []
    return [*shown, *more]


def _drawing(model: Model, *, every: bool) -> list[str]:
    """Return what the reader of a drawing left out as asked, and the corners it moved."""
    lines = [f"left out     {sentence}" for sentence in noted(model, "left_out")]
    moved = noted(model, "moved")
    if moved and every:
        lines += [f"moved        {sentence}" for sentence in moved]
    elif moved:
        what = "corners that nearly met" if model.dim == 2 else "repairs"
        lines.append(f"moved        {len(moved):,} {what} (--all lists every one)")
    return lines
