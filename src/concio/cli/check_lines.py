"""What ``concio check`` prints: the parts of a model, and everything that was noticed about its geometry."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np

from concio.contact.assembly import Assembly
from concio.contact.load_faces import covered, line_tolerance, loaded_faces
from concio.display import number
from concio.errors import InputError
from concio.fem.discretisation import RIGID
from concio.model.described import law_words, material_words
from concio.model.interfaces.detect import Detection
from concio.model.model import Body, Model
from concio.model.plausibility import implausible

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
        "attention": list(implausible(model)),
        "drawing_faults": list(_noted(model, "faults")),
        "left_out": list(_noted(model, "left_out")),
        "moved": list(_noted(model, "moved")),
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
        The error that will be told after these lines; an overlap that it names is not listed.
    """
    units = model.report
    scale, symbol = units.factor("length")
    width, height = np.ptp(np.vstack([body.outline for body in model.outlines]), axis=0)
    lines = [
        model.title or "model without a title",
        f"size         {number(scale * width, 4)} x {number(scale * height, 4)} {symbol}, plane {model.plane}, "
        f"elements {model.element}",
        *_bodies(model, float(max(width, height)), every=every),
    ]
    if model.periods is not None:
        (a, b), (c, d) = model.periods
        share = sum(body.area for body in model.outlines) / abs(a * d - b * c)
        voids = "" if share > 1 - 1e-6 else f", {100 * (1 - share):.3g} % of it empty"
        lines.append(f"cell         repeats by ({a:.6g}, {b:.6g}) and ({c:.6g}, {d:.6g}) m{voids}")
    lines += [f"material     {name}: {material_words(given, units)}" for name, given in model.materials.items()]
    lines += [f"joint law    {name}: {law_words(law, units)}" for name, law in model.laws.items()]
    lines += _interfaces(model, detection)
    if facts:
        lines.append(f"contact      {facts['pairs']:,} pairs, {facts['unknowns']:,} displacements")
    for group in model.load_groups:
        kinds = Counter(load.kind for load in model.loads if load.group == group)
        words = [f"{n} {kind}" for kind, n in kinds.items()]
        moved = sum(s.group == group for s in model.supports)
        words += [f"{moved} support{'s' if moved > 1 else ''}"] if moved else []
        total = facts.get("total_load", {}).get(group)
        force = f", {units.force_vector((total[0], total[1]))} in all" if total else ""
        lines.append(f"load group   {group}: {', '.join(words)}{force}")
    if model.periods is None and not model.loads and not any(any(s.displacement) or s.rotation for s in model.supports):
        lines.append("attention    there are no loads and nothing is moved: everything stays as it is")
    lines += _edge_loads(model, every=every)
    for tie in model.ties:
        lines.append(f"tie          {tie.name}: {tie.body_a} to {tie.body_b or 'a fixed point'}")
    geometry = [f"overlap      {o.sentence}" for o in detection.overlaps if o.sentence not in fault]
    geometry += [f"near miss    {m.sentence}" for m in detection.near_misses]
    findings = [f"attention    {sentence}" for sentence in (*implausible(model), *_noted(model, "faults"))] + geometry
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
        for body in model.outlines:
            x, y = np.round(body.centroid / size, 9) * size + 0.0
            lines.append(
                f"  '{body.name}': {_corners(body)}, area {body.area:.4g} m2, centroid ({x:.4g}, {y:.4g}) m"
            )
    return lines


def _corners(body: Body) -> str:
    holes = f" with {len(body.holes)} hole{'s' if len(body.holes) > 1 else ''}" if body.holes else ""
    return f"{len(body.outline)} vertices{holes}"


def _interfaces(model: Model, detection: Detection) -> list[str]:
    found: Counter[str] = Counter()
    deciding: set[int] = set()
    length: dict[str, float] = defaultdict(float)
    apart: Counter[str] = Counter()
    for interface in detection.segments:
        rule = model.rule_between(model.bodies[interface.a], model.bodies[interface.b])
        found[rule.law] += 1
        deciding.add(id(rule))
        length[rule.law] += interface.length
        apart[rule.law] += bool(rule.gap or interface.gap.max() > 0)
    lines = []
    for law, count in found.items():
        text = f"joints       {count:,} with law '{law}', {length[law]:.4g} m in all"
        lines.append(text + (f", {apart[law]:,} of them open at first" if apart[law] else ""))
    for k, rule in enumerate(model.rules, 1):
        if detection.interfaces and id(rule) not in deciding and rule.between != ("*", "*"):
            a, b = rule.between
            lines.append(
                f"attention    rule {k}, law '{rule.law}' between '{a}' and '{b}', decides no joint: none lies between "
                f"such bodies, or a later rule decides it"
            )
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
        ends = np.array(load.edge, dtype=float)
        length, loaded = float(np.hypot(*(ends[1] - ends[0]))), covered(faces)
        tolerance = line_tolerance(model)
        in_joint = sum(face.in_joint for face in faces)
        value = ", ".join(f"{v:g}" for v in load.value)
        head = f"{load.kind} ({value}) kN/m2 in group '{load.group}' from ({ends[0, 0]:.4g}, {ends[0, 1]:.4g}) to "
        head += f"({ends[1, 0]:.4g}, {ends[1, 1]:.4g}) m"
        if in_joint > tolerance and load.face == "both":
            lines.append(f"load         {head}: in a joint, on both of its faces, as asked")
        elif in_joint > tolerance:
            named = load.face or "lower"
            other = {"lower": "upper", "upper": "lower", "left": "right", "right": "left"}[named]
            lines.append(
                f"load         {head}: in a joint, on its {named} face only (face = '{other}' or 'both' says otherwise)"
            )
        if length - loaded > max(2 * tolerance, 0.005 * length):
            lines.append(f"attention    {head}: only {loaded:.4g} m of its {length:.4g} m lie on edges of its blocks")
    shown = lines if every else lines[:MOST_LINES]
    more = [f"             ... and {len(lines) - len(shown)} more (--all lists them)"] if shown != lines else []
    return [*shown, *more]


def _drawing(model: Model, *, every: bool) -> list[str]:
    """Return what the reader of a drawing left out as asked, and the corners it moved."""
    lines = [f"left out     {sentence}" for sentence in _noted(model, "left_out")]
    moved = _noted(model, "moved")
    if moved and every:
        lines += [f"moved        {sentence}" for sentence in moved]
    elif moved:
        lines.append(f"moved        {len(moved):,} corners that nearly met (--all lists every one)")
    return lines


def _noted(model: Model, what: str) -> tuple[str, ...]:
    """Return what the reader of a drawing noted."""
    found = model.generator.get(what, ())
    return tuple(str(v) for v in found) if isinstance(found, tuple | list) else ()


def resultants(assembly: Assembly) -> dict[str, list[float]]:
    """Return the resultant (x, y) of each load group [kN]."""
    disc = assembly.disc
    found = {}
    for group, f in assembly.loads.items():
        total = np.zeros(2)
        for b, free in enumerate(np.diff(disc.offsets)):
            own = f[disc.offsets[b] : disc.offsets[b + 1]]
            total += own[:2] if disc.shape_of[b] == RIGID else own.reshape(-1, 2).sum(0) if free else 0.0
        found[group] = total.tolist()
    return found
