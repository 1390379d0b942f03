"""What an assessment leaves open: what was asked for, or is to be expected, and was not checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.seismic.default_parts import structures_of
from concio.analysis.seismic.local_mechanism import ABOVE
from concio.contact.assembly import Assembly
from concio.verdict.unseen import SEEN, listed, unseen_bodies

if TYPE_CHECKING:
    from concio.analysis.seismic.assessment import Assessment

ELSEWHERE = ("out of plane", "height", "ties")
"""What an author may answer for, so that it is not asked for here."""


@dataclass(frozen=True)
class OpenItem:
    """Something that was not checked.

    Parameters
    ----------
    kind : str
        "levels", "hazard", "height", "out of plane", "curve", "strips", "bound", "hand", "tie", "unseen" or "locked";
        the words are in :mod:`concio.verdict.assessment_words`.
    values : mapping
        What the words name.
    """

    kind: str
    values: Mapping[str, Any] = field(default_factory=dict)


def open_items(found: Assessment) -> tuple[OpenItem, ...]:
    """Return what an assessment leaves open.

    Parameters
    ----------
    found : Assessment
    """
    site, excused = found.site, found.arguments.get("elsewhere", ())
    items = []
    if found.arguments.get("levels") is None:
        missing = [level for level in site.asked_by_code if level not in found.levels]
        items += [OpenItem("levels", {"levels": ", ".join(missing)})] if missing else []
    items += [
        OpenItem("hazard", {"level": level, "numbers": ", ".join(site.invented(level))})
        for level in found.levels
        if site.invented(level)
    ]
    if not site.building and "height" not in excused:
        followed = [(m.name, m.level) for m in (*found.mechanisms, *found.others)]
        # what begins to move too late on the ground may be first with the amplification
        high = tuple(dict.fromkeys(at for at in (*followed, *found.late) if at[1] > ABOVE))
        items += [OpenItem("height", {"names": high})] if high else []
    if "out of plane" not in excused and not found.strips and facades_of(found.assembly):
        items.append(OpenItem("out of plane"))
    for m in found.mechanisms:
        where = {"name": m.name, "way": m.direction}
        if m.unchecked:
            levels = ", ".join(m.unchecked)
            items.append(OpenItem("curve", {**where, "levels": levels, "reason": m.followed.reason}))
        if m.found.flow == "associated":
            items.append(OpenItem("bound", {**where, "alpha": m.multiplier}))
    items += _of_strips(found)
    items += [OpenItem("hand", {"name": m.name, "way": m.direction, "alpha": m.multiplier, "hand": check.alpha})
              for m, check in zip(found.mechanisms, found.hand_checks, strict=True) if not check.agrees]  # fmt: skip
    if "ties" not in excused:
        items += [OpenItem("tie", {"tie": t.name, "force": t.strength}) for t in found.model.ties
                  if t.yield_force is None]  # fmt: skip
    if small := unseen_bodies(found.assembly, (None,)):
        told = {"names": listed(small), "verb": "is" if len(small) == 1 else "are", "share": f"{SEEN:.0e}"}
        items.append(OpenItem("unseen", told))
    none = (*found.locked, *(n for s in found.strips for n in s.locked))
    items += [OpenItem("locked", {"name": n.name, "way": n.direction}) for n in none if n.doubtful]
    return tuple(items)


def _of_strips(found: Assessment) -> list[OpenItem]:
    """Return what the curves of strips leave open beside the worst mechanism of each, one line for each reason."""
    own = [m for s in found.strips if not s.like for m in s.mechanisms[1:] if m.unchecked]
    reasons = dict.fromkeys(m.followed.reason for m in own)
    items = []
    for reason in reasons:
        alike = sorted((m for m in own if m.followed.reason == reason), key=lambda m: m.multiplier)
        levels = ", ".join(dict.fromkeys(level for m in alike for level in m.unchecked))
        first = alike[0]
        told = {"name": first.name, "way": first.direction, "alpha": first.multiplier, "n": len(alike)}
        items.append(OpenItem("strips", {**told, "levels": levels, "reason": reason}))
    return items


def facades_of(assembly: Assembly) -> list[tuple[int, ...]]:
    """Return the structures of a plane model that are wider than they are thick: facades can also leave their plane.

    Structures that touch only what is fixed are judged one by one: what stands apart makes no section a facade.
    """
    if assembly.model.dim == 3:
        return []
    outlines = assembly.model.outlines
    return [
        group
        for group in structures_of(assembly)
        if float(np.ptp(np.vstack([outlines[b].outline for b in group])[:, 0]))
        > max(outlines[b].thickness for b in group)
    ]
