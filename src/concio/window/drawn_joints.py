"""What the page draws and lists of the joints of a model, and what is suspicious about it: both need detection."""

from __future__ import annotations

from typing import Any

import numpy as np

from concio.contact.assembly import assemble
from concio.contact.detection import detect
from concio.errors import ConcioError
from concio.model.interfaces.detect import Detection, Interface
from concio.model.interfaces.patch import Patch
from concio.model.interfaces.point_contact import PointContact
from concio.model.model import Model
from concio.verdict.attention import attention_of
from concio.verdict.italian import in_italian
from concio.window.read_models import DIGITS

MOST_FINDINGS = 200


def contacts(model: Model) -> dict[str, Any]:
    """Return the joints of a model, what is suspicious about it, and why no question can be asked of it, if so."""
    detection = detect(model)
    attention = list(attention_of(model, detection))
    places = [(o.at, o.sentence) for o in detection.overlaps] + [(m.at, m.sentence) for m in detection.near_misses]
    return {
        "joints": _joints(model, detection),
        "attention": attention, "attention_italian": [in_italian(line) for line in attention],
        "findings": [
            {"at": np.round(at, DIGITS).tolist(), "sentence": sentence} for at, sentence in places[:MOST_FINDINGS]
        ],
        "notes": [str(s) for key in ("faults", "left_out") for s in _noted(model, key)],
        "fault": _fault(model),
    }  # fmt: skip


def _noted(model: Model, key: str) -> list[str]:
    found = model.generator.get(key, ())
    return [str(s) for s in found[:MOST_FINDINGS]] if isinstance(found, list | tuple) else []


def _joints(model: Model, detection: Detection) -> list[dict[str, Any]]:
    found = []
    for joint in detection.interfaces:
        a, b = model.bodies[joint.a], model.bodies[joint.b]
        ends: list[list[float]] = []
        if isinstance(joint, Interface):
            ends = np.round([joint.start, joint.end], DIGITS).tolist()
        elif isinstance(joint, PointContact) and model.dim == 2:
            ends = np.round(joint.points[[0, -1]], DIGITS).tolist()
        else:
            ends = np.round(joint.polygon if isinstance(joint, Patch) else joint.points, DIGITS).tolist()
        try:
            law = model.rule_between(a, b).law
        except ConcioError:
            law = ""
        found.append(
            {"a": joint.a, "b": joint.b, "ends": ends, "law": law, "size": joint.size, "gap": float(np.max(joint.gap))}
        )
    return found


def _fault(model: Model) -> dict[str, str] | None:
    """Return why no question can be asked of a model, or None."""
    try:
        assemble(model)
    except ConcioError as error:
        return {"what": error.what, "where": error.where or "", "hint": error.hint or ""}
    return None
