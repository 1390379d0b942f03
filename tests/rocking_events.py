"""A rigid block on a rigid floor by events: an independent oracle for rocking.

It shares nothing with the package: the equation of a pendulum about one toe or the other, integrated to 1e-10 from
event to event (uplift, the top of an arc, impact, overturning), angular momentum about the new toe kept in an impact.
Nothing slides or bounces.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp


def rocking(half, high, acceleration, breaks, end, gravity):
    """Return times and rotations (anticlockwise) of a block 2 half x 2 high under a ground acceleration.

    Parameters
    ----------
    half, high : float
        [m].
    acceleration : callable
        Of the ground at a time [m/s2].
    breaks : sequence of float
        Times at which it is not smooth [s].
    end : float
    gravity : float
    """
    alpha, radius = np.arctan2(half, high), np.hypot(half, high)
    p2, kept = 0.75 * gravity / radius, 1.0 - 1.5 * np.sin(alpha) ** 2
    least = gravity * np.tan(alpha)
    stops = np.unique([*[b for b in breaks if 0 < b < end], end])
    t, theta, omega, side = 0.0, 0.0, 0.0, 0
    times, turned = [0.0], [0.0]

    def rate(now, y, s, first, last):
        lean, within = s * alpha - y[0], min(max(now, first), last)
        return [y[1], -p2 * np.sin(lean) + p2 / gravity * acceleration(within) * np.cos(lean)]

    def flat(now, y, *_):
        return y[0] * side

    flat.terminal, flat.direction = True, -1

    def over(now, y, *_):
        return abs(y[0]) - 1.5

    over.terminal = True

    def still(now, y, *_):
        return y[1]

    while t < end - 1e-12:
        stop = stops[np.searchsorted(stops, t + 1e-12)]
        if side == 0:
            grid = np.linspace(t, stop, 2001)
            above = np.flatnonzero(np.abs([acceleration(g + 1e-13) for g in grid[:-1]]) > least * (1 + 1e-12))
            if not len(above):
                t = stop
                continue
            k = int(above[0])
            low, up = (grid[max(k - 1, 0)], grid[k])
            for _ in range(60):
                middle = 0.5 * (low + up)
                low, up = (low, middle) if abs(acceleration(middle + 1e-13)) > least else (middle, up)
            t = up
            side = int(np.sign(acceleration(t + 1e-12)))
            theta = omega = 0.0
        done = solve_ivp(
            rate, (t, stop), [theta, omega], "DOP853", args=(side, t + 1e-12, stop - 1e-12), events=(flat, over, still),
            rtol=1e-10, atol=1e-13, max_step=min((stop - t) / 8, 0.02 / np.sqrt(p2)),
        )  # fmt: skip
        tops = done.y_events[2].reshape(-1, 2)[:, 0]
        order = np.argsort(np.concatenate([done.t[1:], done.t_events[2]]), kind="stable")
        times += np.concatenate([done.t[1:], done.t_events[2]])[order].tolist()
        turned += np.concatenate([done.y[0, 1:], tops])[order].tolist()
        t, theta, omega = float(done.t[-1]), float(done.y[0, -1]), float(done.y[1, -1])
        if len(done.t_events[1]):
            break
        if len(done.t_events[0]) and t < stop - 1e-14:
            omega *= kept
            theta, side = 0.0, -side
            if abs(omega) < 1e-5 * np.sqrt(p2) and abs(acceleration(t + 1e-12)) <= least:
                side = 0
    return np.array(times), np.array(turned)
