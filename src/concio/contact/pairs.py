"""Contact pairs of all interfaces: points, frames, tributary areas, laws, and the operators C_n and C_t.

A corner where a block, a head joint and a bed joint meet carries three pairs for two relative motions; all three are
kept, since each belongs to an interface of its own. Displacements do not depend on how a corner shares its force;
reported forces are made reproducible by the solver's last step (least norm among equal ones).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.contact.coupling import Line, couple
from concio.contact.laws import LawTable, RuleBook
from concio.contact.operators import Entries, nodal_entries, operators, rigid_entries
from concio.contact.sides import FacingSides
from concio.errors import InputError
from concio.fem.discretisation import RIGID, Discretisation
from concio.kinematics.frames import frames
from concio.model.interfaces.detect import Interface
from concio.model.model import Model
from concio.problem.contact_problem import Laws
from concio.read_only import read_only
from concio.representation import short_repr

Array = np.ndarray

CONTACT_MODELS = (
    "ends of the joint", "points along the joint", "node pairs", "dual mortar", "corners of the patch",
    "points over the patch", "tie", "corner or edge",
)  # fmt: skip
"""Where contact is stated: between two blocks that are not meshed at the ends or corners of their interface or at
quadrature points over it, else at pairs of nodes or at the nodes of one side with dual functions; at corners and edges
that touch without a common face."""


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class Pairs:
    """The contact pairs of a model, m in all.

    Parameters
    ----------
    body_a, body_b : (m,) integer arrays
        Bodies of the two sides.
    interface : (m,) integer array
        Interface each pair belongs to; -1 for a tie.
    point : (m, d) array
        Position [m].
    normal : (m, d) array
        Unit vector from a to b.
    tangents : (m, d-1, d) array
        Unit vectors: in the plane n turned left, in space two that are right-handed with n.
    length : (m,) array
        Tributary length along the interface [m]; nan in space, where an area is what a pair has.
    area : (m,) array
        Tributary area [m2]; 0 at corners and edges that touch without a common face.
    gap : (m,) array
        Initial gap [m].
    law : (m,) integer array
        Index into ``law_names``.
    law_names : tuple of str
    C_n : (m, N) CSR array
        Relative displacement b - a along n, on all unknowns of the discretisation.
    C_t : (m (d-1), N) CSR array
        The same along the tangents, pair by pair.
    rule : (m,) integer array
        Where contact of the pair is stated and what area it stands for: index into :data:`CONTACT_MODELS`.
    """

    body_a: Array
    body_b: Array
    interface: Array
    point: Array
    normal: Array
    tangents: Array
    length: Array
    area: Array
    gap: Array
    law: Array
    law_names: tuple[str, ...]
    C_n: sp.csr_array
    C_t: sp.csr_array
    rule: Array

    def __len__(self) -> int:
        return len(self.gap)

    @property
    def tangent(self) -> Array:
        """The tangent of each pair (m, 2), of plane models; in space each pair has two, see ``tangents``.

        Raises
        ------
        InputError
            The model is in space.
        """
        if self.tangents.shape[1] != 1:
            msg = "a contact pair in space has two tangents, and friction a component along each"
            raise InputError(msg, hint="they are in pairs.tangents (m, 2, 3)")
        first: Array = self.tangents[:, 0]
        return first

    @property
    def contact_model(self) -> dict[str, int]:
        """Number of pairs by the way in which their contact is stated."""
        count = np.bincount(self.rule, minlength=len(CONTACT_MODELS))
        return {name: int(n) for name, n in zip(CONTACT_MODELS, count, strict=True) if n}


def make_pairs(disc: Discretisation, interfaces: Sequence[Interface]) -> Pairs:
    """Return the pairs of all interfaces of a discretised model, interface by interface.

    Interfaces whose sides are alike (shape, edge, place on it, length, kind of joint) share one coupling, and their
    pairs are written together: the Python loop runs over the different couplings only.

    Raises
    ------
    InputError
        No joint law matches an interface.
    """
    model = disc.model
    sides = FacingSides.of(model.outlines, interfaces)
    law, opening = RuleBook(model).find(sides.a, sides.b)
    along = sides.end - sides.start
    length = np.hypot(*along.T)
    along = along / length[:, None]
    unit = 1e-9 * float(np.median(disc.reach))
    first_a, forwards_a, key_a = place(disc, sides.a, sides.edge_a, sides.p_a, sides.q_a, sides.start, along, unit)
    first_b, forwards_b, key_b = place(disc, sides.b, sides.edge_b, sides.p_b, sides.q_b, sides.start, along, unit)
    points = LawTable.of(model).points[law]
    keys = np.column_stack([key_a, key_b, np.round(length / unit).astype(np.int64), points])
    _, example, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    couplings = [
        couple(
            line_of(disc, int(sides.a[i]), int(sides.edge_a[i]), float(first_a[i]), bool(forwards_a[i])),
            line_of(disc, int(sides.b[i]), int(sides.edge_b[i]), float(first_b[i]), bool(forwards_b[i])),
            float(length[i]),
            int(points[i]),
        )
        for i in example
    ]
    group = group.ravel()
    count = np.array([len(c.at) for c in couplings])[group]
    begin = np.concatenate([[0], np.cumsum(count)])
    total = int(begin[-1])
    at, own_length = np.zeros(total), np.zeros(total)
    order = np.argsort(group, kind="stable")
    ends = np.searchsorted(group[order], np.arange(len(couplings) + 1))
    face = np.repeat(np.arange(len(interfaces)), count)
    frame = frames(sides.normal)
    entries: list[Entries] = []
    for g, coupling in enumerate(couplings):
        members = order[ends[g] : ends[g + 1]]
        rows = begin[members][:, None] + np.arange(len(coupling.at))
        at[rows], own_length[rows] = coupling.at, coupling.length
        for body, side, sign in ((sides.a, coupling.a, -1.0), (sides.b, coupling.b, 1.0)):
            if side is not None:
                pair = (begin[members][:, None] + side.pair).ravel()
                first = (disc.offsets[body[members]][:, None] + 2 * side.node).ravel()
                weight = np.tile(side.weight, len(members))
                entries.append(nodal_entries(pair, frame[face[pair]], weight, first, sign))
    where = sides.start[face] + at[:, None] * along[face]
    own = where - sides.shift[face]  # the same points on b itself, not on its image across the cell
    for body, points_of, sign in ((sides.a[face], where, -1.0), (sides.b[face], own, 1.0)):
        pair = np.flatnonzero(disc.shape_of[body] == RIGID)
        b = body[pair]
        arm = points_of[pair] - disc.centroids[b]
        entries.append(rigid_entries(pair, frame[face[pair]], arm, disc.reach[b], disc.offsets[b], sign))
    C_n, C_t = operators(entries, total, disc.unknowns, 2)
    share = at / length[face]
    gap = np.maximum(sides.gap[face, 0] * (1 - share) + sides.gap[face, 1] * share, 0.0) + opening[face]
    thickness = np.array([b.thickness for b in model.bodies])
    return Pairs(
        body_a=sides.a[face],
        body_b=sides.b[face],
        interface=face,
        point=where,
        normal=sides.normal[face],
        tangents=frame[face, 1:],
        length=own_length,
        area=own_length * np.minimum(thickness[sides.a], thickness[sides.b])[face],
        gap=gap,
        law=law[face],
        law_names=tuple(model.laws),
        C_n=C_n,
        C_t=C_t,
        rule=np.array([CONTACT_MODELS.index(c.model) for c in couplings])[group][face],
    )


def pair_laws(model: Model, pairs: Pairs) -> Laws:
    """Return the laws of the pairs as forces and lengths: strengths times area, compliance over area.

    What is apart at first is not bonded: pairs with an initial gap have friction, but no cohesion and no tension.
    """
    return LawTable.of(model).laws(pairs.law, pairs.area, pairs.gap <= 0)


def place(
    disc: Discretisation, body: Array, edge: Array, p: Array, q: Array, start: Array, along: Array, unit: float
) -> tuple[Array, Array, Array]:
    """Return where edges begin along their segments (i,) [m], whether they run forwards, and keys equal to ``unit``."""
    shape = disc.shape_of[body]
    first = ((p - start) * along).sum(1)
    forwards = ((q - p) * along).sum(1) > 0
    key = np.column_stack([edge, np.round(first / unit).astype(np.int64), forwards.astype(np.int64)])
    key[shape < 0] = 0
    return first, forwards, np.column_stack([shape, key])


def line_of(
    disc: Discretisation, b: int, edge: int, first: float, forwards: bool, cosine: float = 1.0
) -> Line | None:
    """Return the nodes of one side in positions along the segment; None where it is not meshed.

    An edge that is turned against the segment is projected onto it: ``cosine`` is that of the angle between them.
    """
    if disc.shape_of[b] < 0:
        return None
    nodes = disc.shapes[disc.shape_of[b]].edges[edge]
    at = cosine * nodes.at
    if forwards:
        return Line(nodes.nodes, first + at, nodes.order)
    return Line(nodes.nodes[::-1], (first - at)[::-1], nodes.order)
