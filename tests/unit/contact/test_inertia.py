"""Masses of bodies against closed forms: any rigid motion has the kinetic energy of the body, meshed or not."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay
from scipy.spatial.transform import Rotation

import concio
from concio import Body, Elastic, JointLaw, Load, Model, Polyhedron, Rigid
from concio.contact.inertia import masses
from concio.fem.discretisation import Discretisation, discretise
from concio.fem.elements import FAMILIES, SOLID_FAMILIES
from concio.kinematics.rigid import rigid_operator
from concio.problem.solution import Departure
from concio.solvers.algebra.scaled import scale
from concio.solvers.interior.run import Run
from concio.solvers.relaxation.single_steps import at_once
from concio.units import GRAVITY
from samples import sample
from solids import box, frame_block, l_block, tetrahedron, turned

WEIGHT = 22.0
RHO = WEIGHT / GRAVITY

Second = tuple[float, np.ndarray, np.ndarray]
"""Volume [m3], centroid [m] and the integral of (x - c)(x - c)' [m5]."""


def of_box(low: np.ndarray, high: np.ndarray) -> Second:
    """V a^2 / 12 along each side."""
    side = np.asarray(high, dtype=float) - low
    volume = float(side.prod())
    return volume, low + side / 2, volume * np.diag(side**2) / 12


def of_boxes(*boxes: tuple[float, tuple[float, ...], tuple[float, ...]]) -> Second:
    """Boxes put together, or taken away with a sign: Steiner."""
    parts = [(sign, of_box(np.array(low, dtype=float), np.array(high, dtype=float))) for sign, low, high in boxes]
    volume = sum(sign * v for sign, (v, _, _) in parts)
    centre = sum(sign * v * c for sign, (v, c, _) in parts) / volume
    return volume, centre, sum(s * (S + v * np.outer(c - centre, c - centre)) for s, (v, c, S) in parts)


def of_right_tetrahedron(a: float, b: float, c: float) -> Second:
    """Legs a, b, c along the axes: 3 V a^2 / 80 and -V a b / 80."""
    volume, legs = a * b * c / 6, np.array([a, b, c])
    return volume, legs / 4, volume / 80 * (4 * np.diag(legs**2) - np.outer(legs, legs))


def of_right_prism(a: float, b: float, h: float) -> Second:
    """A right triangle of legs a, b, drawn out by h: V a^2 / 18, -V a b / 36, V h^2 / 12."""
    volume = a * b * h / 2
    S = np.array([[a * a / 18, -a * b / 36, 0], [-a * b / 36, b * b / 18, 0], [0, 0, h * h / 12]])
    return volume, np.array([a / 3, b / 3, h / 2]), volume * S


def of_points(points: np.ndarray) -> Second:
    """The convex hull by simplices, each integrated at four points, which is exact for squares."""
    corners = points[Delaunay(points).simplices]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    far, near = (5 + 3 * 5**0.5) / 20, (5 - 5**0.5) / 20
    at = np.einsum("qk,tkd->tqd", np.full((4, 4), near) + (far - near) * np.eye(4), corners)
    w = np.repeat(volume[:, None] / 4, 4, axis=1)
    total = float(w.sum())
    centre = np.einsum("tq,tqd->d", w, at) / total
    return total, centre, np.einsum("tq,tqd,tqe->de", w, at - centre, at - centre)


def hull(name: str, points: np.ndarray) -> Polyhedron:
    """The convex hull of points as a polyhedron of triangles."""
    found = ConvexHull(points)
    middle = points.mean(0)
    faces = [f if np.linalg.det(points[f] - middle) > 0 else f[::-1] for f in found.simplices.tolist()]
    return Polyhedron(name, points, tuple(map(tuple, faces)))


def cases() -> dict[str, tuple[Polyhedron, Second]]:
    """Bodies and their closed forms."""
    unit = np.array([[0, 0, 0], [2.0, 0, 0], [0, 0.7, 0], [0, 0, 1.1]])
    wedge = np.array([[0, 0, 0], [1.5, 0, 0], [0, 0.4, 0], [0, 0, 2.0], [1.5, 0, 2.0], [0, 0.4, 2.0]])
    faces = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
    z = (0.0, 0.0, 0.0)
    return {
        "box": (box("b", (0, 0, 0), (3.0, 0.5, 1.2)), of_boxes((1, z, (3.0, 0.5, 1.2)))),
        "tetrahedron": (tetrahedron("b", unit), of_right_tetrahedron(2.0, 0.7, 1.1)),
        "prism": (Polyhedron("b", wedge, faces), of_right_prism(1.5, 0.4, 2.0)),
        "L": (l_block("b"), of_boxes((1, z, (2, 1, 1)), (1, (0, 1, 0), (1, 2, 1)))),
        "with a hole": (frame_block("b"), of_boxes((1, z, (3, 2, 1)), (-1, (0.5, 0.5, 0), (1.5, 1, 1)))),
    }


def disc_of(block: Polyhedron, kind: str, **fields: object) -> Discretisation:
    """The block alone, far from a fixed one."""
    far = box("far", (90, 90, 90), (91, 91, 91), kind="fixed")
    materials = {"block": Elastic(1e6, 0.2, WEIGHT) if kind == "elastic" else Rigid(WEIGHT)}
    own = Polyhedron(block.name, block.vertices, block.faces, kind=kind, holes=block.holes)
    return discretise(Model((own, far), materials, {"joint": JointLaw(0.5)}, **fields))


def energies(disc: Discretisation, centre: np.ndarray) -> np.ndarray:
    """P' M P (6, 6) of the motions of body 0: translations, then rotations about a point [t, t m, t m2]."""
    mass = masses(disc).toarray()
    assert np.abs(mass - mass.T).max() == 0
    if disc.shape_of[0] < 0:
        assert np.allclose(disc.centroids[0], centre, atol=1e-12)
        P = np.diag([1.0] * disc.dim + [float(disc.reach[0])] * (len(mass) - disc.dim))
    else:
        P = rigid_operator(disc.nodes(0) - centre, 1.0).reshape(len(mass), -1)
    return P.T @ mass @ P


def wanted(second: Second, density: float = RHO) -> np.ndarray:
    """diag(m, m, m, I) in space, diag(m, m, I) in the plane."""
    volume, centre, S = second
    d = len(centre)
    tensor = np.trace(S) * np.eye(3) - S if d == 3 else np.array([[np.trace(S)]])
    found = np.zeros((d + len(tensor),) * 2)
    found[:d, :d], found[d:, d:] = density * volume * np.eye(d), density * tensor
    return found


def moved(second: Second, turn: np.ndarray, shift: np.ndarray) -> Second:
    return second[0], turn @ second[1] + shift, turn @ second[2] @ turn.T


@pytest.mark.parametrize("name", list(cases()))
@pytest.mark.parametrize("kind", ["rigid", *SOLID_FAMILIES])
def test_a_block_in_space_has_its_own_tensor_of_inertia(name: str, kind: str) -> None:
    """Turned at random: not the mean of the three moments about every axis, nor that of masses at its corners."""
    block, second = cases()[name]
    rng = np.random.default_rng(sum(map(ord, name + kind)))
    turn, shift = Rotation.random(rng=rng).as_matrix(), rng.uniform(-3, 3, 3)
    placed = turned(block, turn, tuple(shift))
    element = {} if kind == "rigid" else {"element": kind, "mesh_size": 1.1}
    disc = disc_of(placed, "rigid" if kind == "rigid" else "elastic", **element)
    here = moved(second, turn, shift)
    expected = wanted(here)
    assert np.abs(energies(disc, here[1]) - expected).max() < 1e-11 * np.abs(expected).max()


@pytest.mark.parametrize("seed", range(sample(5, 40)))
def test_any_polyhedron_has_its_own_tensor_of_inertia(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(4, 14)), 3)) * rng.uniform(0.2, 3.0, 3)
    points = points[np.unique(ConvexHull(points).vertices)] + rng.uniform(-5, 5, 3)
    second = of_points(points)
    expected = wanted(second)
    assert np.abs(energies(disc_of(hull("b", points), "rigid"), second[1]) - expected).max() < 1e-11 * expected.max()


@pytest.mark.parametrize("kind", ["rigid", *FAMILIES])
@pytest.mark.parametrize("shape", ["rectangle", "triangle"])
def test_a_block_in_the_plane_has_its_own_moment_of_inertia(shape: str, kind: str) -> None:
    a, b, thick = 1.3, 0.4, 0.7
    if shape == "rectangle":
        outline, tensor = [(0, 0), (a, 0), (a, b), (0, b)], np.diag([a * a, b * b]) / 12
        area, centre = a * b, np.array([a, b]) / 2
    else:
        outline, tensor = [(0, 0), (a, 0), (0, b)], np.array([[2 * a * a, -a * b], [-a * b, 2 * b * b]]) / 36
        area, centre = a * b / 2, np.array([a, b]) / 3
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    body = Body("b", np.array(outline) @ turn.T, "s", "rigid" if kind == "rigid" else "elastic", thickness=thick)
    far = Body("far", np.array([(90, 90), (91, 90), (91, 91), (90, 91)]), "s", "fixed")
    materials = {"s": Rigid(WEIGHT) if kind == "rigid" else Elastic(1e6, 0.2, WEIGHT)}
    element = {} if kind == "rigid" else {"element": kind, "mesh_size": 0.5}
    disc = discretise(Model((body, far), materials, {"joint": JointLaw(0.5)}, **element))
    here = moved((area * thick, centre, area * thick * tensor), turn, np.zeros(2))
    expected = wanted(here)
    assert np.abs(energies(disc, here[1]) - expected).max() < 1e-12 * expected.max()


@pytest.mark.parametrize(("kind", "at"), [*itertools.product(["rigid", "elastic"], [(0.95, 0.6), (0.7, 0.9)])])
def test_a_block_lifted_off_centre_turns_as_euler_says(kind: str, at: tuple[float, float]) -> None:
    """An L on the ground under gravity, pulled up at a point: a = F / m - g, alpha = I^-1 (r x F)."""
    block = l_block("b", height=0.6)
    ground = box("ground", (-5, -5, -1), (5, 5, 0), kind="fixed")
    own = Polyhedron("b", block.vertices, block.faces, kind=kind)
    volume, centre, S = of_boxes((1, (0, 0, 0), (2, 1, 0.6)), (1, (0, 1, 0), (1, 2, 0.6)))
    weight = WEIGHT * volume
    pull = np.array([0.0, 0.0, 8 * weight])
    loads = (Load("weight", (0.0, 0.0, -1.0)), Load("point", tuple(pull), bodies=("b",), at=(*at, 0.6)))
    material = Rigid(WEIGHT) if kind == "rigid" else Elastic(1e6, 0.2, WEIGHT)
    law = {"joint": JointLaw(0.5)}
    model = Model((ground, own), {"block": material}, law, loads=loads, element="H8", mesh_size=1.0)
    assembly = concio.assemble(model)
    motion = at_once(Run(scale(assembly.problem())))
    assert isinstance(motion, Departure)
    assert motion.certified
    tensor = RHO * (np.trace(S) * np.eye(3) - S)
    alpha = np.linalg.solve(tensor, np.cross(np.array([*at, 0.6]) - centre, pull))
    linear = pull / (RHO * volume) - np.array([0, 0, GRAVITY])
    points = assembly.disc.nodes(1)
    found = motion.acceleration.reshape(-1, 3)
    if kind == "rigid":
        found = np.stack([found[0] + np.cross(found[1] / assembly.disc.reach[1], p - centre) for p in points])
    expected = linear + np.cross(alpha, points - centre)
    assert expected[:, 2].min() > 0
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()
