"""One kind of contact of pairs of convex pieces, on its way into the table of all: reference side and incident side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

CORNER, EDGE = 0, 1


@dataclass(frozen=True, eq=False)
class Found:
    """Contacts of p pairs with k points, written from the reference side r to the incident side i.

    Parameters
    ----------
    row : (p,) integer array
        Number of the pair.
    dims : (p, 2) integer array
        Dimension of the feature of r and of i: 0 for a corner, 1 for an edge, in the plane a side, 2 for a face.
    feature : (p, 2) integer array
        Its number.
    normal : (p, d) array
    count : (p,) integer array
        Points of each pair.
    on_r, on_i, normals : (k, d) arrays
    share : (k,) array
    """

    row: Array
    dims: Array
    feature: Array
    normal: Array
    count: Array
    on_r: Array
    on_i: Array
    normals: Array
    share: Array

    @classmethod
    def of(
        cls, row: Array, dims: tuple[Array | int, Array | int], feature: tuple[Array, Array], normal: Array,
        points: tuple[Array, Array, Array, Array], real: Array,
    ) -> Found:  # fmt: skip
        """Return contacts from padded arrays.

        Parameters
        ----------
        row, dims, feature, normal
            As in the class; of dimensions and features those of r, then those of i.
        points : arrays (p, K, d), (p, K, d), (p, K, d), (p, K)
            On r, on i, normals, shares.
        real : (p, K) boolean array
        """
        shape = np.stack([np.broadcast_to(np.asarray(v), row.shape) for v in dims], 1)
        on_r, on_i, normals, share = (v[real] for v in points)
        return cls(row, shape, np.stack(feature, 1), normal, real.sum(1), on_r, on_i, normals, share)

    def turned(self, swapped: Array) -> Found:
        """Return the contacts with the two sides of some rows exchanged, by a mask of all pairs."""
        own = swapped[self.row]
        of = np.repeat(own, self.count)
        sign, back = np.where(own, -1.0, 1.0)[:, None], of[:, None]
        return Found(
            self.row, np.where(own[:, None], self.dims[:, ::-1], self.dims),
            np.where(own[:, None], self.feature[:, ::-1], self.feature), sign * self.normal, self.count,
            np.where(back, self.on_i, self.on_r), np.where(back, self.on_r, self.on_i),
            np.where(back, -self.normals, self.normals), self.share,
        )  # fmt: skip
