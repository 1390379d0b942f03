"""concio as a solver of problems of compas_dem: ``solve_problem(problem)`` returns its ``Results``.

compas_dem works in N, m and kg; concio in kN and m. Contacts are found by concio: ``compute_contacts`` is not needed.
The package compas_dem is needed to run this module, not to import it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from concio.analysis.step import solve
from concio.errors import InputError
from concio.io.compas_json import block_model
from concio.kinematics.frames import cross
from concio.kinematics.rigid import rotation_matrix
from concio.model.materials import JointLaw, Rigid
from concio.model.model import Load, Model, Support
from concio.model.solids.importing import model_from_solids

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

NEWTON = 1e-3
"""kN."""
HINT = "pip install compas_dem"


def model_of_problem(problem: Any) -> Model:
    """Return the model of a problem of compas_dem: rigid blocks, supports, weight, loads and prescribed displacements.

    Parameters
    ----------
    problem : compas_dem.problem.Problem
        With its model and a Mohr-Coulomb contact model. Each block needs a material with a density [kg/m3].

    Raises
    ------
    InputError
        A block has no density, the problem no contact model, or it has something that concio cannot represent.
    GeometryError
        Blocks have faults, as in :func:`concio.model_from_solids`.

    Notes
    -----
    Bodies have the names of their elements where these are unique, else ``b`` and the node of the graph. Cohesion and
    the tensile strength of the contact model are used. The stiffness of a joint model is not: blocks touch in hard
    joints.
    """
    names, elements = names_of(problem.model), list(problem.model.elements())
    shapes = [(names[e.graphnode], bool(e.is_support), *_mesh(e)) for e in elements]
    law = _law(problem)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "blocks.json"
        file.write_text(json.dumps(block_model(shapes, "blocks")), encoding="utf-8")
        model = model_from_solids(file, block="rigid", friction=law)
    weights = {names[e.graphnode]: _unit_weight(e, problem) for e in elements if not e.is_support}
    stones = {weight: f"stone {k}" for k, weight in enumerate(dict.fromkeys(weights.values()), 1)}
    materials = {name: Rigid(unit_weight=weight) for weight, name in stones.items()}
    bodies = tuple(replace(b, material=stones[weights[b.name]]) if b.name in weights else b for b in model.bodies)
    groups = problem.boundary_conditions
    loads = [load for group in groups for load in _loads(group, problem.model, names, weights, _gravity(problem))]
    supports = [support for group in groups for support in _supports(group, problem.model, names)]
    return replace(model, bodies=bodies, materials=materials, loads=(*model.loads, *loads), supports=tuple(supports))


def solve_problem(problem: Any, *, on_failure: Literal["raise", "return"] = "raise") -> Any:
    """Solve a problem of compas_dem with concio and return its results.

    Parameters
    ----------
    problem : compas_dem.problem.Problem
        As in :func:`model_of_problem`.
    on_failure : {"raise", "return"}
        What to do where no certified equilibrium was found: raise, as :func:`concio.solve` does, or return results
        without forces.

    Returns
    -------
    compas_dem.problem.Results
        ``transformation`` of each block, and for each pair of blocks in contact forces in N on the first node of the
        edge: ``resultant_global``, ``force_vector`` at ``contact_points``, ``contact_data``. ``metadata["verdict"]``
        holds concio's verdict with its certificate.

    Raises
    ------
    InputError, GeometryError, NoEquilibriumError, SolverError
        As :func:`model_of_problem` and :func:`concio.solve`.
    """
    try:
        dem = import_module("compas_dem.problem")
    except ImportError:
        msg = "problems of compas_dem need the package compas_dem, which is not installed"
        raise InputError(msg, where="compas_dem", hint=HINT) from None
    result = solve(model_of_problem(problem), on_failure=on_failure)
    results = dem.Results(model_id=str(problem.model.guid), problem_id=str(problem.guid))
    results.metadata["solver"] = "concio"
    results.metadata["verdict"] = result.verdict.as_dict()
    if not result.solved:
        return results
    node = {name: key for key, name in names_of(problem.model).items()}
    geometry = import_module("compas.geometry")
    for body in result.model.bodies:
        matrix = _motion(result, body.name)
        results.set_node(node[body.name], "transformation", geometry.Transformation(matrix=matrix.tolist()))
    for edge, data in _edges(result, node, problem.model.graph):
        for name, value in data.items():
            results.set_edge(edge, name, value)
    return results


def names_of(model: Any) -> dict[int, str]:
    """Return the name of the body of each node of the graph of a compas_dem model."""
    elements = list(model.elements())
    given = [str(e.name) for e in elements]
    return {
        e.graphnode: name if given.count(name) == 1 and name != type(e).__name__ else f"b{e.graphnode}"
        for e, name in zip(elements, given, strict=True)
    }


def _mesh(element: Any) -> tuple[Array, list[list[int]]]:
    vertices, faces = element.modelgeometry.to_vertices_and_faces()
    return np.array([list(v) for v in vertices], dtype=float), [list(map(int, face)) for face in faces]


def _law(problem: Any) -> JointLaw:
    contact = problem.contact_properties.contact_model
    if contact is None:
        msg = "the problem has no contact model"
        raise InputError(msg, where="compas_dem", hint='problem.set_contact_model("MohrCoulomb", mu=0.6)')
    cohesion, strength = (NEWTON * float(value or 0.0) for value in (contact.c, contact.t_c))
    return JointLaw(friction=float(contact.mu), cohesion=cohesion, tensile_strength=strength)


def _gravity(problem: Any) -> float:
    """Return the acceleration of gravity [m/s2], which all groups of boundary conditions must share."""
    stated = {float(group.g) for group in problem.boundary_conditions}
    if len(stated) > 1:
        msg = f"groups of boundary conditions have different gravity: {sorted(stated)}"
        raise InputError(msg, where="compas_dem", hint="give all groups the same g")
    return stated.pop() if stated else 9.81


def _unit_weight(element: Any, problem: Any) -> float:
    material = element.material
    density = None if material is None else material.density
    if not density:
        msg = f"block {element.graphnode} has no material with a density"
        raise InputError(msg, where="compas_dem", hint="assign a material with a density in kg/m3 to it")
    return NEWTON * float(density) * _gravity(problem)


def _loads(
    group: Any, model: Any, names: Mapping[int, str], weights: Mapping[str, float], gravity: float
) -> Iterator[Load]:
    """Return the loads of a group of boundary conditions; supports carry none."""
    centre = {e.graphnode: np.array(list(e.point), dtype=float) for e in model.elements()}
    mesh = {e.graphnode: e.modelgeometry for e in model.elements()}
    for body_force in group.body_forces:
        for name, weight in weights.items():
            share = [float(a) / gravity * weight for a in body_force.acceleration]
            yield Load("body", tuple(share), bodies=(name,), group=group.name)
    for load in (entry for entry in group.point_loads if names[entry.block_index] in weights):
        at = centre[load.block_index] if load.point is None else np.array(list(load.point), dtype=float)
        yield from _force(names[load.block_index], NEWTON * np.array(load.force, dtype=float), at, group.name)
        if load.moment is not None:
            moment = NEWTON * np.array(load.moment, dtype=float)
            yield from _couple(names[load.block_index], moment, at, group.name)
    for load in (entry for entry in group.surface_loads if names[entry.block_index] in weights):
        face = mesh[load.block_index]
        force = NEWTON * float(face.face_area(load.face_index)) * np.array(load.load, dtype=float)
        at = np.array(list(face.face_center(load.face_index)), dtype=float)
        yield from _force(names[load.block_index], force, at, group.name)


def _force(name: str, force: Array, at: Array, group: str) -> Iterator[Load]:
    if force.any():
        yield Load("point", tuple(force.tolist()), bodies=(name,), at=tuple(at.tolist()), group=group)


def _couple(name: str, moment: Array, at: Array, group: str) -> Iterator[Load]:
    """Return two opposite forces 1 m apart with a moment [kN m]."""
    size = float(np.linalg.norm(moment))
    if size > 0:
        arm = cross(moment / size, np.eye(3)[int(np.argmin(np.abs(moment)))])
        arm /= np.linalg.norm(arm)
        force = cross(moment, arm)
        yield from _force(name, force, at + 0.5 * arm, group)
        yield from _force(name, -force, at - 0.5 * arm, group)


def _supports(group: Any, model: Any, names: Mapping[int, str]) -> Iterator[Support]:
    """Return the prescribed displacements of a group."""
    held = {e.graphnode for e in model.elements() if e.is_support}
    for k, moved in enumerate(group.displacements, 1):
        name = names[moved.block_index]
        if moved.block_index not in held:
            msg = f"a displacement is prescribed on block {moved.block_index}, which is not a support"
            raise InputError(msg, where="compas_dem", hint=f"model.add_support({moved.block_index})")
        rotation = getattr(moved, "rotation", None)
        shift = tuple(float(v or 0.0) for v in getattr(moved, "translation", None) or ())
        turn = tuple(float(v) for v in rotation or (0.0, 0.0, 0.0))
        yield Support(f"{group.name} {k}", name, displacement=shift, rotation=turn, group=group.name)


def _motion(result: Result, name: str) -> Array:
    """Return the rigid motion of a body as a matrix (4, 4): its rotation vector is turned into a rotation."""
    points, moved = result.nodes(name), result.node_displacement(name)
    centre, mean = points.mean(0), moved.mean(0)
    arms = points - centre
    turned = cross(np.eye(3), arms[:, None, :])  # (n, axis, 3): what a unit turn about each axis does
    rows = turned.transpose(0, 2, 1).reshape(-1, 3)
    turn = np.linalg.lstsq(rows, (moved - mean).ravel(), rcond=None)[0]
    spin = rotation_matrix(turn)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = spin, centre + mean - spin @ centre
    return matrix


def _edges(result: Result, node: Mapping[str, int], graph: Any) -> Iterator[tuple[tuple[int, int], dict[str, Any]]]:
    """Return the forces between each two blocks that touch, on the first of them."""
    pairs, bodies = result.assembly.pairs, result.model.bodies
    between: dict[tuple[int, int], list[int]] = {}
    for k in np.flatnonzero(pairs.interface >= 0).tolist():
        a, b = (node[bodies[int(side[k])].name] for side in (pairs.body_a, pairs.body_b))
        between.setdefault((min(a, b), max(a, b)), []).append(k)
    for (u, v), rows in between.items():
        edge = (v, u) if graph.has_edge((v, u)) else (u, v)
        yield edge, _forces(result, np.array(rows), edge[0] == node[bodies[int(pairs.body_b[rows[0]])].name])


def _forces(result: Result, rows: Array, on_b: bool) -> dict[str, Any]:
    """Return what ``Results`` holds of the contact pairs of an edge [N]."""
    geometry, contact = import_module("compas.geometry"), import_module("compas_dem.interactions")
    contacts, pairs = result.contacts, result.assembly.pairs
    sign = 1.0 if on_b else -1.0
    force = sign * contacts.force_on_b[rows] / NEWTON
    normal, first = sign * pairs.normal[rows[0]], pairs.tangents[rows[0], 0]
    second = cross(normal, first)
    points = contacts.point[rows]
    frame = geometry.Frame(points.mean(0).tolist(), first.tolist(), second.tolist())
    local = [{"c_np": float(f @ normal), "c_nn": 0.0, "c_u": float(f @ first), "c_v": float(f @ second)} for f in force]
    total = force.sum(0)
    data: dict[str, Any] = {
        "face_contact": len(rows) >= 3, "edge_contact": len(rows) == 2, "point_contact": len(rows) == 1,
        "contact_points": points.tolist(), "contact_frame": frame, "gap": contacts.gap[rows].tolist(),
        "force_vector": force.tolist(), "force_normal": [f["c_np"] for f in local],
        "force_tangent1": [f["c_u"] for f in local], "force_tangent2": [f["c_v"] for f in local],
        "resultant_global": total.tolist(), "force_magnitude": float(np.linalg.norm(total)),
        "resultant_local": [float(total @ first), float(total @ second), float(total @ normal)],
    }  # fmt: skip
    if len(rows) >= 3:
        made = contact.FrictionContact(points=[geometry.Point(*p) for p in points.tolist()], frame=frame)
        made.forces = local
        data |= {"contact_data": made, "contact_polygon": made.polygon}
    return data
