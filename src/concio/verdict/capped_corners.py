"""Corners and edges of which the joint law has a compressive strength: statics makes no joint there, a motion has one.

A corner has no area, so that a force on it exceeds every strength (decision 0286). Bodies that move touch there
nevertheless, and a strength acts on a nominal length (:data:`concio.contact.slots.LONE`). Neither that such a structure
holds nor that it fails is shown.
"""

from __future__ import annotations

from dataclasses import replace

from concio.contact.touching import TOLD
from concio.display import counted
from concio.model.interfaces.detect import Detection
from concio.model.interfaces.near import NearMiss
from concio.model.model import Model

NAMED = 3
"""More places than this are counted."""


def without_capped(model: Model, detection: Detection) -> Detection:
    """Return a detection without the near misses at which bodies that move are in contact with a compressive strength.

    Parameters
    ----------
    model : Model
    detection : Detection
        Of its bodies as described.
    """
    misses = tuple(m for m in detection.near_misses if not _law(model, m))
    return replace(detection, near_misses=misses) if len(misses) < len(detection.near_misses) else detection


def capped_corners(model: Model, detection: Detection) -> tuple[str, ...]:
    """Return in a sentence what a motion does not check at corners and edges of laws with a compressive strength.

    Parameters
    ----------
    model : Model
    detection : Detection
        Of its bodies as described.
    """
    found = [(miss, name) for miss in detection.near_misses if (name := _law(model, miss))]
    if not found:
        return ()
    places = "; ".join(f"{miss.place} ({miss.kind})" for miss, _ in found[:NAMED])
    more = f" and {len(found) - NAMED:,} more" if len(found) > NAMED else ""
    laws = ", ".join(f"'{name}'" for name in dict.fromkeys(name for _, name in found))
    return (
        f"the compressive strength of {laws} at {counted(len(found), 'contact')} at a corner or along an edge, without "
        f"area as described: {places}{more}: the strength was taken on a nominal length, and 'concio run' makes no "
        "joint there. Give them a length, or a law without compressive strength",
    )


def _law(model: Model, miss: NearMiss) -> str:
    """Return the name of the law of a near miss without area that has a compressive strength, else an empty text."""
    if miss.kind not in TOLD:
        return ""
    a, b = (model.bodies[k] for k in miss.bodies)
    name = model.rule_between(a, b).law
    return name if model.laws[name].compressive_strength is not None else ""
