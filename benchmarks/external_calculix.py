"""CalculiX on a model of concio's: write its input, read its displacements (Debian package ``calculix-ccx``).

The same blocks, the same meshes of four-node elements (CalculiX turns CPS4 into bricks with full integration), the same
nodal loads, and a soft spring under every unknown where one is asked for. Contact is CalculiX's own: surface to surface
with a linear pressure-overclosure law and a stick slope, whose slopes have to be chosen by hand. So the answer is close
to concio's, never equal: joints can be pressed into one another, and they slip a little before they slide.

``STIFFNESS`` E / h is the slope of pressure over overclosure (E the blocks' modulus, h the length of an element on the
joint): the joint gives in by 1 / ``STIFFNESS`` of an element's own shortening. The stick slope is a tenth of it.
"""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import numpy as np

from concio.contact.assembly import Assembly
from concio.model.materials import Elastic
from concio.model.model import Body
from concio.problem.contact_problem import Array

STIFFNESS = 100.0


def _joint_faces(nodes: Array, cells: Array, start: Array, end: Array) -> list[tuple[int, int]]:
    """Return (cell, CalculiX face number) of the element edges that lie on the segment from start to end."""
    along = end - start
    length = float(np.hypot(*along))
    along = along / length
    across = np.array([-along[1], along[0]])
    faces = []
    for side in range(4):
        p, q = nodes[cells[:, side]], nodes[cells[:, (side + 1) % 4]]
        flat = np.maximum(np.abs((p - start) @ across), np.abs((q - start) @ across)) < 1e-6
        middle = (0.5 * (p + q) - start) @ along
        inside = (middle > -1e-6) & (middle < length + 1e-6)
        faces += [(int(cell), side + 1) for cell in np.flatnonzero(flat & inside)]
    return faces


def _mesh(assembly: Assembly, b: int) -> tuple[Array, Array]:
    """Return nodes and four-node cells of a body; a fixed body is one element."""
    disc = assembly.disc
    nodes = disc.nodes(b)
    shape = disc.shape_of[b]
    cells = disc.shapes[shape].elements.cells if shape >= 0 else np.arange(len(nodes))[None, :]
    if cells.shape[1] != 4:
        msg = f"body {b} is not made of four-node elements"
        raise ValueError(msg)
    return nodes, cells


def _lines(numbers: list[int]) -> str:
    """Return numbers with commas, eight a line, as CalculiX wants them."""
    rows = [numbers[i : i + 8] for i in range(0, len(numbers), 8)]
    return "\n".join(", ".join(str(n) for n in row) + "," for row in rows) + "\n"


def write_input(path: Path, assembly: Assembly, f: Array, friction: float, spring: float) -> None:
    """Write the input file.

    Parameters
    ----------
    path : Path
        Ends in ``.inp``.
    assembly : Assembly
        Plane stress, elastic or fixed bodies of four-node elements, no supports.
    f : (N,) array
        Nodal loads [kN].
    friction : float
        Coulomb coefficient of all joints.
    spring : float
        Stiffness of the spring under every unknown [kN/m]; 0 leaves them out.
    """
    model, disc = assembly.model, assembly.disc
    first_node, first_cell, nodes_of, cells_of = [], [], [], []
    n, e = 1, 1
    for b in range(len(model.bodies)):
        nodes, cells = _mesh(assembly, b)
        first_node.append(n)
        first_cell.append(e)
        nodes_of.append(nodes)
        cells_of.append(cells)
        n, e = n + len(nodes), e + len(cells)
    out = ["*NODE, NSET=ALL\n"]
    for start, nodes in zip(first_node, nodes_of, strict=True):
        out += [f"{start + i}, {x:.12g}, {y:.12g}, 0\n" for i, (x, y) in enumerate(nodes)]
    kinds: dict[tuple[str, float], list[int]] = defaultdict(list)
    fixed: list[int] = []
    out.append("*ELEMENT, TYPE=CPS4, ELSET=BODIES\n")
    for b, body in enumerate(model.bodies):
        out += [
            f"{first_cell[b] + i}, " + ", ".join(str(first_node[b] + int(k)) for k in cell) + "\n"
            for i, cell in enumerate(cells_of[b])
        ]
        kinds[_kind(body, model.bodies)] += list(range(first_cell[b], first_cell[b] + len(cells_of[b])))
        if body.kind == "fixed":
            fixed += list(range(first_node[b], first_node[b] + len(nodes_of[b])))
    for k, ((name, thickness), members) in enumerate(kinds.items()):
        material = model.materials[name]
        if not isinstance(material, Elastic):
            msg = f"material '{name}' is not elastic"
            raise TypeError(msg)
        out.append(f"*ELSET, ELSET=KIND{k}\n" + _lines(members))
        out.append(f"*MATERIAL, NAME=M{k}\n*ELASTIC\n{material.E:.12g}, {material.nu:.12g}\n")
        out.append(f"*SOLID SECTION, ELSET=KIND{k}, MATERIAL=M{k}\n{thickness:.12g}\n")
    out.append("*NSET, NSET=HELD\n" + _lines(fixed) + "*BOUNDARY\nHELD, 1, 2, 0.\n")
    free = [b for b, body in enumerate(model.bodies) if body.kind != "fixed"]
    if spring:
        for axis in (1, 2):
            out.append(f"*ELEMENT, TYPE=SPRING1, ELSET=SOIL{axis}\n")
            for b in free:
                for i in range(len(nodes_of[b])):
                    out.append(f"{e}, {first_node[b] + i}\n")
                    e += 1
            out.append(f"*SPRING, ELSET=SOIL{axis}\n{axis}\n{spring:.12g}\n")
    out += _contact(assembly, nodes_of, cells_of, first_cell, friction)
    out.append("*STEP, INC=200\n*STATIC\n1., 1.\n*CLOAD\n")
    for b in free:
        loads = f[disc.offsets[b] : disc.offsets[b + 1]].reshape(-1, 2)
        for i, load in enumerate(loads):
            out += [f"{first_node[b] + i}, {axis + 1}, {load[axis]:.12g}\n" for axis in (0, 1) if load[axis]]
    out.append("*NODE PRINT, NSET=ALL\nU\n*END STEP\n")
    path.write_text("".join(out))


def _kind(body: Body, bodies: tuple[Body, ...]) -> tuple[str, float]:
    """Return material and thickness of a body; a fixed one takes those of the first elastic one, they do not matter."""
    chosen = body if body.kind == "elastic" else next(b for b in bodies if b.kind == "elastic")
    return chosen.material, chosen.thickness


def _contact(
    assembly: Assembly, nodes_of: list[Array], cells_of: list[Array], first_cell: list[int], friction: float
) -> list[str]:
    """Return the surfaces, one contact pair for each direction of joints, and the interaction."""
    bodies = assembly.model.bodies
    slave: dict[str, set[tuple[int, int]]] = defaultdict(set)
    master: dict[str, set[tuple[int, int]]] = defaultdict(set)
    shortest = np.inf
    for interface in assembly.detection.interfaces:
        a, b = interface.a, interface.b
        direction = "HEAD" if abs(interface.normal[0]) > 0.5 else "BED"
        upwards = interface.normal.sum() > 0
        low, high = (a, b) if upwards else (b, a)
        if bodies[low].kind == "fixed":
            low, high, direction = high, low, direction + "LOW"
        for body, surface in ((low, slave), (high, master)):
            if bodies[body].kind == "fixed":  # one element: the whole edge
                edge = interface.edge_b if body == b else interface.edge_a
                corners = nodes_of[body]
                start, end = corners[edge], corners[(edge + 1) % 4]
            else:
                start, end = interface.start, interface.end
            for cell, face in _joint_faces(nodes_of[body], cells_of[body], start, end):
                surface[direction].add((first_cell[body] + cell, face))
                corners = nodes_of[body][cells_of[body][cell]]
                shortest = min(shortest, float(np.hypot(*(corners[face % 4] - corners[face - 1]))))
    elastic = [assembly.model.materials[b.material] for b in bodies if b.kind == "elastic"]
    slope = STIFFNESS * max(m.E for m in elastic if isinstance(m, Elastic)) / shortest
    out = [
        "*SURFACE INTERACTION, NAME=JOINT\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n",
        f"{slope:.6g}\n*FRICTION\n{friction:.12g}, {slope / 10:.6g}\n",
    ]
    for direction in slave:
        for name, faces in ((f"S{direction}", slave[direction]), (f"M{direction}", master[direction])):
            out.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT\n")
            out += [f"{cell}, S{face}\n" for cell, face in sorted(faces)]
        out.append("*CONTACT PAIR, INTERACTION=JOINT, TYPE=SURFACE TO SURFACE\n")
        out.append(f"S{direction}, M{direction}\n")
    return out


def read_displacements(path: Path, assembly: Assembly) -> Array | None:
    """Return the unknowns (N,) at the end of the step from the ``.dat`` file, or None where it did not get there."""
    if not path.exists():
        return None
    blocks = path.read_text().split("displacements (vx,vy,vz)")[1:]
    if not blocks:
        return None
    head, _, body = blocks[-1].partition("\n")
    if abs(float(head.split()[-1]) - 1.0) > 1e-9:
        return None
    rows = np.array([line.split() for line in body.splitlines() if line.strip()], dtype=float)
    found = np.full((int(rows[:, 0].max()) + 1, 2), np.nan)
    found[rows[:, 0].astype(int)] = rows[:, 1:3]
    u = np.zeros(assembly.disc.unknowns)
    first = 1
    for b in range(len(assembly.model.bodies)):
        count = len(assembly.disc.nodes(b))
        if assembly.disc.shape_of[b] >= 0:
            u[assembly.disc.offsets[b] : assembly.disc.offsets[b + 1]] = found[first : first + count].ravel()
        first += count
    return u
