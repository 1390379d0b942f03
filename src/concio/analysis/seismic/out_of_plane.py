"""A facade drawn in elevation, out of its plane: its strips are searched, followed and checked like any wall.

Each strip is the section of :mod:`concio.analysis.seismic.sections`, pushed outward and inward, once where it is
symmetric; mechanisms are sought among all motions and above every course, which gives overturning from every height,
sliding, and bending between heights that are held. Strips that differ in width alone have the same numbers and are
computed once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.seismic.coverage import MOTIONS, Covered, motion_of
from concio.analysis.seismic.directions import pushes
from concio.analysis.seismic.examine import Terms
from concio.analysis.seismic.local_mechanism import LocalMechanism, NoMechanism
from concio.analysis.seismic.searching import EVERY, Search, Searched, search_all
from concio.analysis.seismic.sections import Strip
from concio.contact.assembly import assemble
from concio.errors import NoEquilibriumError
from concio.problem.solution import ProgressCallback

SENSES: Mapping[str, str] = {"left": "outward", "right": "inward"}
"""What pushes along the axis of a section are called."""

EITHER = "outward or inward"
"""Of a section that is its own mirror image: both senses give the same numbers, and one is computed."""


@dataclass(frozen=True, eq=False)
class StripFound:
    """What was found of one strip.

    Parameters
    ----------
    strip : Strip
    mechanisms : tuple of LocalMechanism
        By zeta_E, the worst first: the weakest of both senses, and those that decide something beside them.
    followed : int
        Mechanisms that were followed.
    locked : tuple of NoMechanism
    sought : int
        Searches made.
    motions : tuple of str
        That were met.
    multiplier : float
        The least that was met; ``inf`` where nothing can move.
    late : tuple of (str, float)
        What does not stand among ``mechanisms``, since it decides nothing, and the height at which it starts [m].
    like : str
        Name of an earlier strip with the same numbers, from which these are taken; empty for none.
    """

    strip: Strip
    mechanisms: tuple[LocalMechanism, ...]
    followed: int
    locked: tuple[NoMechanism, ...]
    sought: int
    motions: tuple[str, ...]
    multiplier: float
    late: tuple[tuple[str, float], ...]
    like: str = ""

    @property
    def worst(self) -> LocalMechanism | None:
        """The mechanism of least zeta_E; None where none was found."""
        return self.mechanisms[0] if self.mechanisms else None

    @property
    def motion_of_worst(self) -> str:
        """How that one moves, one of :data:`~concio.analysis.seismic.coverage.MOTIONS`; empty where none was found."""
        return "" if self.worst is None else motion_of(self.worst.found, np.array([1.0, 0.0]))

    @property
    def zeta(self) -> float:
        """The least zeta_E at the ultimate limit states."""
        return min((m.zeta for m in self.mechanisms), default=np.inf)

    @property
    def least(self) -> float:
        """The least zeta_E at all limit states."""
        return min((m.least for m in self.mechanisms), default=np.inf)


def strips_assessed(
    strips: Sequence[Strip], terms: Terms, progress: ProgressCallback | None = None
) -> tuple[StripFound, ...]:
    """Return what was found of each strip of a facade, the weakest first.

    Parameters
    ----------
    strips : sequence of Strip
        From :func:`~concio.analysis.seismic.sections.strips_of`.
    terms : Terms
    progress : callable, optional

    Raises
    ------
    NoEquilibriumError
        A strip does not stand under its weight and loads.
    """
    own = replace(terms, control=None)
    done: dict[tuple[float, ...], StripFound] = {}
    found = []
    for strip in strips:
        key = strip.likeness
        if key in done:
            found.append(_as(done[key], strip))
            continue
        try:
            done[key] = _assessed(strip, own, progress)
        except NoEquilibriumError as error:
            raise NoEquilibriumError(error.what, where=f"out of plane, {strip.name}", hint=error.hint) from None
        found.append(done[key])
    return tuple(sorted(found, key=lambda f: (f.zeta, f.least, f.multiplier)))


def of_strips(strips: Sequence[StripFound]) -> tuple[list[LocalMechanism], list[LocalMechanism]]:
    """Return the mechanisms of strips that stand beside those of the facade in its plane, and all others.

    Of each strip with numbers of its own that is the worst.
    """
    shown = [s.worst for s in strips if not s.like and s.worst is not None]
    rest = [m for s in strips if not s.like for m in s.mechanisms if m not in shown]
    return shown, rest


def covered_by(strips: Sequence[StripFound]) -> tuple[Covered, ...]:
    """Return what the search of strips covered, as a row."""
    if not strips:
        return ()
    motions = tuple(m for m in MOTIONS if any(m in s.motions for s in strips))
    least = min(s.multiplier for s in strips)
    return (Covered("strips", len(strips), len(strips), sum(s.sought for s in strips if not s.like), least, motions),)


def _assessed(strip: Strip, terms: Terms, progress: ProgressCallback | None) -> StripFound:
    ways = pushes(strip.section, "left" if strip.symmetric else "both", ())
    found = search_all([Search(p, assemble(p.model)) for p in ways], {}, terms, {}, progress)
    sense = {"left": EITHER} if strip.symmetric else SENSES
    mechanisms = tuple(replace(m, name=_name(m.name, strip), direction=sense[m.direction], section=strip.section)
                       for m in found.shown)  # fmt: skip
    none = tuple(replace(n, name=_name(n.name, strip), direction=sense[n.direction]) for n in found.locked)
    late = tuple((_name(n, strip), z) for n, z in (*((m.name, m.level) for m in found.others), *found.late))
    least = min((c.multiplier for c in found.covered), default=np.inf)
    motions = tuple(dict.fromkeys(m for c in found.covered for m in c.motions))
    return StripFound(strip, mechanisms, _followed(found), none, found.sought, motions, least, late)


def _followed(found: Searched) -> int:
    return len(found.shown) + len(found.others)


def _name(name: str, strip: Strip) -> str:
    whole = f"out of plane: {strip.name}"
    return whole if name == EVERY else f"{whole}; {name}"


def _as(found: StripFound, strip: Strip) -> StripFound:
    """Return what was found of a strip as that of another one of the same numbers."""
    return replace(found, strip=strip, like=found.strip.name)
