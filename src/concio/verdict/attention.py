"""What is suspicious about a model: one list, which every command, result, exception, ``--json`` and report carries.

Nothing here is refused. Each finding is a sentence for a person: joints that were not made, blocks that touch nothing,
blocks on bearings of millimetres, loads or parts of them that act nowhere, weights that are missing or act twice, and
implausible numbers (:mod:`concio.model.plausibility`).
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from concio.display import counted
from concio.model.interfaces.detect import Detection
from concio.model.model import Model
from concio.model.plausibility import implausible
from concio.verdict.connection import apart
from concio.verdict.lost_loads import lost_loads
from concio.verdict.narrow_bearings import narrow_bearings
from concio.verdict.odd_weights import odd_weights

ALMOST = "almost made, but not made or made only in part"
"""What is said of joints that were not made, and of nothing else."""
SO_WITH = "This is so with the joints that were made."
"""Goes before that where a structure does not stand."""
MOST_PLACES = 3
"""More joints that were not made than this are counted in a sentence; 'concio check' names every one."""
PARALLEL = 1e-6
"""Normals whose cosine differs from 1 by less are parallel."""
MOTION_TURNED = 1.85
"""What corner points carry of torsion beside uniform pressure, on a square face: 0.7071 over 0.3826."""


class HasDetection(Protocol):
    """An assembly, or anything else that holds a model with its interfaces."""

    @property
    def model(self) -> Model:
        """The model."""

    @property
    def detection(self) -> Detection:
        """Its interfaces."""


def attention(found: HasDetection) -> tuple[str, ...]:
    """Return what is suspicious about a model, a sentence each.

    Parameters
    ----------
    found : Assembly
        Or anything else that has a ``model`` and its ``detection``.
    """
    return attention_of(found.model, found.detection)


def attention_of(model: Model, detection: Detection) -> tuple[str, ...]:
    """Return what is suspicious about a model whose interfaces were detected, a sentence each.

    Parameters
    ----------
    model : Model
    detection : Detection
    """
    drawn = tuple(
        f"the drawing: {counted(len(noted(model, key)), one)} {words}left out, first: {noted(model, key)[0]}"
        for key, one, words in (("faults", "fault", "repaired or "), ("left_out", "thing", ""))
        if noted(model, key)
    )
    found = (
        *joints_not_made(detection),
        *without_area(model, detection),
        *narrow_bearings(model, detection),
        *apart(model, detection),
        *drawn,
        *lost_loads(model),
        *odd_weights(model),
        *_idle_rules(model, detection),
        *_idle_tables(model),
        *implausible(model),
    )
    return tuple(dict.fromkeys(found))


def noted(model: Model, what: str) -> tuple[str, ...]:
    """Return what the reader of a drawing or of solids noted: "faults", "left_out" or "moved"."""
    found = model.generator.get(what, ())
    return tuple(str(v) for v in found) if isinstance(found, tuple | list) else ()


def joints_not_made(detection: Detection) -> tuple[str, ...]:
    """Return in a sentence how many joints were not made, and where; none where every contact has its joint.

    Parameters
    ----------
    detection : Detection
    """
    misses = detection.near_misses
    if not misses:
        return ()
    kinds = Counter(miss.kind for miss in misses)
    places = [f"'{m.a}' and '{m.b}' at {_place(m.at)} ({m.kind})" for m in misses[:MOST_PLACES]]
    more = f" and {len(misses) - len(places):,} more" if len(misses) > len(places) else ""
    sorts = "" if len(kinds) == 1 else " (" + ", ".join(f"{n:,} {kind}" for kind, n in kinds.items()) + ")"
    return (
        f"{counted(len(misses), 'joint')} {ALMOST}{sorts}: "
        f"{'; '.join(places)}{more}: 'concio check --all' names each",
    )


def without_area(model: Model, detection: Detection) -> tuple[str, ...]:
    """Return in a sentence how many contacts stand at corners and along edges, and what does not act there.

    Parameters
    ----------
    model : Model
    detection : Detection
    """
    bare = detection.point_contacts
    if not bare:
        return ()
    names = [body.name for body in model.bodies]
    places = "; ".join(
        f"'{names[c.a]}' and '{names[c.b]}' at {_place(c.middle)} ({c.kind})" for c in bare[:MOST_PLACES]
    )
    more = f" and {len(bare) - MOST_PLACES:,} more" if len(bare) > MOST_PLACES else ""
    laws = dict.fromkeys(model.rule_between(model.bodies[c.a], model.bodies[c.b]).law for c in bare)
    some = [
        f"'{name}'"
        for name in laws
        if (law := model.laws[name]).cohesion or law.tensile_strength or law.normal_stiffness is not None
    ]
    without = f"; cohesion, tensile strength and stiffness of {', '.join(some)} do not act there" if some else ""
    many = sum(c.ambiguous for c in bare)
    middle = (
        f"; of {many:,} without a face on either side the normal is the middle of the directions in which they can part"
        if many
        else ""
    )
    return (
        f"{counted(len(bare), 'contact')} at a corner or along an edge, without area: hard, with friction alone, and "
        f"no pressure is checked there: {places}{more}{without}{middle}",
    )


def _place(at: Sequence[float] | np.ndarray) -> str:
    return f"({', '.join(f'{v:.4g}' for v in at)}) m"


def _idle_rules(model: Model, detection: Detection) -> tuple[str, ...]:
    """Return a sentence for each joint rule that decides no joint."""
    if not detection.interfaces or len(model.rules) < 2:
        return ()
    bodies = model.bodies
    deciding = {id(model.rule_between(bodies[i.a], bodies[i.b])) for i in detection.interfaces}
    return tuple(
        f"rule {k}, law '{rule.law}' between '{rule.between[0]}' and '{rule.between[1]}', decides no joint: none lies "
        "between such bodies, or a later rule decides it"
        for k, rule in enumerate(model.rules, 1)
        if id(rule) not in deciding and rule.between != ("*", "*")
    )


def _idle_tables(model: Model) -> tuple[str, ...]:
    """Return a sentence for each joint law that no rule names, and for each material that no body is of.

    What equals one that is used may have been used: generators give laws and materials names of their own. "block" is
    what readers of solids and drawings call the first material, and need not be that of a body.
    """
    ruling, made = {rule.law for rule in model.rules}, {b.material for b in model.bodies} | {"block"}
    laws = [model.laws[name] for name in model.laws if name in ruling]
    stones = [model.materials[name] for name in model.materials if name in made]
    return (
        *(f"joint law '{name}' is stated, and no rule names it: it holds in no joint"
          for name, law in model.laws.items() if law not in laws),
        *(f"material '{name}' is stated, and no body is made of it"
          for name, stone in model.materials.items() if stone not in stones),
    )  # fmt: skip


def torsion(model: Model, detection: Detection, contact_model: Mapping[str, int]) -> tuple[str, ...]:
    """Return a sentence where blocks can turn about joints whose pressure stands at their corners.

    Parameters
    ----------
    model : Model
        In space; of a plane model there is nothing to say.
    detection : Detection
    contact_model : mapping
        Number of joints by the statement of contact, ``pairs.contact_model``.
    """
    if "corners of the patch" not in contact_model:
        return ()
    normals: dict[int, list[np.ndarray]] = defaultdict(list)
    for patch in detection.patches:
        for body in (patch.a, patch.b):
            if model.bodies[body].kind == "rigid":
                normals[body].append(patch.normal)
    parallel = [b for b, own in normals.items() if all(abs(n @ own[0]) > 1 - PARALLEL for n in own)]
    if not parallel:
        return ()
    return (
        f"{counted(len(parallel), 'block')} held by parallel joints alone, stated at their corners: friction resists "
        f"torsion there up to {MOTION_TURNED:g} times better than under uniform pressure (contact_points = 4 spreads "
        "it, in answers and load steps; the associated bound of 'concio limit' stays that of the corners)",
    )
