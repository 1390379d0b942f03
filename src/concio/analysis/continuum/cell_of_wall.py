"""The periodic cell of a wall whose generator knows its bond."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

from concio.contact.assembly import Assembly
from concio.errors import InputError
from concio.model.generate.periodic_cells import cell
from concio.model.generate.wall_panels import Bond
from concio.model.materials import Elastic
from concio.model.model import Model

GIVE = "give the cell: concio.cell(...), or --cell FILE"


def cell_of(assembly: Assembly) -> Model:
    """Return the cell of a wall made by ``concio.wall`` or ``concio.running_bond_panel`` in one bond.

    Raises
    ------
    InputError
        The model was made in another way, or its blocks or joints are not all alike; lintels may be.
    """
    model = assembly.model
    record = model.generator
    size, bond = record.get("block_size"), record.get("bond", "running")
    if record.get("kind") not in ("wall", "panel") or not isinstance(size, Sequence) or bond == "own":
        msg = "the cell that this wall repeats is not known"
        raise InputError(msg, hint=GIVE)
    free = model.free_bodies
    stones = {b.material for b in free if b.role not in ("mortar", "lintel")}
    films = {b.material for b in free if b.role == "mortar"}
    pairs = [(model.bodies[f.a], model.bodies[f.b]) for f in assembly.detection.segments]
    laws = {model.rule_between(a, b).law for a, b in pairs if "fixed" not in (a.kind, b.kind)}
    for found, what in ((stones, "materials of blocks"), (films, "mortars"), (laws, "laws of joints")):
        if len(found) > 1:
            msg = f"the wall has {len(found)} {what} ({', '.join(sorted(found))}), and no one cell stands for it"
            raise InputError(msg, hint=GIVE)
    if not stones or not laws:
        msg = "the wall has no joints between blocks"
        raise InputError(msg, hint="a single block is a continuum already")
    mortar = model.materials[films.pop()] if films else None
    joint = record.get("joint", 0.0)
    return cell(
        bond=cast("Bond", bond),
        block_size=[float(v) for v in size],
        lap=float(str(record.get("lap", 0.5))),
        joint=float(str(joint)),
        mortar=mortar if isinstance(mortar, Elastic) else None,
        block=model.materials[stones.pop()],
        friction=model.laws[laws.pop()],
        thickness=free[0].thickness,
        plane=model.plane,
        element=model.element,
        refinement=model.refinement,
    )
