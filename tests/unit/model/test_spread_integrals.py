"""Loads on the road as they reach sloping pieces of a surface, against a fine sum of the pressure over each piece."""

from __future__ import annotations

import numpy as np
import pytest

from concio.model.road.spread import SpreadRule, _kinks, spread, spread_rules
from concio.model.road.surface import Road, Surface

X = np.array([-3.0, -1.3, -0.4, 0.5, 0.9, 2.2, 4.0])
Z = np.array([-1.2, -0.5, -0.1, 0.0, -0.05, -0.7, -2.0])
OWN = SpreadRule("own", along=0.9, across=0.4, shape="sine", length=0.2)


def road(scale: float) -> Road:
    return Road(scale * np.array([(-3.0, 0.5), (0.5, 0.7), (4.0, 0.4)]))


def surface(scale: float) -> Surface:
    points = scale * np.column_stack([X, Z])
    return Surface(np.arange(len(X) - 1), points[:-1], points[1:], np.zeros(len(X) - 1, dtype=int))


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
@pytest.mark.parametrize("rule", [*spread_rules().values(), OWN], ids=lambda r: r.name)
def test_forces_and_their_places_are_integrals_of_the_pressure(rule: SpreadRule, scale: float) -> None:
    """Footprints over a crown, over a slope and near an end of pieces; what lies beside the masonry is kept."""
    if scale != 1.0 and (rule.footprint is not None or rule.length):
        return  # lengths of their own do not scale
    placed, line = surface(scale), road(scale)
    for x, length, load in ((0.45, 0.3, 40.0), (-1.0, 0.25, 7.0), (1.9, 0.6, 12.0)):
        found = spread(rule, placed, line, ((scale * x, scale * length, load),))
        base = rule.base(scale * length)
        force, moment = np.zeros(len(placed)), np.zeros(len(placed))
        for k, (p, q) in enumerate(zip(placed.start, placed.end, strict=True)):
            n = 40_000
            share = (np.arange(n) + 0.5) / n
            at = p[0] + share * (q[0] - p[0])
            # depths are those at the ends of a piece, linear between them
            ends = [float(line.height(np.array([v[0]]))[0] - v[1]) for v in (p, q)]
            value = rule.pressure(at - scale * x, ends[0] + share * (ends[1] - ends[0]), base) * (q[0] - p[0]) / n
            force[k], moment[k] = value.sum(), (value * at).sum()
        wanted = np.flatnonzero(force > 0)
        assert found.piece.tolist() == wanted.tolist()
        assert found.force == pytest.approx(load * force[wanted] / force.sum(), rel=2e-4, abs=2e-5 * load)
        assert found.force.sum() == pytest.approx(load, rel=1e-12)
        middle = moment[wanted] / force[wanted]
        large = found.force > 0.02 * load
        assert found.at[large, 0] == pytest.approx(middle[large], rel=1e-3, abs=1e-3 * scale)
        slope = (placed.end - placed.start)[wanted]
        on = placed.start[wanted, 1] + (found.at[:, 0] - placed.start[wanted, 0]) * slope[:, 1] / slope[:, 0]
        assert found.at[:, 1] == pytest.approx(on, abs=1e-9 * scale)


def test_two_footprints_add_their_forces_and_moments() -> None:
    placed, line, rule = surface(1.0), road(1.0), spread_rules()["uniform 1:2"]
    one, other = ((0.45, 0.3, 40.0),), ((-1.0, 0.25, 7.0),)
    force, moment = np.zeros(len(placed)), np.zeros(len(placed))
    for part in (one, other):
        found = spread(rule, placed, line, part)
        force[found.piece] += found.force
        moment[found.piece] += found.force * found.at[:, 0]
    both = spread(rule, placed, line, one + other)
    assert both.force == pytest.approx(force[both.piece], rel=1e-12)
    assert both.force * both.at[:, 0] == pytest.approx(moment[both.piece], rel=1e-9)


def test_pieces_are_cut_where_the_pressure_begins_changes_and_ends() -> None:
    """On sloping pieces the widened base meets the place, the base itself and the middle of the load."""
    rng = np.random.default_rng(4)
    left = rng.uniform(-3.0, 1.0, 40)
    right, low, high = left + rng.uniform(0.2, 2.0, 40), rng.uniform(0.2, 2.0, 40), rng.uniform(0.2, 2.0, 40)
    x, base, rule = 0.3, 0.5, spread_rules()["uniform 1:2"]
    shares = _kinks(rule, (left, right), (low, high), x, base)
    inside = (shares > 0) & (shares < 1)
    assert inside.any(axis=0).all()
    place = left[:, None] + shares * (right - left)[:, None]
    depth = low[:, None] + shares * (high - low)[:, None]
    away, wide = place - x, 0.5 * base + 0.5 * rule.along * depth
    for column, wanted in enumerate((-wide, -0.5 * base, wide, 0.5 * base, 0.0)):
        k = inside[:, column]
        assert away[k, column] == pytest.approx(np.broadcast_to(wanted, away.shape)[k, column], abs=1e-12)
