"""What makes a mesh of a polygon right, for several test files."""

from __future__ import annotations

import numpy as np

from concio.kinematics.mass import signed_area


def assert_good_mesh(outline, points, cells):
    """Check that cells are counter-clockwise, conforming, and cover the outline exactly, with all points used."""
    x = points[cells]
    following = np.roll(x, -1, axis=1)
    area = 0.5 * (x[..., 0] * following[..., 1] - x[..., 1] * following[..., 0]).sum(1)
    size = np.ptp(outline, axis=0).max()
    assert area.min() > 0
    assert abs(area.sum() - signed_area(outline)) < 1e-12 * (size + np.abs(outline).max()) ** 2
    corners = cells.shape[1]
    sides = np.concatenate([cells[:, [k, (k + 1) % corners]] for k in range(corners)])
    _, count = np.unique(sides, axis=0, return_counts=True)
    assert count.max() == 1, "an edge is run through twice in one direction"
    edges, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    assert count.max() <= 2
    free = points[edges[count == 1]]
    round_about = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T).sum()
    assert abs(np.hypot(*(free[:, 0] - free[:, 1]).T).sum() - round_about) < 1e-9 * round_about
    for vertex in outline:
        assert np.hypot(*(points - vertex).T).min() <= 1e-12 * size
    assert len(np.unique(cells)) == len(points)
