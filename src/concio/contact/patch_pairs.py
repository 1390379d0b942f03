"""Contact pairs of all patches of a model in space: points, frames, areas, laws, and the operators C_n and C_t."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy.sparse as sp
import shapely

from concio.contact.laws import RuleBook
from concio.contact.operators import Entries, nodal_entries, operators, rigid_entries
from concio.contact.pairs import CONTACT_MODELS, Pairs
from concio.contact.patch_coupling import FaceSide, PatchCoupling, couple_faces
from concio.contact.patch_points import CRUSHING, STIFF, corner_points, spread_points
from concio.fem.discretisation import RIGID, Discretisation
from concio.fem.solid import SolidShape
from concio.fem.solid_mesh import Mark
from concio.kinematics.frames import frames, tangents
from concio.model.interfaces.patch import Patch
from concio.model.materials import JointLaw
from concio.model.model import Model

Array = np.ndarray


def patch_marks(model: Model, patches: Sequence[Patch]) -> Mapping[int, list[Mark]]:
    """Return for each meshed body the polygons of its patches, face by face."""
    found: dict[int, list[Mark]] = {}
    for patch in patches:
        for body, face in ((patch.a, patch.face_a), (patch.b, patch.face_b)):
            if model.bodies[body].kind == "elastic":
                found.setdefault(body, []).append(Mark(face, patch.polygon))
    return found


def make_patch_pairs(disc: Discretisation, patches: Sequence[Patch]) -> Pairs:
    """Return the pairs of all patches of a discretised model, patch by patch.

    Patches between two blocks that are not meshed are written together; those with a meshed side whose two sides are
    alike (shape, face, place on it) share one coupling.

    Raises
    ------
    InputError
        No joint law matches a patch.
    """
    model = disc.model
    a, b = np.array([(p.a, p.b) for p in patches]).T
    law, opening = RuleBook(model).find(a, b)
    normal = np.array([p.normal for p in patches])
    frame = frames(normal)  # (p, 3, 3): n, t1, t2
    points = np.array([_points(model, model.laws[name]) for name in model.laws])[law]
    crushes = np.array([x.compressive_strength is not None for x in model.laws.values()])[law]
    place, area, rule, of_patch = _stated(disc, patches, points, crushes)
    count = np.array([len(x) for x in place])
    face = np.repeat(np.arange(len(patches)), count)
    where = np.concatenate(place)
    C_n, C_t = _operators(disc, (a, b), of_patch, where, face, frame)
    patch_area = np.concatenate(area)
    return Pairs(
        body_a=a[face],
        body_b=b[face],
        interface=face,
        point=where,
        normal=normal[face],
        tangents=frame[face, 1:],
        length=np.full(len(patch_area), np.nan),
        area=patch_area,
        gap=np.concatenate([patches[k].gap_at(place[k]) for k in range(len(patches))]) + opening[face],
        law=law[face],
        law_names=tuple(model.laws),
        C_n=C_n,
        C_t=C_t,
        rule=rule[face],
    )


def _stated(
    disc: Discretisation, patches: Sequence[Patch], points: Array, crushes: Array
) -> tuple[list[Array], list[Array], Array, dict[int, PatchCoupling]]:
    """Return where contact is stated on each patch, with areas, the rule, and the couplings of meshed patches.

    Parameters
    ----------
    disc : Discretisation
    patches : sequence of Patch
    points : (p,) integer array
        Points along each side of patches that are not meshed; 0 for their corners.
    crushes : (p,) boolean array
        Patches whose pressure has a cap: there points are graded towards the boundary.
    """
    a, b = np.array([(p.a, p.b) for p in patches]).T
    meshed = (disc.shape_of[a] >= 0) | (disc.shape_of[b] >= 0)
    place: list[Array] = [np.zeros((0, 3))] * len(patches)
    area: list[Array] = [np.zeros(0)] * len(patches)
    rule = np.zeros(len(patches), dtype=int)
    corner = np.flatnonzero(~meshed & (points == 0))
    if len(corner):
        at, share, count = corner_points([patches[k] for k in corner.tolist()])
        ends = np.cumsum(count)[:-1]
        for k, x, w in zip(corner.tolist(), np.split(at, ends), np.split(share, ends), strict=True):
            place[k], area[k] = x, w
        rule[corner] = CONTACT_MODELS.index("corners of the patch")
    for k in np.flatnonzero(~meshed & (points > 0)).tolist():
        place[k], area[k] = spread_points(patches[k], int(points[k]), graded=bool(crushes[k]))
        rule[k] = CONTACT_MODELS.index("points over the patch")
    couplings: dict[tuple[object, ...], PatchCoupling] = {}
    of_patch: dict[int, PatchCoupling] = {}
    for k in np.flatnonzero(meshed).tolist():
        coupling = _coupling(disc, patches[k], couplings)
        of_patch[k] = coupling
        axes = tangents(patches[k].normal)
        place[k], area[k] = patches[k].polygon[0] + coupling.at @ axes, coupling.area
        rule[k] = CONTACT_MODELS.index(coupling.model)
    return place, area, rule, of_patch


def _operators(
    disc: Discretisation, bodies: tuple[Array, Array], of_patch: Mapping[int, PatchCoupling], where: Array, face: Array,
    frame: Array,
) -> tuple[sp.csr_array, sp.csr_array]:  # fmt: skip
    """Return C_n (m, N) and C_t (2 m, N) of pairs at ``where`` (m, 3) on patches ``face`` (m,), in frames (p, 3, 3)."""
    begin = np.searchsorted(face, np.arange(len(frame)))
    entries: list[Entries] = []
    for body, sign, name in zip(bodies, (-1.0, 1.0), ("a", "b"), strict=True):
        pair = np.flatnonzero(disc.shape_of[body[face]] == RIGID)
        b = body[face[pair]]
        arm = where[pair] - disc.centroids[b]
        entries.append(rigid_entries(pair, frame[face[pair]], arm, disc.reach[b], disc.offsets[b], sign))
        for k, coupling in of_patch.items():
            side = getattr(coupling, name)
            if side is not None:
                own = np.broadcast_to(frame[k], (len(side.pair), 3, 3))
                first = disc.offsets[body[k]] + 3 * side.node
                entries.append(nodal_entries(begin[k] + side.pair, own, side.weight, first, sign))
    return operators(entries, len(where), disc.unknowns, 3)


def _points(model: Model, law: JointLaw) -> int:
    """Return how many points along each side a patch of two unmeshed blocks gets under a law; 0 for its corners."""
    if model.contact_points == "corners":
        return 0
    if model.contact_points != "auto":
        return int(model.contact_points)
    return CRUSHING if law.compressive_strength is not None else STIFF if law.normal_stiffness is not None else 0


def _coupling(
    disc: Discretisation, patch: Patch, known: dict[tuple[object, ...], PatchCoupling]
) -> PatchCoupling:
    """Return the coupling of a patch with a meshed side, the same for patches that are alike."""
    unit = 1e-9 * float(np.median(disc.reach))
    axes = tangents(patch.normal)
    key: list[object] = []
    sides: list[FaceSide | None] = []
    for body, face in ((patch.a, patch.face_a), (patch.b, patch.face_b)):
        s = int(disc.shape_of[body])
        if s < 0:
            key.append(-1)
            continue
        from_first = np.vstack([patch.polygon, *patch.holes]) - disc.origins[body]
        key += [s, face, np.round(from_first / unit).astype(np.int64).tobytes()]
    found = known.get(tuple(key))
    if found is not None:
        return found
    for body, face in ((patch.a, patch.face_a), (patch.b, patch.face_b)):
        s = int(disc.shape_of[body])
        if s < 0:
            sides.append(None)
            continue
        solid = disc.shapes[s]
        assert isinstance(solid, SolidShape)
        flat = (solid.elements.nodes + disc.origins[body] - patch.polygon[0]) @ axes.T
        sides.append(FaceSide(solid.facets[face], flat))
    rings = [(ring - patch.polygon[0]) @ axes.T for ring in (patch.polygon, *patch.holes)]
    coupling = couple_faces(sides[0], sides[1], shapely.Polygon(rings[0], rings[1:]))
    known[tuple(key)] = coupling
    return coupling
