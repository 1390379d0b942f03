"""Tables of a result in space: the same four as in the plane, with three components."""

from __future__ import annotations

import numpy as np

from concio.analysis.contacts import STATE_NAMES
from concio.post.solids import body_motions_in_space
from concio.post.tables import Table, Tables, components

Array = np.ndarray
AXES = ("x", "y", "z")


class SpaceTables(Tables):
    """Tables of one result in space. Each is a dict of arrays of one length."""

    def bodies(self) -> Table:
        """Return one row a body: name, kind, centroid, mean displacement and rotation, mean and principal stresses."""
        result = self.result
        model, stress = result.model, result.stress
        motion = body_motions_in_space(result)
        values, _ = stress.principal_in_space
        return {
            "body": np.array([b.name for b in model.bodies]),
            "kind": np.array([b.kind for b in model.bodies]),
            "role": np.array([b.role for b in model.bodies]),
            **_named("", result.assembly.disc.centroids),
            "volume": np.array([b.volume for b in model.bodies]),
            **_named("u_", motion[:, :3]),
            **_named("rotation_", motion[:, 3:]),
            **dict(zip(("s_x", "s_y", "s_z", "t_xy", "t_yz", "t_zx"), stress.mean.T, strict=True)),
            **{f"s_{k + 1}": values[:, k] for k in range(3)},
        }

    def joints(self) -> Table:
        """Return one row an interface: its bodies, resultants on side b, where they act, what is open."""
        j = self.result.joints_in_space
        return {
            **self.names(j.body_a, j.body_b),
            **_named("", j.middle),
            **_named("n_", j.normal),
            "area": j.area,
            "normal_force": j.N,
            "shear_force": np.linalg.norm(j.V, axis=1),
            **_named("shear_", j.V),
            **_named("moment_", j.M),
            "torsion": j.torsion,
            "open_share": j.open_share,
        }

    def contacts(self) -> Table:
        """Return one row a contact pair: place, frame, law, state, forces, tractions, gap and slip."""
        c = self.result.contacts
        p = c.pairs
        laws = np.array([*p.law_names, "tie"])
        return {
            **self.names(p.body_a, p.body_b),
            "interface": p.interface,
            "law": laws[p.law],
            **_named("", p.point),
            **_named("n_", p.normal),
            "area": p.area,
            "state": np.array(STATE_NAMES)[c.state],
            "normal_force": c.normal_force,
            **components("friction_force", c.friction_force),
            "pressure": c.pressure,
            **components("shear", c.shear),
            "gap": c.gap,
            **components("slip", c.slip),
        }

    def reactions(self) -> Table:
        """Return one row a fixed body or support: its force on the structure."""
        found = self.result.reactions
        force = np.array(list(found.values()), dtype=float).reshape(-1, 3)
        return {"support": np.array(list(found), dtype=str), **_named("force_", force)}


def _named(head: str, values: Array) -> Table:
    """Return the columns x, y and z of vectors (n, 3)."""
    return {f"{head}{axis}": values[:, k] for k, axis in enumerate(AXES)}
