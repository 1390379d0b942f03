r"""Free-standing blocks that rock, after Housner.

A block 2b wide and 2h high, R the half diagonal, :math:`\tan\alpha = b/h`, :math:`p = \sqrt{3g/4R}`, turns about one
foot or the other:

.. math:: \ddot\theta = -p^2 \bigl[\sin(\alpha - \theta) - \tfrac{a}{g}\cos(\alpha - \theta)\bigr],

with energy :math:`\tfrac12\dot\theta^2 + p^2 \cos(\alpha - \theta)` kept between impacts and the angular velocity times
:math:`1 - \tfrac32\sin^2\alpha` at each. The program uses none of these formulas: its input is Coulomb's law
at corners and restitution zero. A trilith (two columns, a free lintel of mass m) begins to rock at the same multiplier,
and keeps
:math:`(1 - \tfrac32 \sin^2\alpha + 3\gamma\cos 2\alpha)/(1 + 3\gamma)` of its velocity, :math:`\gamma = m/2m_c`.
A rectangular pulse overturns it if the energy given is enough to carry the centroid over the foot, an argument of
Housner's that is exact as long as nothing hits the ground.
Orders of convergence are those of the error between halved steps: two without an impact, one with.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.integrate import quad, solve_ivp

import concio
from validation_cases.row import Row

SOURCE = (
    "G. W. Housner, Bull. Seismol. Soc. Am. 53 (1963) 403-417; N. Makris and M. Vassiliou, Earthquake Eng. Struct. Dyn."
    " 42 (2013) 293-313 for the trilith; integrals and differential equations solved here by SciPy."
)
G, WIDTH, HEIGHT = 9.81, 0.4, 1.2
ALPHA = float(np.arctan(WIDTH / HEIGHT))
P = float(np.sqrt(3 * G / (4 * np.hypot(WIDTH / 2, HEIGHT / 2))))
RETURN = 1 - 1.5 * np.sin(ALPHA) ** 2
STONE = concio.Rigid(20.0)
SCHEME = "error of the scheme at this step"


def turned(outline, foot, angle):
    """Points turned clockwise by ``angle`` about ``foot``."""
    c, s = np.cos(angle), np.sin(angle)
    return (np.asarray(outline, dtype=float) - foot) @ np.array([[c, -s], [s, c]]) + foot


def rectangle(x, y, width, height):
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])


def model(*blocks: concio.Body, friction: float = 1.0) -> concio.Model:
    floor = concio.Body("floor", rectangle(-20.0, -1.0, 40.0, 1.0), kind="fixed")
    weight = concio.Load("weight", (0.0, -1.0))
    laws = {"joint": concio.JointLaw(friction)}
    return concio.Model((floor, *blocks), {"block": STONE}, laws, loads=(weight,))


def block(share: float = 0.0) -> concio.Model:
    """The block turned clockwise by a share of alpha."""
    outline = turned(rectangle(-WIDTH / 2, 0.0, WIDTH, HEIGHT), (WIDTH / 2, 0.0), share * ALPHA)
    return model(concio.Body("block", outline, kind="rigid"))


@cache
def free(share: float, step: float, duration: float, located: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Times and rotations over alpha of free rocking from a share of alpha, with impacts located or not."""
    found = concio.dynamics(
        block(share), duration=duration, step=step, start="as described", gravity=G, every=step, adaptive=located
    )
    assert found.certified
    assert found.energy.error < 1e-9
    return found.shots.time, share - found.rotation("block") / ALPHA


def zero_of(share: float, step: float, duration: float = 1.0) -> float:
    """Time of the first impact."""
    time, theta = free(share, step, duration)
    k = int(np.flatnonzero(theta < 0)[0])
    return float(time[k - 1] + (time[k] - time[k - 1]) * theta[k - 1] / (theta[k - 1] - theta[k]))


def quarter(share: float) -> float:
    """Quarter of the exact period: the integral with theta = theta_0 (1 - s^2), which takes its root out."""
    start = share * ALPHA

    def slowness(s):
        theta = start * (1 - s * s)
        return 2 * start * s / np.sqrt(2 * P**2 * (np.cos(ALPHA - start) - np.cos(ALPHA - theta)))

    return float(quad(slowness, 0.0, 1.0, limit=200)[0])


def falling(share: float, time: float) -> float:
    """Rotation over alpha at a time before the first impact, by SciPy."""
    found = solve_ivp(
        lambda _t, y: [y[1], -(P**2) * np.sin(ALPHA - y[0])], (0.0, time), [share * ALPHA, 0.0], rtol=1e-11, atol=1e-13
    )
    return float(found.y[0][-1] / ALPHA)


def peak_after(share: float, impacts: int) -> float:
    """Amplitude over alpha after some impacts."""
    loss = RETURN ** (2 * impacts)
    value = np.cos(ALPHA) + loss * (np.cos(ALPHA - share * ALPHA) - np.cos(ALPHA))
    return float((ALPHA - np.arccos(value)) / ALPHA)


def peaks(share: float, step: float, duration: float, located: bool = False) -> list[float]:
    """Peaks after the start."""
    _, theta = free(share, step, duration, located)
    size = np.abs(theta)
    inner = (size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])
    return [float(v) for v in size[1:-1][inner]]


def peak_under_pulse(amplitude: float) -> float:
    """Largest rotation over alpha before any impact under a half sine of length pi / p, by SciPy."""
    start = float(np.arcsin(G * np.tan(ALPHA) / amplitude)) / P

    def rate(t, y):
        a = amplitude * np.sin(P * t) if t < np.pi / P else 0.0
        return [y[1], -(P**2) * (np.sin(ALPHA - y[0]) - a / G * np.cos(ALPHA - y[0]))]

    def back(_t, y):
        return y[1] + (0.0 if y[0] > 1e-6 else 1.0)

    back.terminal = True
    found = solve_ivp(rate, (start, 4.0), [0.0, 0.0], rtol=1e-10, atol=1e-13, max_step=0.01, events=back)
    return float(found.y[0].max() / ALPHA)


def shaken(amplitude: float, duration: float = 3.0) -> concio.DynamicsResult:
    pulse = concio.Pulse("half sine", amplitude, np.pi / P)
    return concio.dynamics(block(), pulse, duration, 2e-3, gravity=G)


def rectangular(amplitude: float) -> float:
    """Shortest rectangular pulse that overturns without an impact, by energy.

    Under a constant acceleration a energy grows by that of a share a / g of the weight acting sideways; what the block
    has when the pulse ends must carry its centroid over the foot. That gives the rotation it must have reached by then,
    and a quadrature the time it takes.
    """
    a = amplitude / G
    reached = ALPHA - float(np.arcsin(np.sin(ALPHA) - (1 - np.cos(ALPHA)) / a))

    def slowness(s):
        theta = reached * s * s
        gained = np.cos(ALPHA) - np.cos(ALPHA - theta) + a * (np.sin(ALPHA) - np.sin(ALPHA - theta))
        return 2 * reached * s / np.sqrt(2 * P**2 * gained)

    return float(quad(slowness, 0.0, 1.0, limit=200)[0])


def overturns(pulse: concio.Pulse) -> float:
    found = concio.dynamics(block(), pulse, pulse.duration + 2.0, 2e-3, gravity=G)
    return float(found.ending.name == "OVERTURNED")


def trilith(share: float, lintel: float) -> concio.Model:
    """Two columns turned clockwise, the lintel (height ``lintel``) level on their upper corners."""
    columns, tops = [], []
    for k, x in enumerate((0.0, 2.0)):
        outline = turned(rectangle(x, 0.0, WIDTH, HEIGHT), (x + WIDTH, 0.0), share * ALPHA)
        columns.append(concio.Body(f"column {k + 1}", outline, kind="rigid"))
        tops.append(outline[3])
    x, y = tops[0]
    beam = rectangle(x, y, 2.0 + WIDTH, lintel)
    return model(*columns, concio.Body("lintel", beam, kind="rigid"))


def trilith_return(lintel: float) -> tuple[float, float]:
    """Angular velocity after over before the first impact: closed form and computed."""
    gamma = (2.0 + WIDTH) * lintel / (2 * WIDTH * HEIGHT)
    exact = (1 - 1.5 * np.sin(ALPHA) ** 2 + 3 * gamma * np.cos(2 * ALPHA)) / (1 + 3 * gamma)
    found = concio.dynamics(
        trilith(0.3, lintel), duration=0.5, step=2.5e-4, start="as described", gravity=G, every=2.5e-4, adaptive=False
    )
    spin = np.diff(found.rotation("column 1")) / 2.5e-4
    jump = int(np.argmax(np.abs(np.diff(spin))))
    return float(exact), float(abs(spin[jump + 3] / spin[jump - 3]))


@cache
def rows() -> list[Row]:
    found = []
    for share in (0.25, 0.5, 0.9):
        found.append(
            Row(f"first impact from {share:g} alpha", quarter(share), zero_of(share, 2e-3), 1e-3, SCHEME, "s")
        )
    after = peaks(0.9, 1e-3, 4.6, located=True)
    for n in (1, 2, 3):
        found.append(Row(f"amplitude after impact {n}, over alpha", peak_after(0.9, n), after[n - 1], 0.01, SCHEME))
    exact = falling(0.5, 0.32)
    coarse, fine = (abs(float(free(0.5, s, 0.32)[1][-1]) - exact) for s in (0.016, 0.008))
    between = "an order is that of small steps"
    found.append(Row("order before an impact", 2.0, float(np.log2(coarse / fine)), 0.2, between, absolute=True))
    errors = [abs(peaks(0.5, s, 1.0)[0] - peak_after(0.5, 1)) for s in (2e-3, 2.5e-4)]
    order_hit = np.log(errors[0] / errors[1]) / np.log(8)
    found.append(Row("order of the amplitude after an impact", 1.0, float(order_hit), 0.5, between, absolute=True))
    a = 1.3 * G * np.tan(ALPHA)
    largest = float(np.abs(shaken(a, 1.6).rotation("block")).max() / ALPHA)
    found.append(
        Row("half sine, 1.3 g tan alpha: largest rotation over alpha", peak_under_pulse(a), largest, 5e-3, SCHEME,
            check="second method")
    )  # fmt: skip
    for share, fallen in ((0.99, 0.0), (1.01, 1.0)):
        over = float(shaken(share * 1.320454 * G * np.tan(ALPHA)).ending.name == "OVERTURNED")
        found.append(
            Row(f"half sine at {share:g} of the exact threshold overturns", fallen, over, 0.0,
                "yes or no", absolute=True)
        )  # fmt: skip
    for amplitude in (1.2, 2.0):
        a = amplitude * G * np.tan(ALPHA)
        for share, fallen in ((0.98, 0.0), (1.02, 1.0)):
            over = overturns(concio.Pulse("rectangular", a, share * rectangular(a)))
            found.append(
                Row(f"rectangular pulse, {amplitude:g} g tan alpha, at {share:g} of the exact length overturns", fallen,
                    over, 0.0, "yes or no", absolute=True)
            )  # fmt: skip
    for lintel in (0.1, 0.4):
        exact, computed = trilith_return(lintel)
        found.append(Row(f"trilith, lintel {lintel:g} m high: velocity kept", exact, computed, 0.01, SCHEME))
    pushed = concio.push(trilith(0.0, 0.4))
    found.append(
        Row("trilith: multiplier at which it begins to rock", float(np.tan(ALPHA)), pushed.peak, 1e-3,
            "the curve begins at a rotation that is small but not zero")
    )  # fmt: skip
    return found


def figure(axes) -> None:
    time, theta = free(0.9, 1e-3, 4.6)
    axes.plot(time, theta, color="#2b6cb0", linewidth=1.2)
    for n in (1, 2, 3):
        axes.axhline((-1) ** n * peak_after(0.9, n), color="#999999", linewidth=0.6, linestyle="--")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("rotation over alpha [-]")
