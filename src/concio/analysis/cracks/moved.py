"""The model in which every candidate is a load group of its own, so that motions are load factors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.cracks.measurement import Candidate
from concio.arguments import closest
from concio.errors import InputError
from concio.kinematics.rigid import swept
from concio.model.model import Model, Support
from concio.model.stages import Stage, cycles

Array = np.ndarray

PREFIX = "cause: "
"""Begins the name of the load group of a candidate that moves a body."""


@dataclass(frozen=True, eq=False)
class MovedModel:
    """A model with a load group for each candidate.

    Parameters
    ----------
    model : Model
    groups : tuple of str
        Load group of each candidate.
    base : mapping of str to float
        Factor of every load group before anything moves.
    unit : (k,) array
        Motion of each candidate at factor 1 [m or rad]; of a load group 1.
    times : (k,) tuple of int
        How often the group of each candidate comes and goes; 0 where it stays.
    """

    model: Model
    groups: tuple[str, ...]
    base: Mapping[str, float]
    unit: Array
    times: tuple[int, ...] = ()

    def stages(self, ends: Sequence[Array] | Array, steps: int) -> list[Stage]:
        """Return the stages to some motions (k,), one after the other, then what comes and goes, to the last."""
        returning = {g: n for g, n in zip(self.groups, self.times, strict=True) if n}
        rest = {g: self.base[g] for g in returning}
        found = [Stage(f"motion {i}", {**self.factors(end), **rest}, steps=steps) for i, end in enumerate(ends, 1)]
        far = {g: self.factors(ends[-1])[g] for g in returning}
        for group, times in returning.items():
            if far[group] != rest[group]:
                found += cycles(group, far[group], times=times, back=rest[group], steps=steps)
        return found

    def factors(self, motions: Array) -> dict[str, float]:
        """Return the load factors at motions (k,) of the candidates."""
        found = dict(self.base)
        for group, motion in zip(self.groups, (np.asarray(motions, dtype=float) / self.unit).tolist(), strict=True):
            found[group] += motion
        return found


def moved_model(model: Model, candidates: Sequence[Candidate], scale: Array) -> MovedModel:
    """Return a model with a load group for each candidate.

    Parameters
    ----------
    model : Model
    candidates : sequence of Candidate
    scale : (k,) array
        Motions of the size that is expected, which become the units of the load groups: the compliance that hard joints
        of rigid bodies are given is in proportion to them [m or rad].

    Raises
    ------
    InputError
        A candidate names a body or a group that does not exist, or a body that is not fixed; two have one name.
    """
    names = [c.name for c in candidates]
    twice = next((n for n in names if names.count(n) > 1), None)
    if not names or twice is not None:
        msg = f"two candidates are called '{twice}'" if names else "there is no candidate: nothing may have moved"
        form = "[[survey.candidates]] in a file, Candidate('pier sinks', ...) in Python"
        hint = "give each a name of its own" if names else form
        raise InputError(msg, where="candidates", hint=hint)
    known = model.load_groups
    loaded = {load.group for load in model.loads}
    base = {group: 1.0 if group in loaded else 0.0 for group in known}
    groups, supports = [], []
    unit = np.array([1.0 if c.group else s for c, s in zip(candidates, scale, strict=True)])
    for candidate, size in zip(candidates, unit.tolist(), strict=True):
        where = f"candidate '{candidate.name}'"
        if candidate.group:
            if candidate.group not in known:
                msg = f"there is no load group '{candidate.group}'"
                raise InputError(msg, where=where, hint=closest(candidate.group, known, names="groups"))
            if candidate.group in groups:
                msg = f"another candidate is the load group '{candidate.group}' already"
                raise InputError(msg, where=where, hint="leave one of them out")
            groups.append(candidate.group)
            base[candidate.group] = base[candidate.group] if candidate.base is None else candidate.base
            continue
        group = PREFIX + candidate.name
        supports.append(_support(model, candidate, size, group, where))
        groups.append(group)
        base[group] = 0.0
    return MovedModel(replace(model, supports=(*model.supports, *supports), stages=()), tuple(groups), base, unit,
                      tuple(c.times for c in candidates))  # fmt: skip


def cause_model(moved: MovedModel, candidates: Sequence[Candidate], motions: Array, group: str) -> Model:
    """Return the model whose load group ``group`` moves supports as a cause does; candidates of loads are not in it.

    Parameters
    ----------
    moved : MovedModel
    candidates : sequence of Candidate
    motions : (k,) array
    group : str
    """
    own = {g: float(s) for g, s in zip(moved.groups, motions / moved.unit, strict=True)}
    supports = []
    for support in moved.model.supports:
        if support.group not in own:
            supports.append(support)
        elif own[support.group]:
            s = own[support.group]
            turned = tuple((s * np.atleast_1d(np.asarray(support.rotation, dtype=float))).tolist())
            supports.append(
                replace(support, displacement=tuple((s * np.asarray(support.displacement, dtype=float)).tolist()),
                        rotation=turned[0] if len(turned) == 1 else turned, group=group)
            )  # fmt: skip
    return replace(moved.model, supports=tuple(supports))


def _support(model: Model, candidate: Candidate, unit: float, group: str, where: str) -> Support:
    """Return the support that moves the body of a candidate by a unit."""
    try:
        body = model.body(candidate.body)
    except InputError as error:
        raise InputError(error.what, where=where, hint=error.hint) from None
    if body.kind != "fixed":
        msg = f"'{body.name}' is not fixed: it moves with the structure"
        hint = "name a fixed body, such as the ground under it, or a load group that moves its support"
        raise InputError(msg, where=where, hint=hint)
    d = model.dim
    if candidate.direction:
        along = unit * _unit(candidate.direction, d, where, "direction")
        return Support(group, body.name, displacement=tuple(along.tolist()), group=group)
    given = candidate.rotation if isinstance(candidate.rotation, tuple) else (candidate.rotation,)
    axis = unit * _unit(given, 1 if d == 2 else 3, where, "rotation")
    turn: float | Array = float(axis[0]) if d == 2 else axis
    shift = np.zeros(d)
    if candidate.about is not None:
        point = np.asarray(candidate.about, dtype=float)
        if point.shape != (d,):
            msg = f"about = {candidate.about} has not {d} coordinates"
            raise InputError(msg, where=where)
        shift = swept(turn, np.asarray(body.centroid, dtype=float) - point)
    rotation = float(axis[0]) if d == 2 else tuple(axis.tolist())
    return Support(group, body.name, displacement=tuple(shift.tolist()), rotation=rotation, group=group)


def _unit(vector: Sequence[float], length: int, where: str, key: str) -> Array:
    given = np.asarray(vector, dtype=float)
    size = float(np.linalg.norm(given)) if given.shape == (length,) else np.nan
    if not 0 < size < np.inf:
        msg = f"{key} = {tuple(vector)} is not a direction with {length} component{'s' * (length > 1)}"
        raise InputError(msg, where=where, hint="for example (0, -1) in the plane" if length > 1 else "1 or -1")
    unit: Array = given / size
    return unit
