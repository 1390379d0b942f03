"""What ``concio check`` prints: the parts of a model, and everything that was noticed about its geometry."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.contact.assembly import Assembly
from concio.contact.load_faces import covered, line_tolerance, loaded_faces
from concio.display import number
from concio.errors import InputError
from concio.fem.discretisation import RIGID
from concio.model.described import law_words, material_words
from concio.model.interfaces.detect import Detection
from concio.model.interfaces.patches import Patch
from concio.model.model import Body, Model
from concio.model.plausibility import implausible
from concio.model.polyhedron import Polyhedron

BEARS = 1e-3
"""A face that looks up by less carries nothing without friction."""
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
        "attention": [*implausible(model), *_apart(model, detection)],
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
    lines += _interfaces(model, detection)
    if facts:
        stated = ", ".join(f"{count:,} {name}" for name, count in facts["contact_model"].items())
        lines.append(f"contact      {facts['pairs']:,} pairs ({stated}), {facts['unknowns']:,} displacements")
        lines += _torsion(model, detection, facts["contact_model"])
    for group in model.load_groups:
        kinds = Counter(load.kind for load in model.loads if load.group == group)
        words = [f"{n} {kind}" for kind, n in kinds.items()]
        moved = sum(s.group == group for s in model.supports)
        words += [f"{moved} support{'s' if moved > 1 else ''}"] if moved else []
        total = facts.get("total_load", {}).get(group)
        force = f", {units.force_vector(total)} in all" if total else ""
        lines.append(f"load group   {group}: {', '.join(words)}{force}")
    if model.periods is None and not model.loads and not any(s.moves for s in model.supports):
        lines.append("attention    there are no loads and nothing is moved: everything stays as it is")
    lines += _edge_loads(model, every=every) if model.dim == 2 else []
    for tie in model.ties:
        lines.append(f"tie          {tie.name}: {tie.body_a} to {tie.body_b or 'a fixed point'}")
    geometry = [f"overlap      {o.sentence}" for o in detection.overlaps if o.sentence not in fault]
    geometry += [f"near miss    {m.sentence}" for m in detection.near_misses]
    noticed = (*implausible(model), *_apart(model, detection), *_noted(model, "faults"))
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
    deciding: set[int] = set()
    length: dict[str, float] = defaultdict(float)
    apart: Counter[str] = Counter()
    for interface in detection.interfaces:
        rule = model.rule_between(model.bodies[interface.a], model.bodies[interface.b])
        found[rule.law] += 1
        deciding.add(id(rule))
        length[rule.law] += interface.area if isinstance(interface, Patch) else interface.length
        apart[rule.law] += bool(rule.gap or interface.gap.max() > 0)
    lines = []
    for law, count in found.items():
        text = f"joints       {count:,} with law '{law}', {length[law]:.4g} {'m' if model.dim == 2 else 'm2'} in all"
        lines.append(text + (f", {apart[law]:,} of them open at first" if apart[law] else ""))
    for k, rule in enumerate(model.rules, 1):
        if detection.interfaces and id(rule) not in deciding and rule.between != ("*", "*"):
            a, b = rule.between
            lines.append(
                f"attention    rule {k}, law '{rule.law}' between '{a}' and '{b}', decides no joint: none lies between "
                f"such bodies, or a later rule decides it"
            )
    return lines or ["joints       none: no two bodies touch"]


def _apart(model: Model, detection: Detection) -> list[str]:
    """Return sentences on blocks that touch nothing that stands, on groups that do not touch, and on what hangs."""
    number = {body.name: k for k, body in enumerate(model.bodies)}
    ground = len(model.bodies)
    links = [(i.a, i.b) for i in detection.interfaces]
    links += [(number[tie.body_a], number.get(tie.body_b, ground)) for tie in model.ties]
    links += [(number[support.body], ground) for support in model.supports]
    links += [(k, ground) for k, body in enumerate(model.bodies) if body.kind == "fixed"]
    if model.periods is not None or not detection.interfaces:
        return []
    part = _groups(links, ground + 1)
    loose = [body.name for k, body in enumerate(model.bodies) if part[k] != part[ground]]
    found = []
    if loose:
        words = ("touches nothing that stands: it falls", "touch nothing that stands: they fall")[len(loose) > 1]
        found.append(f"{_first(loose)} {words}; are all of them where they should be?")
    if model.dim == 2:
        return found
    free = [k for k, body in enumerate(model.bodies) if body.kind != "fixed" and part[k] == part[ground]]
    among = _groups([(p, q) for p, q in links if {p, q} <= set(free)], ground + 1)
    groups: dict[int, list[str]] = defaultdict(list)
    for k in free:
        groups[int(among[k])].append(model.bodies[k].name)
    if len(groups) > 1:
        shown = sorted(groups.values(), key=len, reverse=True)
        words = ", ".join(_first(names, 1) for names in shown[:3]) + (", ..." if len(shown) > 3 else "")
        found.append(f"the blocks are in {len(shown):,} groups that do not touch: {words}; is that meant?")
    return found + _hanging(model, detection)


def _groups(links: list[tuple[int, int]], count: int) -> np.ndarray:
    """Return the number of the group (count,) of each body, of those that links hold together."""
    a, b = np.array(links, dtype=int).reshape(-1, 2).T
    graph = sp.coo_array((np.ones(len(a)), (a, b)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _first(names: list[str], most: int = 3) -> str:
    more = f" and {len(names) - most:,} more" if len(names) > most else ""
    return ", ".join(f"'{name}'" for name in names[:most]) + more


def _hanging(model: Model, detection: Detection) -> list[str]:
    """Return a sentence on the blocks in space that touch others, none of which is under them to any degree."""
    held = {tie.body_a for tie in model.ties} | {tie.body_b for tie in model.ties} | {s.body for s in model.supports}
    touched = {k for patch in detection.patches for k in (patch.a, patch.b)}
    borne = {p.b for p in detection.patches if p.normal[2] > BEARS}
    borne |= {p.a for p in detection.patches if p.normal[2] < -BEARS}
    bodies = [model.bodies[k] for k in sorted(touched - borne)]
    names = [b.name for b in bodies if b.kind != "fixed" and b.name not in held]
    if not names or not any(load.kind == "weight" for load in model.loads):
        return []
    words = ("has nothing under it", "have nothing under them")[len(names) > 1]
    return [f"{_first(names)} {words}: only friction at the sides can hold that; is a lintel or a pier missing?"]


def _torsion(model: Model, detection: Detection, contact_model: Mapping[str, int]) -> list[str]:
    """Return a line where blocks can turn about joints whose pressure stands at their corners."""
    if "corners of the patch" not in contact_model:
        return []
    normals: dict[int, list[np.ndarray]] = defaultdict(list)
    for patch in detection.patches:
        for body in (patch.a, patch.b):
            if model.bodies[body].kind == "rigid":
                normals[body].append(patch.normal)
    parallel = [b for b, own in normals.items() if all(abs(n @ own[0]) > 1 - 1e-6 for n in own)]
    if not parallel:
        return []
    word = "block is" if len(parallel) == 1 else "blocks are"
    return [
        f"attention    {len(parallel):,} {word} held by parallel joints alone, stated at their corners: friction "
        "resists torsion there up to 1.85 times better than under uniform pressure (contact_points = 4 spreads it, in "
        "answers and load steps; the associated bound of 'concio limit' stays that of the corners)"
    ]


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
        what = "corners that nearly met" if model.dim == 2 else "repairs"
        lines.append(f"moved        {len(moved):,} {what} (--all lists every one)")
    return lines


def _noted(model: Model, what: str) -> tuple[str, ...]:
    """Return what the reader of a drawing noted."""
    found = model.generator.get(what, ())
    return tuple(str(v) for v in found) if isinstance(found, tuple | list) else ()


def resultants(assembly: Assembly) -> dict[str, list[float]]:
    """Return the resultant (x, y) or (x, y, z) of each load group [kN]."""
    disc = assembly.disc
    found = {}
    for group, f in assembly.loads.items():
        d = disc.dim
        total = np.zeros(d)
        for b, free in enumerate(np.diff(disc.offsets)):
            own = f[disc.offsets[b] : disc.offsets[b + 1]]
            total += own[:d] if disc.shape_of[b] == RIGID else own.reshape(-1, d).sum(0) if free else 0.0
        found[group] = total.tolist()
    return found
