r"""Fill on a model: its weight as loads, its pressure as one-way elements, vehicles as loads on the masonry.

Weights are those of vertical strips between the upper faces of the bodies and the road line, each at its own centroid.
Horizontal pressure on the vertical projection of the upper face of each block, at the middle of that face,

.. math:: \sigma_h = k_0 \sigma_v + \text{stiffness} \cdot u, \qquad
          0 \text{ or active} \le \sigma_h \le m_p (K_p \sigma_v + 2 c \sqrt{K_p}),

with u the displacement of the block into the fill, is a contact pair whose other side is the soil: a :class:`Tie` of
the kind "soil". It has a cap and a compliance, so that certificates, limit loads, paths and steps hold for it
unchanged.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.model.crossing import Vehicle
from concio.model.fill import Fill
from concio.model.model import Body, Load, Model, Tie
from concio.model.road.spread import SpreadLoad, along_the_road, spread, spread_rule
from concio.model.road.surface import Road, Surface

Array = np.ndarray

SOIL = "soil "
"""How the names of soil elements begin."""
NARROW = 1e-9
"""Widths that differ by less than this share are one."""
FLAT = 1e-6
"""Faces whose vertical projection is below this share of their length carry no horizontal pressure."""


@strict
def with_fill(model: Model, fill: Fill) -> Model:
    """Return a plane model with fill on it: its weight in group ``fill.group`` and its pressure as soil elements.

    Parameters
    ----------
    model : Model
        Plane, without fill.
    fill : Fill
        Where its ``width`` is "rule", the width is that of a vehicle of 1.8 m until another is put on.

    Raises
    ------
    InputError
        The model is in space or has fill already; the road does not lie above the masonry.

    Examples
    --------
    Where the barrel has no weight, its abutments carry that of the fill:

    >>> import concio
    >>> bare = concio.bridge(span=3.0, rise=0.75, ring=0.3, voussoirs=12, block="rigid", width=2.0, unit_weight=0.0)
    >>> model = concio.with_fill(bare, concio.Fill(cover=0.5, unit_weight=18.0))
    >>> fill = -sum(load.value[1] for load in model.loads if load.group == "fill")
    >>> result = concio.solve(model)
    >>> round(sum(float(force[1]) for force in result.reactions.values()) / fill, 6)
    1.0
    """
    if model.fill is not None:
        msg = "the model already has fill"
        raise InputError(msg, where="fill", hint="replace it before it is put on")
    if fill.group in model.load_groups:
        msg = f"the load group '{fill.group}' has loads already"
        raise InputError(msg, where="fill", hint="give the fill another group")
    width, _ = width_used(model, fill, model.vehicle)
    _check_spandrels(fill, width)
    if fill.width != "full":
        fill = replace(fill, bridge_width=max(b.thickness for b in model.bodies))
        model = _as_wide(model, width)
    surface = Surface.of(model)
    road = Road.of(fill, surface)
    weight = _weights(model, fill, surface, road)
    pressed, soil = _pressures(model, fill, surface, road)
    return replace(model, fill=fill, loads=(*model.loads, *weight, *pressed), ties=(*model.ties, *soil))


@strict
def with_vehicle(model: Model, vehicle: Vehicle, *, whole: bool = True) -> Model:
    """Return a model with fill under a vehicle: loads of its group on the masonry, where its position is given.

    Parameters
    ----------
    model : Model
        With fill; a vehicle that it has already is taken away with its loads.
    vehicle : Vehicle
    whole : bool
        Whether all of its axles have to stand on the road; else those beyond it are left out.

    Raises
    ------
    InputError
        The model has no fill, other loads are in the group of the vehicle, or an axle stands outside the road.

    Examples
    --------
    Both axles stand over the span. The barrel takes all of their 160 kN:

    >>> import concio
    >>> bare = concio.bridge(span=6.0, rise=1.5, ring=0.3, voussoirs=12, block="rigid", width=3.0)
    >>> filled = concio.with_fill(bare, concio.Fill(cover=0.5))
    >>> lorry = concio.Vehicle("lorry", axles=(concio.Axle(0.0, 60.0), concio.Axle(1.2, 100.0)), position=2.4)
    >>> model = concio.with_vehicle(filled, lorry)
    >>> round(-sum(load.value[1] for load in model.loads if load.group == "live"), 6)
    160.0
    """
    if model.fill is None:
        msg = "the model has no fill, and no rule says how the vehicle's load reaches the masonry"
        raise InputError(msg, where="vehicle", hint="add [fill] with cover = ...")
    if model.vehicle is not None:
        model = without_vehicle(model)
    if vehicle.group in model.load_groups:
        msg = f"the load group '{vehicle.group}' has other loads already"
        raise InputError(msg, where="vehicle", hint="give the vehicle a group of its own")
    assert model.fill is not None
    width, _ = width_used(model, model.fill, vehicle)
    if model.fill.width == "rule" and abs(width / max(b.thickness for b in model.bodies) - 1.0) > NARROW:
        full = model.fill.bridge_width or width
        model = with_fill(_as_wide(without_fill(model), full), replace(model.fill, width=width))
        assert model.fill is not None
        model = replace(model, fill=replace(model.fill, width="rule"))
    bare = replace(model, vehicle=vehicle)
    if vehicle.position is None:
        return bare
    found = spread_under(bare, vehicle.position, whole=whole)
    return replace(bare, loads=(*model.loads, *point_loads(bare, found, vehicle.group)))


def without_vehicle(model: Model) -> Model:
    """Return a model without its vehicle and the loads of that."""
    if model.vehicle is None:
        return model
    group = model.vehicle.group
    return replace(model, vehicle=None, loads=tuple(load for load in model.loads if load.group != group))


def without_fill(model: Model) -> Model:
    """Return a model without its fill, the loads of that and its soil elements."""
    if model.fill is None:
        return model
    loads = tuple(load for load in model.loads if load.group != model.fill.group)
    return replace(model, fill=None, loads=loads, ties=tuple(t for t in model.ties if t.kind != "soil"))


def without_pressure(model: Model) -> Model:
    """Return a model whose fill has weight and spreads load, but presses no block sideways."""
    if model.fill is None:
        return model
    bars = tuple(t for t in model.ties if t.kind != "soil")
    loads = tuple(x for x in model.loads if not (x.group == model.fill.group and x.value[0] != 0.0))
    fill = replace(model.fill, passive=0.0, mobilised=1.0, pressure="none")
    return replace(model, fill=fill, ties=bars, loads=loads)


def ground_of(model: Model) -> tuple[Surface, Road]:
    """Return the faces below the fill of a model and its road line.

    Raises
    ------
    InputError
        The model has no fill.
    """
    if model.fill is None:
        msg = "the model has no fill"
        raise InputError(msg, hint="add [fill] with cover = ...")
    surface = Surface.of(model)
    return surface, Road.of(model.fill, surface)


def spread_under(
    model: Model, position: float, direction: str = "", ground: tuple[Surface, Road] | None = None,
    *, whole: bool = True, vehicle: Vehicle | None = None,
) -> SpreadLoad:  # fmt: skip
    """Return what the vehicle of a model brings to the masonry where its reference point is at ``position`` [m].

    Parameters
    ----------
    model : Model
        With fill and a vehicle.
    position : float
        [m].
    direction : {"", "right", "left"}
        Direction of travel in place of the vehicle's.
    ground : (Surface, Road), optional
        :func:`ground_of` the model.
    whole : bool
        Whether all axles have to stand on the road; else those beyond it are left out. Of stretches of uniform load
        only what stands on the road counts.
    vehicle : Vehicle, optional
        In place of that of the model.

    Raises
    ------
    InputError
        An axle stands outside the road.
    """
    vehicle = vehicle or model.vehicle
    assert model.fill is not None
    assert vehicle is not None
    surface, road = ground_of(model) if ground is None else ground
    low, high = road.over(surface)
    on_road = []
    for x, length, load, stretch in vehicle.footprints(position, direction):
        if stretch:
            begin, end = max(x - 0.5 * length, low), min(x + 0.5 * length, high)
            if end > begin:
                on_road += along_the_road(begin, end, load * (end - begin) / length, 0.5 * (low + high))
        elif low - 1e-9 <= x <= high + 1e-9:
            on_road.append((x, length, load))
        elif whole:
            msg = f"an axle of {load:.4g} kN at x = {x:.4g} m stands outside the road ({low:.4g} to {high:.4g} m)"
            raise InputError(msg, where="vehicle", hint="move the vehicle, or let the road reach further")
    return spread(spread_rule(model.fill.spread), surface, road, tuple(on_road))


def point_loads(model: Model, found: SpreadLoad, group: str) -> tuple[Load, ...]:
    """Return spread load as loads on the bodies that can move; what fixed bodies take is left out."""
    surface = Surface.of(model)
    body = surface.body[found.piece]
    return tuple(
        Load("point", (0.0, -float(f)), bodies=(model.bodies[b].name,), at=(float(p[0]), float(p[1])), group=group)
        for b, f, p in zip(body.tolist(), found.force, found.at, strict=True) if model.bodies[b].kind != "fixed"
    )  # fmt: skip


def width_used(model: Model, fill: Fill, vehicle: Vehicle | None = None) -> tuple[float, str]:
    """Return the width of the structure that is computed [m], and how it was found."""
    own = max(b.thickness for b in model.bodies)
    full = fill.bridge_width or own
    if fill.width == "full":
        return own, "the whole width of the bodies"
    if fill.width == "rule":
        rule = spread_rule(fill.spread)
        surface = Surface.of(model)
        crown = surface.crown
        depth = float(Road.of(fill, surface).height(crown[:1])[0] - crown[1])
        wide = rule.width_at(1.8 if vehicle is None else vehicle.narrowest, depth)
        if wide < full:
            return wide, f"that of the rule '{rule.name}' at the depth of {depth:.3g} m below the road"
        return full, f"the whole width of the bodies: the rule '{rule.name}' gives {wide:.3g} m"
    return float(fill.width), "as given"


def _check_spandrels(fill: Fill, width: float) -> None:
    if not fill.spandrels:
        return
    if fill.width != "full":
        msg = "spandrels and a width narrower than the bridge are both given: the walls stand at its edges"
        raise InputError(msg, where="fill", hint="take width = 'full', or leave spandrels out")
    if 2.0 * fill.spandrels >= width:
        msg = f"two spandrel walls of {fill.spandrels:g} m leave no fill in a width of {width:g} m"
        raise InputError(msg, where="fill", hint="spandrels is the thickness of each of the two")


def _as_wide(model: Model, width: float) -> Model:
    """Return a model whose bodies are all of one width [m]."""
    return replace(model, bodies=tuple(replace(cast("Body", b), thickness=width) for b in model.bodies))


def stress_at(fill: Fill, depth: Array, surfacing: Array | float = 0.0) -> Array:
    """Return the vertical stress in the fill [kN/m2] at depths below the road [m].

    Parameters
    ----------
    fill : Fill
    depth : array
        [m].
    surfacing : array or float
        Depth of the fill line below the road at the same places, where the fill has one [m].
    """
    depth = np.asarray(depth, dtype=float)
    if fill.fill_line:
        above = np.minimum(depth, surfacing)
        stress: Array = fill.surfacing_weight * above + fill.unit_weight * (depth - above)
        return stress
    total, begin = np.zeros_like(depth), 0.0
    for layer in fill.layers:
        total += layer.unit_weight * np.clip(depth - begin, 0.0, layer.depth)
        begin += layer.depth
    return total + fill.unit_weight * np.maximum(depth - begin, 0.0)


def _load_at(fill: Fill, road: Road, thickness: float, x: Array, y: Array) -> Array:
    """Return the weight of fill, surfacing and spandrel walls above places (x, y), per length of road [kN/m]."""
    depth = road.height(x) - y
    walls = 2.0 * fill.spandrels
    own = (thickness - walls) * stress_at(fill, depth, road.surfacing(x))
    found: Array = own + walls * fill.spandrel_weight * (depth + fill.parapet)
    return found


def _weights(model: Model, fill: Fill, surface: Surface, road: Road) -> tuple[Load, ...]:
    """Return the weight of the strips above the bodies that can move."""
    breaks = np.concatenate([road.line[1:-1, 0], road.under[1:-1, 0]])
    found = []
    for k in range(len(surface)):
        body = model.bodies[int(surface.body[k])]
        if body.kind == "fixed":
            continue
        start, end = surface.start[k], surface.end[k]
        x = np.unique(np.concatenate([[start[0], end[0]], breaks[(breaks > start[0]) & (breaks < end[0])]]))
        y = start[1] + (x - start[0]) * (end[1] - start[1]) / (end[0] - start[0])
        q = _load_at(fill, road, body.thickness, x, y)  # linear between these places: layers lie above
        width = np.diff(x)
        force = float((0.5 * (q[1:] + q[:-1]) * width).sum())
        if not force:
            continue
        first = float((width * (q[:-1] * (2 * x[:-1] + x[1:]) + q[1:] * (x[:-1] + 2 * x[1:]))).sum() / 6.0)
        at = first / force
        height = float(start[1] + (at - start[0]) * (end[1] - start[1]) / (end[0] - start[0]))
        found.append(Load("point", (0.0, -force), bodies=(body.name,), at=(at, height), group=fill.group))
    return tuple(found)


def _pressures(model: Model, fill: Fill, surface: Surface, road: Road) -> tuple[tuple[Load, ...], tuple[Tie, ...]]:
    """Return active pressure as loads, and soil elements, one for each block and slope."""
    coefficient, constant = fill.passive_coefficient, fill.passive_cohesion
    initial = fill.initial_coefficient
    active = initial if fill.pressure == "active" else 0.0
    if not (coefficient or initial):
        return (), ()
    loads: list[Load] = []
    soil: list[Tie] = []
    arm = model.size
    faces = faces_under_fill(model, surface)
    for name, (b, side, points) in zip(_names(model, faces), faces, strict=True):
        body = model.bodies[b]
        at = _middle(points)
        rise = float(np.ptp(points[:, 1]))
        area = rise * (body.thickness - 2.0 * fill.spandrels)
        stress = float(stress_at(fill, road.height(at[:1]) - at[1:], road.surfacing(at[:1]))[0])
        most = (coefficient * stress + constant) * area
        least = active * stress * area
        if least:
            loads.append(Load("point", (side * least, 0.0), bodies=(body.name,), at=_pair(at), group=fill.group))
        if most <= least:
            continue
        prestress = min(initial * stress * area, most) if fill.pressure == "at rest" else 0.0
        far = (float(at[0] - side * arm), float(at[1]))
        arguments: dict[str, Any] = {"prestress": prestress, "yield_force": most - least, "kind": "soil"}
        soil.append(Tie(f"{SOIL}{name}", body.name, _pair(at), "", far, fill.stiffness * area, **arguments))
    return tuple(loads), tuple(soil)


def faces_under_fill(model: Model, surface: Surface) -> list[tuple[int, float, Array]]:
    """Return body, direction in which fill presses it (1 to the right), and points (k, 2) of each slope below fill."""
    found: list[tuple[int, float, Array]] = []
    rise = surface.end[:, 1] - surface.start[:, 1]
    length = np.hypot(rise, surface.end[:, 0] - surface.start[:, 0])
    way = np.where(np.abs(rise) <= FLAT * length, 0.0, np.sign(rise))
    k = 0
    while k < len(surface):
        last = k
        while (
            last + 1 < len(surface) and surface.body[last + 1] == surface.body[k] and way[last + 1] == way[k]
            and np.allclose(surface.end[last], surface.start[last + 1], rtol=0.0, atol=1e-9 * model.size)
        ):  # fmt: skip
            last += 1
        body = int(surface.body[k])
        if way[k] and model.bodies[body].kind != "fixed":
            found.append((body, float(way[k]), np.vstack([surface.start[k : last + 1], surface.end[last : last + 1]])))
        k = last + 1
    return found


def _names(model: Model, faces: list[tuple[int, float, Array]]) -> list[str]:
    """Return a name for each face: that of its body, numbered where the body has several."""
    count = np.bincount([b for b, _, _ in faces], minlength=len(model.bodies))
    seen = np.zeros(len(model.bodies), dtype=int)
    names = []
    for b, _, _ in faces:
        seen[b] += 1
        names.append(model.bodies[b].name + (f" {seen[b]}" if count[b] > 1 else ""))
    return names


def _middle(points: Array) -> Array:
    """Return the point half way along a line of points (k, 2)."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    half = 0.5 * along[-1]
    return np.array([np.interp(half, along, points[:, c]) for c in (0, 1)])


def _pair(point: Array) -> tuple[float, float]:
    return float(point[0]), float(point[1])
