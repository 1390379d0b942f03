"""Contact pairs of all interfaces: points, frames, tributary areas, laws, and the operators C_n and C_t.

A corner where a block, a head joint and a bed joint meet carries three pairs for two relative motions; all three are
kept, since each belongs to an interface of its own. Displacements do not depend on how a corner shares its force;
reported forces are made reproducible by the solver's last step (least norm among equal ones).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.contact.coupling import Coupling, Line, Side, couple
from concio.contact.problem import Laws
from concio.errors import InputError
from concio.fem.discretisation import FIXED, Discretisation
from concio.fem.mesh import merged
from concio.model.detect import Interface
from concio.model.model import Body, Model

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Pairs:
    """The contact pairs of a model, m in all.

    Parameters
    ----------
    body_a, body_b : (m,) integer arrays
        Bodies of the two sides.
    interface : (m,) integer array
        Interface each pair belongs to; -1 for a tie.
    point : (m, 2) array
        Position [m].
    normal, tangent : (m, 2) arrays
        Unit vectors; n points from a to b, t is n turned left.
    length : (m,) array
        Tributary length along the interface [m].
    area : (m,) array
        Tributary area [m2].
    gap : (m,) array
        Initial gap [m].
    law : (m,) integer array
        Index into ``law_names``.
    law_names : tuple of str
    C_n, C_t : (m, N) CSR arrays
        Relative displacement b - a along n and t, on all unknowns of the discretisation.
    """

    body_a: Array
    body_b: Array
    interface: Array
    point: Array
    normal: Array
    tangent: Array
    length: Array
    area: Array
    gap: Array
    law: Array
    law_names: tuple[str, ...]
    C_n: sp.csr_array
    C_t: sp.csr_array

    def __len__(self) -> int:
        return len(self.gap)


def interface_breaks(model: Model, interfaces: Sequence[Interface]) -> Mapping[int, list[Array]]:
    """Return for each meshed body where interfaces begin and end on each edge of its outline [m]."""
    marks: dict[int, list[list[float]]] = {}
    for face in interfaces:
        for b, edge in ((face.a, face.edge_a), (face.b, face.edge_b)):
            body = model.bodies[b]
            if body.kind != "elastic" or body.grid is not None:
                continue
            found = marks.setdefault(b, [[] for _ in body.outline])
            p, q = body.outline[edge], body.outline[(edge + 1) % len(body.outline)]
            length = float(np.linalg.norm(q - p))
            tangent = (q - p) / length
            for end in (face.start, face.end):
                at = float((end - p) @ tangent)
                if 1e-6 * length < at < (1 - 1e-6) * length:
                    found[edge].append(at)
    return {b: [_distinct(v, model.bodies[b]) for v in found] for b, found in marks.items()}


def _distinct(marks: list[float], body: Body) -> Array:
    """Return marks in order, those nearer than a millionth of the body's size taken as one [m]."""
    tolerance = 1e-6 * float(np.ptp(body.outline, axis=0).max())
    return merged(np.array(marks), tolerance) if marks else np.zeros(0)


def make_pairs(disc: Discretisation, interfaces: Sequence[Interface]) -> Pairs:
    """Return the pairs of all interfaces of a discretised model.

    Raises
    ------
    InputError
        No joint law matches an interface.
    """
    model = disc.model
    law_names = tuple(model.laws)
    law_number = {name: i for i, name in enumerate(law_names)}
    templates: dict[tuple[object, ...], Coupling] = {}
    rules: dict[tuple[str, ...], tuple[int, float]] = {}
    parts: dict[str, list[Array]] = {k: [] for k in ("a", "b", "i", "p", "n", "l", "area", "g", "law")}
    triplets: list[tuple[Array, Array, Array, Array]] = []  # row, column, C_n, C_t
    by_name = _by_name(model)
    unit = 1e-9 * float(np.median(disc.reach))
    total = 0
    for number, face in enumerate(interfaces):
        body_a, body_b = model.bodies[face.a], model.bodies[face.b]
        key = (body_a.name, body_b.name) if by_name else _sort(body_a) + _sort(body_b)
        if key not in rules:
            rule = model.rule_between(body_a, body_b)
            rules[key] = (law_number[rule.law], rule.gap)
        law, opening = rules[key]
        along = face.end - face.start
        length = float(np.hypot(*along))
        along = along / length
        joint = model.laws[law_names[law]]
        points = 9 if joint.compressive_strength is not None else 5 if joint.normal_stiffness is not None else 2
        line_a, key_a = _line(disc, face.a, face.edge_a, face.start, along, unit)
        line_b, key_b = _line(disc, face.b, face.edge_b, face.start, along, unit)
        where = (key_a, key_b, round(length / unit), points)
        if where not in templates:
            templates[where] = couple(line_a, line_b, length, points)
        coupling = templates[where]
        count = len(coupling.at)
        normal = np.asarray(face.normal, dtype=float)
        tangent = np.array([-normal[1], normal[0]])
        at = face.start + np.outer(coupling.at, along)
        for b, side, sign in ((face.a, coupling.a, -1.0), (face.b, coupling.b, 1.0)):
            if disc.shape_of[b] != FIXED:
                row, column, value = _side_rows(disc, b, side, at, normal, tangent)
                triplets.append((row + total, column, sign * value[0], sign * value[1]))
        share = coupling.at / length
        gap = np.maximum(face.gap[0] * (1 - share) + face.gap[1] * share, 0.0) + opening
        parts["a"].append(np.full(count, face.a))
        parts["b"].append(np.full(count, face.b))
        parts["i"].append(np.full(count, number))
        parts["p"].append(at)
        parts["n"].append(np.tile(normal, (count, 1)))
        parts["l"].append(coupling.length)
        parts["area"].append(coupling.length * min(body_a.thickness, body_b.thickness))
        parts["g"].append(gap)
        parts["law"].append(np.full(count, law))
        total += count
    if not total:
        msg = "no two bodies touch: there is no interface at all"
        raise InputError(msg, hint="look at the model with 'concio check'; raise gap_tolerance if the drawing has gaps")
    row, column, v_n, v_t = (np.concatenate(v) for v in zip(*triplets, strict=True))
    shape = (total, disc.unknowns)
    joined = {k: np.concatenate(v) for k, v in parts.items()}
    normals = joined["n"]
    return Pairs(
        body_a=joined["a"],
        body_b=joined["b"],
        interface=joined["i"],
        point=joined["p"],
        normal=normals,
        tangent=np.column_stack([-normals[:, 1], normals[:, 0]]),
        length=joined["l"],
        area=joined["area"],
        gap=joined["g"],
        law=joined["law"],
        law_names=law_names,
        C_n=_clean(sp.csr_array((v_n, (row, column)), shape=shape)),
        C_t=_clean(sp.csr_array((v_t, (row, column)), shape=shape)),
    )


def pair_laws(model: Model, pairs: Pairs) -> Laws:
    """Return the laws of the pairs as forces and lengths: strengths times area, compliance over area."""
    laws = [model.laws[name] for name in pairs.law_names]

    def table(name: str, missing: float = 0.0) -> Array:
        values = [getattr(law, name) for law in laws]
        found: Array = np.array([missing if v is None else float(v) for v in values])[pairs.law]
        return found

    area = pairs.area

    def compliance(name: str) -> Array:
        stiffness = table(name, np.inf) * area
        return np.where(np.isfinite(stiffness), 1.0 / stiffness, 0.0)

    return Laws(
        friction=table("friction"),
        cohesion=table("cohesion") * area,
        tension=table("tensile_strength") * area,
        dilatancy=table("dilatancy"),
        normal_compliance=compliance("normal_stiffness"),
        tangential_compliance=compliance("tangential_stiffness"),
        cap=table("compressive_strength", np.inf) * area,
    )


def _by_name(model: Model) -> bool:
    names = {b.name for b in model.bodies}
    return any(word in names for rule in model.rules for word in rule.between)


def _sort(body: object) -> tuple[str, ...]:
    return tuple(getattr(body, k) for k in ("kind", "role", "layer", "material"))


def _line(
    disc: Discretisation, b: int, edge: int, start: Array, along: Array, unit: float
) -> tuple[Line | None, tuple[int, ...]]:
    """Return the nodes of one side in positions along the segment, and a key that sides equal to ``unit`` share."""
    s = int(disc.shape_of[b])
    if s < 0:
        return None, (s,)
    shape = disc.shapes[s]
    nodes = shape.edges[edge]
    corner = shape.outline[edge] + disc.origins[b]
    direction = shape.outline[(edge + 1) % len(shape.outline)] - shape.outline[edge]
    first = float((corner - start) @ along)
    forwards = float(direction @ along) > 0
    at = first + nodes.at if forwards else (first - nodes.at)[::-1]
    order = nodes.nodes if forwards else nodes.nodes[::-1]
    return Line(order, at, nodes.order), (s, edge, round(first / unit), int(forwards))


def _side_rows(
    disc: Discretisation, b: int, side: Side | None, at: Array, normal: Array, tangent: Array
) -> tuple[Array, Array, Array]:
    """Return (row, column, values (2, k)) of one side's displacement along n and t at each pair."""
    frame = np.vstack([normal, tangent])
    if side is None:  # rigid
        count = len(at)
        x, y = (at - disc.centroids[b]).T / disc.reach[b]
        rows = np.repeat(np.arange(count), 3)
        columns = disc.offsets[b] + np.tile(np.arange(3), count)
        turn = np.outer(frame[:, 1], x) - np.outer(frame[:, 0], y)  # (2, count)
        values = np.stack([np.repeat(frame[:, :1], count, 1), np.repeat(frame[:, 1:], count, 1), turn], axis=2)
        return rows, columns, values.reshape(2, -1)
    rows = np.repeat(side.pair, 2)
    columns = disc.offsets[b] + (2 * side.node[:, None] + np.arange(2)).ravel()
    values = (frame[:, None, :] * side.weight[None, :, None]).reshape(2, -1)
    return rows, columns, values


def _clean(matrix: sp.csr_array) -> sp.csr_array:
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    return matrix
