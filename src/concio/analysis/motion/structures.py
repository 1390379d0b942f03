"""Structures of a model that stand apart: each moves as if it stood alone, until it comes near another one.

Bodies whose boxes do not come near each other, as interfaces are looked for, and that no tie connects share nothing.
Fixed bodies connect nothing: each belongs to every structure that comes near it. The units in which contacts are looked
for, joints give way and errors are measured are then those of the structure, and what stands elsewhere changes no digit
of it. Structures that come near each other as they move become one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from concio.analysis.motion.state import Memory, MotionState, TieMemory
from concio.contact.applied import applied_forces
from concio.contact.edges import MovingEdges
from concio.contact.moving_solids import MovingSolids, renamed
from concio.contact.reference import Reference
from concio.contact.separate import free_of, grouped
from concio.contact.slots import KINDS
from concio.kinematics.placement import Placement
from concio.model.model import Load, Model, called
from concio.model.rules import rules_of

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Structure:
    """A structure, and where its things stand in the whole.

    Parameters
    ----------
    reference : Reference
        Of the structure alone.
    whole : Reference
    bodies, nodes, ties, supports : integer arrays
        Numbers in the whole.
    features : tuple of integer arrays
        The same of what names of pairs are made of: edges; in space vertices, faces and edges.
    """

    reference: Reference
    whole: Reference
    bodies: Array
    nodes: Array
    ties: Array
    supports: Array
    features: tuple[Array, ...]

    @classmethod
    def of(cls, whole: Reference, bodies: Array) -> Structure:
        """Return the structure of some bodies of a model."""
        model = whole.model
        ties, supports = np.arange(len(model.ties)), np.arange(len(model.supports))
        if len(bodies) == len(model.bodies):
            nodes = np.arange(len(whole.body_of_node))
            return cls(whole, whole, bodies, nodes, ties, supports, whole.surface.numbers(bodies))
        names = {model.bodies[b].name for b in bodies.tolist()}
        ties = np.flatnonzero([tie.body_a in names or tie.body_b in names for tie in model.ties])
        supports = np.flatnonzero([support.body in names for support in model.supports])
        own = tuple(model.bodies[b] for b in bodies.tolist())
        part = replace(
            model, bodies=own, rules=rules_of(model.rules, own),
            loads=_loads(model, bodies), ties=tuple(model.ties[k] for k in ties.tolist()),
            supports=tuple(model.supports[k] for k in supports.tolist()), stages=(), fill=None, vehicle=None,
        )  # fmt: skip
        return cls(
            Reference.of(part, whole.gravity), whole, bodies, np.flatnonzero(np.isin(whole.body_of_node, bodies)),
            ties, supports, whole.surface.numbers(bodies),
        )  # fmt: skip

    @property
    def alone(self) -> bool:
        """Whether it is the whole."""
        return self.reference is self.whole

    @property
    def name(self) -> str:
        """Name of its first body that moves."""
        return self.reference.model.bodies[int(self.reference.free[0])].name

    def part(self, state: MotionState) -> MotionState:
        """Return what a state of the whole says of the structure."""
        if self.alone:
            return state
        b, n, k = self.bodies, self.nodes, self.ties
        return MotionState(
            state.time, state.centre[b], state.rotation[b], state.velocity[b], state.spin[b], state.strain[n],
            state.nodal[n], self._own(state.memory),
            TieMemory(state.ties.sunk[k], state.ties.plastic[k], state.ties.broken[k]),
        )  # fmt: skip

    def _own(self, memory: Memory) -> Memory:
        """Return what its own pairs remember, of a memory of the whole."""
        old, new = self.whole.surface, self.reference.surface
        numbers = [np.full(count, -1) for count in old.counts]
        for number, own in zip(numbers, self.features, strict=True):
            number[own] = np.arange(len(own))
        key, kept = _renamed(memory.key, old, new, numbers)
        found = {f.name: getattr(memory, f.name)[kept] for f in fields(memory) if f.name != "key"}
        return Memory(key=key[kept], **found)

    def remembered(self, memory: Memory) -> Memory:
        """Return what its pairs remember under the names that they have in the whole."""
        key, _ = _renamed(memory.key, self.reference.surface, self.whole.surface, self.features)
        return replace(memory, key=key)


def structures_of(whole: Reference) -> list[Structure]:
    """Return the structures of a model as described; a model with one only is left as it is."""
    model = whole.model
    groups = _groups(whole, whole.at_rest().placement)
    every = np.arange(len(model.bodies))
    held = set(np.concatenate(groups).tolist())
    moved = {s.body for s in model.supports if s.moves}
    loose = any(body.name in moved for b, body in enumerate(model.bodies) if b not in held)
    return [Structure.of(whole, group) for group in (groups if len(groups) > 1 and not loose else [every])]


def near_now(structures: Sequence[Structure], state: MotionState) -> list[Structure]:
    """Return the structures where bodies stand, those as they are that came near nothing else.

    Parameters
    ----------
    structures : sequence of Structure
    state : MotionState
        Of the whole.
    """
    whole = structures[0].whole
    groups = _groups(whole, state.configuration(whole).placement, [one.bodies for one in structures])
    if len(groups) == 1:
        return [Structure.of(whole, np.arange(len(whole.model.bodies)))]
    same = {tuple(one.bodies.tolist()): one for one in structures}
    return [same.get(tuple(group.tolist())) or Structure.of(whole, group) for group in groups]


def together(structures: Sequence[Structure], states: Sequence[MotionState], state: MotionState) -> MotionState:
    """Return the state of the whole, as ``state`` but for what the states of its structures say."""
    if structures[0].alone:
        return states[0]
    names = ("centre", "rotation", "velocity", "spin")
    found = {name: getattr(state, name).copy() for name in (*names, "strain", "nodal")}
    tied = {f.name: getattr(state.ties, f.name).copy() for f in fields(TieMemory)}
    memories = []
    for one, own in zip(structures, states, strict=True):
        for name in names:
            found[name][one.bodies] = getattr(own, name)
        for name in ("strain", "nodal"):
            found[name][one.nodes] = getattr(own, name)
        for name, values in tied.items():
            values[one.ties] = getattr(own.ties, name)
        memories.append(one.remembered(own.memory))
    joined = {f.name: np.concatenate([getattr(m, f.name) for m in memories]) for f in fields(Memory)}
    return MotionState(states[0].time, memory=Memory(**joined), ties=TieMemory(**tied), **found)


def _groups(whole: Reference, placement: Placement, known: Sequence[Array] = ()) -> list[Array]:
    """Return the numbers of the bodies of each structure, where they stand; ``known`` ones stay what they are."""
    model, surface = whole.model, whole.surface
    corners = surface.placed(placement).start
    low, high = np.full((2, len(model.bodies), model.dim), np.inf) * [[[1.0]], [[-1.0]]]
    np.minimum.at(low, surface.body, corners)
    np.maximum.at(high, surface.body, corners)
    return grouped(low, high, free_of(model), model.gap_reach or 0.0, _tied(model), known)


def _tied(model: Model) -> Array:
    """Return the pairs of bodies (k, 2) that ties connect."""
    number = {b.name: i for i, b in enumerate(model.bodies)}
    pairs = [(number[t.body_a], number[t.body_b]) for t in model.ties if t.body_a and t.body_b]
    return np.array(pairs, dtype=int).reshape(-1, 2)


def _loads(model: Model, bodies: Array) -> tuple[Load, ...]:
    """Return the loads that act on some bodies, in the words that name any of these."""
    own, found = set(bodies.tolist()), []
    free = [model.bodies[b] for b in own if model.bodies[b].kind != "fixed"]
    for k, load in enumerate(model.loads):
        words = tuple(word for word in load.bodies if any(called(word, body) for body in free))
        whole = load.kind in ("weight", "body") and bool(words or not load.bodies)
        if whole or any(f.body in own for f in applied_forces(model, [k])):
            found.append(replace(load, bodies=words))
    return tuple(found)


def _renamed(
    key: Array, old: MovingEdges | MovingSolids, new: MovingEdges | MovingSolids, numbers: Sequence[Array]
) -> tuple[Array, Array]:
    """Return keys (m,) of pairs whose features have other ``numbers``, and which of them (m,) have both."""
    if isinstance(old, MovingSolids) and isinstance(new, MovingSolids):
        return renamed(key, old, new, numbers)
    edges, kind = np.divmod(key, KINDS)
    a, b = (numbers[0][v] for v in np.divmod(edges, len(old.body)))
    return (a.astype(np.int64) * len(new.body) + b) * KINDS + kind, (a >= 0) & (b >= 0)
