"""Small model files whose verdicts are known by hand, for tests that ask every command the same question."""

from __future__ import annotations

STONE = """
[materials.stone]
kind = "rigid"
unit_weight = "20 kN/m3"
[joints.dry]
friction = {friction}
"""
FLOOR = """
[[blocks]]
name = "floor"
rectangle = [[-3.0, -0.5], [3.0, 0.0]]
kind = "fixed"
"""
WEIGHT = """
[[loads]]
kind = "weight"
value = [0.0, -1.0]
group = "dead"
"""


def pillar(live: str = "", *, lean: float = 0.0, friction: float = 0.7, more: str = "") -> str:
    """Return a pillar of 0.4 x 1.6 m and 12.8 kN, its top shifted by ``lean`` [m]; tips at (0.2 - lean / 2) / 0.8."""
    outline = f"[[-0.2, 0.0], [0.2, 0.0], [{0.2 + lean}, 1.6], [{lean - 0.2}, 1.6]]"
    block = f'[[blocks]]\nname = "pillar"\noutline = {outline}\nkind = "rigid"\nmaterial = "stone"\n'
    return STONE.format(friction=friction) + FLOOR + block + WEIGHT + live + more


def sideways(value: float, group: str = "live") -> str:
    """Return a load of ``value`` times the weights along x."""
    return f'[[loads]]\nkind = "weight"\nvalue = [{value}, 0.0]\ngroup = "{group}"\n'


def point(x: float, y: float, at: tuple[float, float], group: str = "live") -> str:
    """Return a point load on the pillar [kN]."""
    return (
        f'[[loads]]\nkind = "point"\nvalue = [{x}, {y}]\nbodies = ["pillar"]\nat = [{at[0]}, {at[1]}]\n'
        f'group = "{group}"\n'
    )


def turned(degrees: float) -> str:
    """Return a support that turns the floor."""
    return f'[[supports]]\nname = "turn"\nbody = "floor"\nrotation = "{degrees} deg"\n'


def slot(friction: float = 0.6, *, elastic: bool = False) -> str:
    """Return two blocks in a slot between fixed walls with nothing below: forces exist, and nothing puts them there."""
    stone = STONE.format(friction=friction)
    if elastic:
        stone = stone.replace('kind = "rigid"', 'E = "5 GPa"\nnu = 0.2')
    walls = "".join(
        f'[[blocks]]\nname = "{name}"\nrectangle = [[{x}, -0.5], [{x + 1}, 1.5]]\nkind = "fixed"\n'
        for name, x in (("left", -1.0), ("right", 1.0))
    )
    blocks = "".join(
        f'[[blocks]]\nname = "b{k}"\nrectangle = [[{x}, 0.0], [{x + 0.5}, 1.0]]\nmaterial = "stone"\n'
        for k, x in ((1, 0.0), (2, 0.5))
    )
    live = (
        '[[loads]]\nkind = "pressure"\nvalue = "10 kPa"\nbodies = ["b1", "b2"]\nedge = [[0.0, 1.0], [1.0, 1.0]]\n'
        'group = "live"\n'
    )
    return stone + walls + blocks + WEIGHT + live


NARROW = '[panel]\ncourses = 3\nblocks = 2\nfriction = 0.6\nbase = "none"\ntop_pressure = "10 kN/m2"\n'
"""A panel that hangs between two walls and is too narrow to arch."""

ARCH = """
[arch]
span = 3.0
ring = 0.4
voussoirs = 9
block = "rigid"
unit_weight = "25 kN/m3"
friction = 0.6
crown_load = 2.0
"""
"""An arch that stands."""

THIN = ARCH.replace("ring = 0.4", "ring = 0.1").replace("voussoirs = 9", "voussoirs = 15")
"""An arch thinner than Milankovitch's ring."""


def hanging(live: str = "") -> str:
    """Return a block between two fixed walls that nothing presses, beside a heavier block on a floor of its own."""
    walls = "".join(
        f'[[blocks]]\nname = "{name}"\nrectangle = [[{x}, 0.0], [{x + 1}, 1.0]]\nkind = "fixed"\n'
        for name, x in (("left", -1.0), ("right", 1.0))
    )
    ground = '[[blocks]]\nname = "ground"\nrectangle = [[5.0, -1.0], [7.0, 0.0]]\nkind = "fixed"\n'
    blocks = "".join(
        f'[[blocks]]\nname = "{name}"\nrectangle = {place}\nmaterial = "stone"\n'
        for name, place in (("hangs", "[[0.0, 0.0], [1.0, 1.0]]"), ("stands", "[[5.0, 0.0], [7.0, 2.0]]"))
    )
    return STONE.format(friction=0.6) + walls + ground + blocks + WEIGHT + live


def soft(live: str) -> str:
    """Return the pillar on joints that give way."""
    return pillar(live).replace(
        "friction = 0.7", 'friction = 0.7\nnormal_stiffness = "20 GPa/m"\ntangential_stiffness = "8 GPa/m"'
    )


def held(force: float, height: float, *, friction: float = 0.6) -> str:
    """Return a block of 0.5 x 1 m and 10 kN pushed by ``force`` [kN] at its top, held by a tie of 3 kN."""
    block = '[[blocks]]\nname = "b"\nrectangle = [[0.0, 0.0], [0.5, 1.0]]\nkind = "rigid"\nmaterial = "stone"\n'
    live = f'[[loads]]\nkind = "point"\nvalue = [{force}, 0.0]\nbodies = ["b"]\nat = [0.0, 1.0]\ngroup = "live"\n'
    tie = (
        f'[[ties]]\nname = "rod"\nbody_a = "b"\nat_a = [0.0, {height}]\nbody_b = ""\nat_b = [-1.0, {height}]\n'
        'stiffness = "1000 kN/m"\nyield_force = "3 kN"\n'
    )
    return STONE.format(friction=friction) + FLOOR + block + WEIGHT + live + tie


def strip(wind: float) -> str:
    """Return a strip of facade, 6.2 x 0.5 m, with a floor, a roof that thrusts, and wind [kN/m2] that acts as live."""
    wall = '[[blocks]]\nname = "pillar"\nrectangle = [[0.0, 0.0], [0.5, 6.2]]\nkind = "rigid"\nmaterial = "stone"\n'
    roof = point(0.0, -12.0, (0.40, 3.0), "floors") + point(-1.0, -7.0, (0.35, 6.2), "roof")
    blown = (
        f'[[loads]]\nkind = "pressure"\nvalue = "{wind} kN/m2"\nbodies = ["pillar"]\n'
        'edge = [[0.5, 0.0], [0.5, 6.2]]\ngroup = "live"\n'
    )
    stone = STONE.format(friction=0.6).replace("20 kN", "18 kN")
    return stone + FLOOR + wall + WEIGHT + roof + blown
