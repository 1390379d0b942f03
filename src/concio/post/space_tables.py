"""Tables of a result in space: bodies and joints with three components; the others are those of the plane."""

from __future__ import annotations

import warnings

import numpy as np

from concio.post.body_motion import body_motions
from concio.post.result_tables import Array, Table, Tables, vectors


class SpaceTables(Tables):
    """Tables of one result in space; of one that is not solved as in the plane."""

    def bodies(self) -> Table:
        """Return one row a body: name, kind, centroid, mean displacement and rotation, mean and principal stresses."""
        result = self.result
        model, stress = result.model, result.stress
        motion = body_motions(result)
        values, _ = stress.principal_in_space
        return self.owned({
            "body": np.array([b.name for b in model.bodies]),
            "kind": np.array([b.kind for b in model.bodies]),
            "role": np.array([b.role for b in model.bodies]),
            **vectors("", result.assembly.disc.centroids),
            "volume": np.array([b.volume for b in model.bodies]),
            **vectors("u_", motion[:, :3]),
            **vectors("rotation_", motion[:, 3:]),
            **dict(zip(("s_x", "s_y", "s_z", "t_xy", "t_yz", "t_zx"), stress.mean.T, strict=True)),
            **{f"s_{k + 1}": values[:, k] for k in range(3)},
        })  # fmt: skip

    def joints(self) -> Table:
        """Return one row an interface: its bodies, resultants on side b, what is open or slips.

        Columns that the plane has, too, mean the same there (:meth:`.Tables.joints`). A shear force in space has no
        sign: ``shear_force``, which was its size, is deprecated and not among the columns; it is ``shear_size``.
        """
        j = self.result.joints_in_space
        return _Joints(self.owned({
            **self.names(j.body_a, j.body_b),
            **vectors("", j.middle),
            **vectors("n_", j.normal),
            "area": j.area,
            "normal_force": j.N,
            **self.acting(j),
            **vectors("moment_", j.M),
            "torsion": j.torsion,
            "open_share": j.open_share,
            "slipping": j.slipping,
        }))  # fmt: skip


class _Joints(dict[str, Array]):
    """A table of joints that still answers to the name that the size of the shear force had."""

    def __missing__(self, name: str) -> Array:
        if name != "shear_force":
            raise KeyError(name)
        message = "'shear_force' has a sign in the plane and has none in space: use 'shear_size', the size, in both"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return self["shear_size"]
