"""Tables of a result: columns by name, ready for ``pandas.DataFrame(table)`` and for CSV, with no need of pandas."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.analysis.contacts import STATE_NAMES, JointResultants
from concio.analysis.joints_in_space import SpaceResultants
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray
Table = dict[str, Array]

UNITS: dict[str, str] = {
    **dict.fromkeys(("x", "y", "u_x", "u_y", "length", "gap", "slip", "eccentricity", "thickness", "elongation"), "m"),
    **dict.fromkeys(("n_x", "n_y", "open_share", "friction_used"), "-"),
    **dict.fromkeys(("normal_force", "friction_force", "shear_force", "shear_size"), "kN"),
    **dict.fromkeys(("force_x", "force_y", "tension"), "kN"),
    **dict.fromkeys(("s_x", "s_y", "t_xy", "s_1", "s_2", "pressure", "shear"), "kN/m2"),
    **dict.fromkeys(("stress_xx", "stress_yy", "stress_xy", "h"), "kN/m2"),
    **dict.fromkeys(("work", "stored", "dissipated"), "kN m"),
    **dict.fromkeys(("angle", "rotation"), "rad"),
    "area": "m2",
    **dict.fromkeys(("z", "u_z"), "m"),
    **dict.fromkeys(("force_z", "shear_x", "shear_y", "shear_z"), "kN"),
    **dict.fromkeys(("moment_x", "moment_y", "moment_z", "moment", "torsion"), "kN m"),
    **dict.fromkeys(("s_z", "t_yz", "t_zx", "s_3"), "kN/m2"),
    **dict.fromkeys(("rotation_x", "rotation_y", "rotation_z"), "rad"),
    "n_z": "-",
    "volume": "m3",
    **dict.fromkeys(("at_x", "at_y", "at_z"), "m"),
    **dict.fromkeys((f"t{i}_{axis}" for i in ("", 1, 2) for axis in "xyz"), "-"),
}
UNITS |= {f"{name}_{i}": UNITS[name] for name in ("friction_force", "shear", "slip") for i in (1, 2)}
"""Unit of each column that has one; stresses are tension positive, pressure and normal forces compression positive."""

KINDS: dict[str, str] = {
    **dict.fromkeys(("x", "y", "length", "eccentricity", "thickness"), "length"),
    **dict.fromkeys(("u_x", "u_y", "gap", "slip", "elongation"), "motion"),
    **dict.fromkeys(("n_x", "n_y", "open_share", "friction_used"), "number"),
    **dict.fromkeys(("normal_force", "friction_force", "shear_force", "shear_size"), "force"),
    **dict.fromkeys(("force_x", "force_y", "tension"), "force"),
    **dict.fromkeys(("s_x", "s_y", "t_xy", "s_1", "s_2", "pressure", "shear"), "stress"),
    **dict.fromkeys(("angle", "rotation"), "rotation"),
    "area": "area",
    **dict.fromkeys(("z",), "length"),
    **dict.fromkeys(("u_z",), "motion"),
    **dict.fromkeys(("force_z", "shear_x", "shear_y", "shear_z"), "force"),
    **dict.fromkeys(("s_z", "t_yz", "t_zx", "s_3"), "stress"),
    **dict.fromkeys(("rotation_x", "rotation_y", "rotation_z"), "rotation"),
    "n_z": "number",
    **dict.fromkeys(("at_x", "at_y", "at_z"), "length"),
    **dict.fromkeys(("moment_x", "moment_y", "moment_z", "moment", "torsion"), "moment"),
    **dict.fromkeys((f"t{i}_{axis}" for i in ("", 1, 2) for axis in "xyz"), "number"),
}
KINDS |= {f"{name}_{i}": KINDS[name] for name in ("friction_force", "shear", "slip") for i in (1, 2)}
"""Kind of quantity in each column, as :class:`concio.Units` tells it."""

GIVEN = {"x", "y", "z", "n_x", "n_y", "n_z", "length", "area", "volume"}
GIVEN |= {f"t{i}_{axis}" for i in ("", 1, 2) for axis in "xyz"}
"""Columns of the model itself: all other numbers are those of an answer."""


@short_repr
@dataclass(frozen=True, eq=False)
class Tables:
    """Tables of one result. Each is a dict of arrays of one length, which are copies: they can be changed.

    Of a result that is not solved there are no displacements, stresses and forces: these are nan, states are empty.

    Parameters
    ----------
    result : Result

    Examples
    --------
    >>> import concio
    >>> result = concio.solve(concio.column(width=0.5, height=2.0, blocks=2, block="rigid", unit_weight=20.0))
    >>> table = result.tables.joints()
    >>> table["normal_force"].round(6).tolist()
    [20.0, 10.0]
    """

    result: Result

    def bodies(self) -> Table:
        """Return one row a body: name, kind, centroid, mean displacement and rotation, mean and principal stresses."""
        from concio.post.body_motion import body_motions

        model, stress = self.result.model, self.result.stress
        s1, s2, angle = stress.principal
        motion = body_motions(self.result)
        return self.owned({
            "body": np.array([b.name for b in model.bodies]),
            "kind": np.array([b.kind for b in model.bodies]),
            "role": np.array([b.role for b in model.bodies]),
            **vectors("", self.result.assembly.disc.centroids),
            "volume": np.array([b.volume for b in model.bodies]),
            **vectors("u_", motion[:, :2]),
            "rotation": motion[:, 2],
            "s_x": stress.mean[:, 0],
            "s_y": stress.mean[:, 1],
            "t_xy": stress.mean[:, 2],
            "s_1": s1,
            "s_2": s2,
            "angle": angle,
        })  # fmt: skip

    def joints(self) -> Table:
        """Return one row an interface: its bodies, resultants on side b, where they act, what is open or slips.

        Columns of the plane and of space that have one name mean the same: ``shear_x`` and so on are the components of
        the shear force, ``shear_size`` its size, ``at_x`` and so on where the resultant meets the joint. In the plane
        ``shear_force`` is the component along the tangent ``t_x, t_y``, with its sign, and ``eccentricity`` the
        distance of ``at`` from the middle along it; ``moment`` is the moment about the middle, anticlockwise. In
        space ``moment_x`` and so on are its components, ``torsion`` its part along the normal. The resultant at the
        middle and the moment are all that the joint transmits. So are, where there is an ``at``, the resultant there in
        the plane; in space the normal force there, with the shear force at the middle and the torsion.
        """
        j = self.result.joints
        return self.owned({
            **self.names(j.body_a, j.body_b),
            **vectors("", j.middle),
            **vectors("n_", j.normal),
            **vectors("t_", j.tangent),
            "length": j.length,
            "area": j.area,
            "normal_force": j.N,
            "shear_force": j.V,
            **self.acting(j),
            "eccentricity": j.eccentricity,
            "moment": j.M,
            "open_share": j.open_share,
            "slipping": j.slipping,
        })  # fmt: skip

    def contacts(self) -> Table:
        """Return one row a contact pair: place, frame, law, state, forces, tractions, gap and slip.

        Friction, shear stress and slip are components along tangents: along ``t_x, t_y`` in the plane; in space those
        that end in ``_1`` along ``t1_x, t1_y, t1_z``, those that end in ``_2`` along ``t2_x, t2_y, t2_z``.
        Ties are rows with the law "tie" and the interface -1, at the middle of the bar. Their ``normal_force`` is the
        tension, which acts on the second end along the normal; they have no area and no pressure.
        """
        c = self.result.contacts
        p = c.pairs
        laws = np.array([*p.law_names, "tie"])
        return self.owned({
            **self.names(p.body_a, p.body_b),
            "interface": p.interface,
            "law": laws[p.law],
            **vectors("", p.point),
            **vectors("n_", p.normal),
            **frames(p.tangents),
            "area": c.area,
            "state": np.where(p.interface >= 0, np.array(STATE_NAMES)[c.state], self._tie_states()),
            "normal_force": c.normal_force,
            **components("friction_force", c.friction_force),
            "pressure": c.pressure,
            **components("shear", c.shear),
            "gap": c.gap,
            **components("slip", c.slip),
        })  # fmt: skip

    def reactions(self) -> Table:
        """Return one row a fixed body or support: its force on the structure."""
        found = self.result.reactions
        force = np.array(list(found.values()), dtype=float).reshape(-1, self.result.model.dim)
        return self.owned({"support": np.array(list(found), dtype=str), **vectors("force_", force)})

    def ties(self) -> Table:
        """Return one row a tie: its blocks, tension, elongation, state, and its force on the first block."""
        found = self.result.ties
        return self.owned({
            "tie": np.array(found.names, dtype=str),
            "body_a": np.array([a for a, _ in found.bodies], dtype=str),
            "body_b": np.array([b for _, b in found.bodies], dtype=str),
            "tension": found.tension,
            "elongation": found.elongation,
            "state": np.array(found.state, dtype=str),
            **vectors("force_", found.pull),
        })  # fmt: skip

    def _tie_states(self) -> Array:
        """Return the state of the tie that each pair (m,) stands for; empty of joints."""
        states = np.zeros(len(self.result.assembly.pairs), dtype="<U6")
        states[self.result.assembly.ties] = self.result.ties.state
        return states

    def all(self) -> dict[str, Table]:
        """Return the tables by name; that of ties where there are any."""
        ties = {"ties": self.ties()} if self.result.model.ties else {}
        return {
            "bodies": self.bodies(),
            "joints": self.joints(),
            "contacts": self.contacts(),
            "reactions": self.reactions(),
            **ties,
        }

    def acting(self, j: JointResultants | SpaceResultants) -> Table:
        """Return the columns of the shear force and of where the resultant acts, one meaning in plane and space."""
        return {**vectors("shear_", j.shear_vector), "shear_size": j.shear_size, **vectors("at_", j.point)}

    def owned(self, table: Table) -> Table:
        """Return a table of copies, which can be written to; without the numbers of an answer where there is none."""
        if self.result.solved:
            return {name: np.array(values) for name, values in table.items()}
        return {name: _unknown(values) if _answers(name, values) else np.array(values)
                for name, values in table.items()}  # fmt: skip

    def names(self, a: Array, b: Array) -> Table:
        """Return the columns with the names of the bodies ``a`` and ``b`` (n,)."""
        names = np.array([*(body.name for body in self.result.model.bodies), ""])  # -1: the free end of a tie
        return {"body_a": names[a], "body_b": names[b]}


def _answers(name: str, values: Array) -> bool:
    return name in ("state", "slipping") or (values.dtype.kind == "f" and name not in GIVEN)


def _unknown(values: Array) -> Array:
    return np.full(len(values), np.nan) if values.dtype.kind == "f" else np.full(len(values), "")


def components(name: str, values: Array) -> Table:
    """Return the columns of a tangential quantity (m, d-1): one in the plane, one for each tangent in space."""
    if values.shape[1] == 1:
        return {name: values[:, 0]}
    return {f"{name}_{i + 1}": values[:, i] for i in range(values.shape[1])}


def frames(tangents: Array) -> Table:
    """Return the columns of the tangents (m, d-1, d) along which components are: one in the plane, two in space."""
    if tangents.shape[1] == 1:
        return vectors("t_", tangents[:, 0])
    return {**vectors("t1_", tangents[:, 0]), **vectors("t2_", tangents[:, 1])}


def vectors(head: str, values: Array) -> Table:
    """Return the columns x, y and, in space, z of vectors (n, d)."""
    return {f"{head}{axis}": values[:, k] for k, axis in enumerate("xyz"[: values.shape[1]])}
