"""Load factors: what scales a load group, and what a group that is not named is scaled by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from concio.contact.macroscopic_strain import STRAINS


def load_factor(factors: Mapping[str, float] | None, group: str) -> float:
    """Return the factor of a load group: the one given, or 1; of a macroscopic strain that is not named 0.

    Parameters
    ----------
    factors : mapping of str to float, optional
        By load group.
    group : str
    """
    usual = 0.0 if group in STRAINS else 1.0
    return usual if factors is None else float(factors.get(group, usual))


def once(groups: str | Sequence[str]) -> tuple[str, ...]:
    """Return load groups of which one may be given by its name alone, each once.

    Parameters
    ----------
    groups : str or sequence of str
    """
    return (groups,) if isinstance(groups, str) else tuple(dict.fromkeys(groups))
