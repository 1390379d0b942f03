"""A vehicle on a bridge, position by position: the limit load of each, and a search for the worst.

The dead load is assembled once; each position gives a vector of loads, and one linear programme
(:mod:`concio.solvers.statics.associated_limit`) the associated multiplier with forces and a mechanism that prove it.
Uniform load that counts where it is unfavourable takes several programmes a position
(:mod:`concio.analysis.bridges.unfavourable`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Literal

import numpy as np

from concio.analysis.bridges.unfavourable import Part, least_favourable
from concio.contact.assembly import Assembly, assemble
from concio.contact.loads import place_forces
from concio.errors import InputError, SolverError
from concio.model.crossing import STRETCH, Vehicle
from concio.model.model import Model
from concio.model.road.earth import ground_of, spread_under, with_vehicle, without_vehicle
from concio.model.road.spread import SpreadLoad, along_the_road, spread, spread_rule
from concio.model.road.surface import Road, Surface
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Progress, ProgressCallback
from concio.representation import short_repr
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit

Array = np.ndarray

COARSE = 40
"""Positions of the first grid in the shortest span."""
FINE = 0.01
"""Distance between positions to which the worst is refined [m]."""
COARSEST = 20.0
"""Largest distance of positions, over the usual one: half a span."""
MOST = 4_000
"""Largest number of positions."""
APART = 0.05
"""Worst positions are distinguished where they are further from each other than this share of the road."""


@short_repr
@dataclass(frozen=True, eq=False)
class Standing:
    """A vehicle at one position.

    Parameters
    ----------
    position : float
        x of its reference point [m].
    direction : {"right", "left"}
        Of travel.
    limit : LimitLoad
        Associated multiplier of its load, with its proofs.
    on_masonry : float
        Load that reaches blocks that can move [kN].
    elsewhere : float
        Load that reaches fixed blocks [kN]; what stands beyond the road is in neither.
    loaded : tuple of (float, float) or None
        From where to where on the road uniform load stands [m]; None is wherever the vehicle has it.
    """

    position: float
    direction: str
    limit: LimitLoad
    on_masonry: float
    elsewhere: float
    loaded: Part | None = None

    @property
    def multiplier(self) -> float:
        """The associated multiplier: ``inf`` where nothing bounds the load."""
        return self.limit.multiplier


@dataclass(eq=False)
class Sweep:
    """Limit loads of a vehicle at any position of a model with fill.

    Parameters
    ----------
    model : Model
        With fill and a vehicle; loads that the vehicle has on the model are left out.
    """

    model: Model
    bare: Model = field(init=False)
    assembly: Assembly = field(init=False)
    dead: ContactProblem = field(init=False)
    ground: tuple[Surface, Road] = field(init=False)
    known: dict[tuple[float, str], Standing | None] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        if self.model.vehicle is None:
            msg = "the model has no vehicle"
            raise InputError(msg, hint="add [vehicle] with name = 'single axle' or axles = [[0.0, 100.0]]")
        self.bare = without_vehicle(self.model)
        self.ground = ground_of(self.model)
        self.assembly = assemble(self.bare)
        self.dead = self.assembly.problem()

    def load(self, position: float, direction: str, loaded: Part | None = None) -> tuple[Array, float, float]:
        """Return the load (N,) of the vehicle at a position, what reaches the masonry, and what does not [kN].

        Parameters
        ----------
        position : float
            [m].
        direction : {"right", "left"}
        loaded : Part, optional
            The part of the road on which its uniform load stands; by default that of the vehicle.
        """
        vehicle = self.vehicle if loaded is None else replace(self.vehicle, loaded=loaded)
        return self._carried(spread_under(self.model, position, direction, self.ground, whole=False, vehicle=vehicle))

    def _carried(self, found: SpreadLoad) -> tuple[Array, float, float]:
        body = self.ground[0].body[found.piece]
        free = np.array([self.bare.bodies[b].kind != "fixed" for b in body.tolist()], dtype=bool)
        forces = np.column_stack([np.zeros(int(free.sum())), -found.force[free]])
        f = place_forces(self.assembly.disc, body[free], found.at[free], forces)
        whole, own = float(found.force.sum()), float(found.force[free].sum())
        return np.asarray(self.assembly.supported.T.T @ f), own, whole - own

    def at(self, position: float, direction: str = "right") -> Standing | None:
        """Return the limit load at a position; None where nothing of the vehicle reaches the masonry."""
        key = (round(float(position), 9), direction)
        if key not in self.known:
            searched = self.vehicle.unfavourable and self.vehicle.uniform
            self.known[key] = self._unfavourable(*key) if searched else self._under(*key, self.vehicle.loaded)
        return self.known[key]

    def _under(self, position: float, direction: str, loaded: Part | None) -> Standing | None:
        """Return the limit load with uniform load on a part of the road."""
        live, own, rest = self.load(position, direction, loaded)
        if not own > 0:
            return None
        return Standing(position, direction, associated_limit(self.dead, live), own, rest, loaded)

    def _unfavourable(self, position: float, direction: str) -> Standing | None:
        """Return the limit load with uniform load where it is least favourable."""
        pieces, loads = self.pieces
        low, high = float(pieces[0, 0]), float(pieces[-1, 1])
        middle = min(max(position, low), high)
        parts: list[Part] = [(), ((low, middle),), ((middle, high),), ((low, high),)]
        near = [s for s in self.known.values() if s is not None and s.direction == direction and s.loaded is not None]
        parts += [s.loaded for s in sorted(near, key=lambda s: abs(s.position - position))[:1] if s.loaded is not None]
        starts = [tuple(p for p in part if p[1] > p[0]) for part in parts]
        return least_favourable(starts, lambda part: self._under(position, direction, part), pieces, loads)

    @cached_property
    def pieces(self) -> tuple[Array, Array]:
        """Pieces of the road (E, 2) that uniform load covers as a whole or not [m], and the load of each (E, N)."""
        low, high = self.ground[1].over(self.ground[0])
        ends = np.linspace(low, high, max(2, int(np.ceil((high - low) / self.step()))) + 1)
        assert self.model.fill is not None, "a road lies on a fill"
        rule = spread_rule(self.model.fill.spread)
        loads = [self._carried(spread(rule, *self.ground, tuple(along_the_road(a, b, b - a, 0.5 * (low + high)))))[0]
                 for a, b in pairwise(ends.tolist())]  # fmt: skip
        return np.column_stack([ends[:-1], ends[1:]]), np.array(loads)

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle that is moved."""
        assert self.model.vehicle is not None
        return self.model.vehicle

    def reach(self, direction: str = "right") -> tuple[float, float]:
        """Return between which positions an axle, or a stretch, is above blocks that can move [m]."""
        surface = self.ground[0]
        free = np.array([self.bare.bodies[b].kind != "fixed" for b in surface.body.tolist()], dtype=bool)
        low, high = surface.start[free, 0].min(), surface.end[free, 0].max()
        sign = -1.0 if direction == "left" else 1.0
        axles = [a for a in self.vehicle.axles if a.length is None or a.length < STRETCH]
        ends = [sign * a.at for a in axles]
        if not ends:
            ends = [sign * (a.at + s * 0.5 * (a.length or 0.0)) for a in self.vehicle.axles for s in (-1, 1)]
        return float(low - max(ends)), float(high - min(ends))

    @property
    def directions(self) -> tuple[str, ...]:
        """Directions of travel that are examined: one where the vehicle is the same both ways."""
        vehicle = replace(self.vehicle, loaded=None)
        if vehicle.direction != "both":
            return (vehicle.direction,)
        there, back = (sorted(vehicle.footprints(0.0, way)) for way in ("right", "left"))
        return ("right",) if np.allclose(there, back) else ("right", "left")

    def step(self) -> float:
        """Return the distance of positions of the first grid [m]."""
        low, high = self.reach()
        spans = [s for s in _lengths(self.model.generator.get("spans")) if s > 0]
        wanted = min([*spans, high - low]) / COARSE
        return max(wanted, (high - low) / MOST)


def placed(model: Model, standing: Standing) -> Model:
    """Return a model with its vehicle where it stands, and uniform load where that stands then."""
    assert model.vehicle is not None
    way: Literal["left", "right"] = "left" if standing.direction == "left" else "right"
    vehicle = replace(model.vehicle, position=standing.position, direction=way, loaded=standing.loaded)
    return with_vehicle(model, vehicle, whole=False)


def _lengths(given: object) -> list[float]:
    return [float(v) for v in given] if isinstance(given, Sequence) and not isinstance(given, str) else []


def grid(sweep: Sweep, step: float | None = None) -> list[tuple[float, str]]:
    """Return the positions of the first grid, with the direction of each.

    Raises
    ------
    InputError
        The distance is not positive or more than half a span, or there would be too many.
    """
    usual = sweep.step()
    width = usual if step is None else step
    if width > COARSEST * usual:
        msg = f"a step of {width:g} m passes over the worst positions: usual are {usual:.3g} m, a 40th of a span"
        raise InputError(msg, hint=f"at most {COARSEST * usual:.3g} m, half a span")
    found = []
    for way in sweep.directions:
        low, high = sweep.reach(way)
        if not width > 0 or (high - low) / width > MOST:
            msg = f"a step of {width:g} m is not a distance of positions on a bridge of {high - low:.4g} m"
            raise InputError(msg, hint=f"at most {MOST:,} positions")
        count = max(2, int(np.ceil((high - low) / width)) + 1)
        found += [(float(x), way) for x in np.linspace(low, high, count)]
    return found


def search(
    sweep: Sweep, *, step: float | None = None, fine: float = FINE, worst: int = 3,
    progress: ProgressCallback | None = None,
) -> tuple[Standing, ...]:
    """Return limit loads on a grid of positions that is refined about its least multipliers, from left to right.

    Parameters
    ----------
    sweep : Sweep
    step : float, optional
        Distance of positions of the first grid [m].
    fine : float
        Distance to which least multipliers are refined [m].
    worst : int
        How many of them, each the least in its neighbourhood.
    progress : callable, optional
    """
    places = grid(sweep, step)
    for k, (x, way) in enumerate(places):
        if progress is not None and progress(Progress("positions", k, float("nan"), f"{way}, x = {x:.3g} m")):
            msg = "stopped on request"
            raise SolverError(msg)
        sweep.at(x, way)
    for way in sweep.directions:
        own = [x for x, w in places if w == way]
        apart = own[1] - own[0]
        for standing in least(lowest(_known(sweep, way)), worst, APART * (own[-1] - own[0])):
            _refine(sweep, standing, apart, fine)
    return tuple(s for way in sweep.directions for s in _known(sweep, way))


def least(standings: Sequence[Standing], count: int, apart: float) -> list[Standing]:
    """Return the standings of least multiplier, each further than ``apart`` [m] from those before it."""
    found: list[Standing] = []
    for s in sorted((s for s in standings if np.isfinite(s.multiplier)), key=_order):
        if all(s.direction != o.direction or abs(s.position - o.position) > apart for o in found):
            found.append(s)
        if len(found) == count:
            break
    return found


def lowest(standings: Sequence[Standing]) -> list[Standing]:
    """Return the standings whose multiplier is not above those of their neighbours of the same direction."""
    found = []
    for way in dict.fromkeys(s.direction for s in standings):
        own = sorted((s for s in standings if s.direction == way), key=lambda s: s.position)
        values = np.array([np.inf, *(s.multiplier for s in own), np.inf])
        low = (values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:])
        found += [s for s, is_low in zip(own, low.tolist(), strict=True) if is_low]
    return found


def _order(standing: Standing) -> tuple[float, str, float]:
    """Return what standings are sorted by: of mirror images, whose multipliers differ by rounding, the left one."""
    return float(f"{standing.multiplier:.6g}"), "lr".replace(standing.direction[0], ""), standing.position


def _known(sweep: Sweep, way: str) -> list[Standing]:
    found = [s for (_, w), s in sweep.known.items() if w == way and s is not None]
    return sorted(found, key=lambda s: s.position)


def _refine(sweep: Sweep, best: Standing, apart: float, fine: float) -> None:
    """Look to both sides of a standing, at half the distance each time, and go where the multiplier is less."""
    while apart > fine:
        apart *= 0.5
        beside = [sweep.at(best.position + side * apart, best.direction) for side in (-1, 1)]
        best = min([best, *(s for s in beside if s is not None)], key=lambda s: s.multiplier)
