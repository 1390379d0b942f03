"""Strength of cells: closed forms in all directions, invariance, exact half-spaces, Coulomb numbers beside them."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import concio
from cells import moved, other_origin, stress_matrix
from concio.analysis.cells.half_spaces import HalfSpaces
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.errors import InputError, NoEquilibriumError
from concio.solvers.statics.associated_limit import associated_limit
from samples import first, sample


def running(a, b, f, c, **options):
    """Rigid blocks b x a in running bond, joints with the whole Coulomb cone."""
    law = concio.JointLaw(f, cohesion=c, tensile_strength=c / f)
    return concio.cell(block="rigid", block_size=(b, a), friction=law, **options)


def closed_form(a, b, f, c):
    """Half-spaces of de Buhan and de Felice's domain of running bond with half a block of lap."""
    k = b / (2 * a)
    rows = [(0.0, f, 1.0, c), (f, f * f * k, f * (k + f), c * (1 + f * k)), (f, k, 1 + f * k, c * (1 + k / f))]
    if f > 1:
        rows = [rows[0], (f, f * f * k, 1 + k / f, c * (1 + f * k))]
    both = [(x, y, sign * t, h) for x, y, t, h in rows for sign in (1, -1)]
    return HalfSpaces.of(np.array(both)[:, :3], np.array(both)[:, 3])


@pytest.mark.parametrize(("a", "b", "f"), [(0.175, 0.4, 0.65), (0.3, 0.2, 0.9), (0.1, 0.25, 1.0), (0.1, 0.3, 1.4)])
def test_running_bond_has_the_closed_form_in_random_directions(a, b, f):
    cell = PeriodicCell.of(running(a, b, f, 1.0, thickness=0.3))
    problem, exact = cell.problem(), closed_form(a, b, f, 1.0)
    rng = np.random.default_rng(7)
    for direction in rng.normal(size=(sample(20, 200), 3)):
        found = associated_limit(problem, cell.load(direction))
        assert found.checked
        wanted = exact.distance(direction)
        if np.isinf(wanted):
            assert np.isinf(found.multiplier)
        else:
            assert found.multiplier == pytest.approx(wanted, rel=1e-10)
            assert found.upper == pytest.approx(wanted, rel=1e-10)


def test_the_numbers_of_the_published_case():
    """Factor along five directions; a = 0.175, b = 0.4, f = 0.65, c = 1."""
    directions = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -1, 0), (-1, -1, 1)]
    found = concio.strength(running(0.175, 0.4, 0.65, 1.0), directions, coulomb=False, faces=False)
    numbers = [ray.multiplier for ray in found.rays]
    assert numbers == pytest.approx([2.681319, 1.538462, 1.0, 10.427350, 2.857143], abs=5e-7)
    assert found.checked


@pytest.mark.parametrize("name", ["tall blocks", "long blocks", "friction above one", "with crushing"])
def test_the_half_spaces_are_found_exactly(name):
    a, b, f = {"tall blocks": (0.3, 0.2, 0.9), "friction above one": (0.1, 0.3, 1.4)}.get(name, (0.175, 0.4, 0.65))
    if name == "with crushing":
        law = concio.JointLaw(f, cohesion=1.0, tensile_strength=1 / f, compressive_strength=10.0)
        cell = concio.cell(block="rigid", block_size=(b, a), friction=law)
    else:
        cell = running(a, b, f, 1.0)
    found = concio.strength(cell, coulomb=False)
    assert found.domain.exact
    assert found.domain.shortfall == 0.0
    faces = found.faces
    if name == "with crushing":
        assert np.isfinite([faces.distance(d) for d in np.vstack([np.eye(3), -np.eye(3)])]).all()
        own = found.cell
        for direction in np.random.default_rng(1).normal(size=(sample(20, 200), 3)):
            ray = associated_limit(own.problem(), own.load(direction))
            assert ray.multiplier == pytest.approx(faces.distance(direction), rel=1e-8)
        return
    wanted = closed_form(a, b, f, 1.0).reduced()
    assert len(faces) == len(wanted)
    for normal, offset in zip(wanted.normals, wanted.offsets, strict=True):
        apart = np.abs(faces.normals - normal).max(1)
        k = int(np.argmin(apart))
        assert apart[k] < 1e-10
        assert faces.offsets[k] == pytest.approx(offset, rel=1e-10)


@pytest.mark.long
def test_every_half_space_is_proven_by_its_mechanism_and_every_point_is_carried():
    cell = concio.cell(bond="rubble", length=0.8, height=0.6, stone=0.3, seed=1, block="rigid",
                       friction=concio.JointLaw(0.5, cohesion=2.0, tensile_strength=1.0))  # fmt: skip
    found = concio.strength(cell, coulomb=False)
    domain, own = found.domain, found.cell
    assert not domain.exact, "hundreds of half-spaces: the search ends before"
    assert 0 < domain.shortfall < 0.02
    problem = own.problem()
    for mechanism, normal, offset in zip(domain.mechanisms, domain.faces.normals, domain.faces.offsets, strict=True):
        v = mechanism.velocity
        w_n, w_t = problem.C_n @ v, problem.C_t @ v
        assert (w_n >= 0.5 * np.abs(w_t) - 1e-9).all()
        absorbed = float((2.0 * problem.area * np.abs(w_t) + 1.0 * problem.area * (w_n - 0.5 * np.abs(w_t))).sum())
        rate = v[-3:] / own.size
        assert rate / np.linalg.norm(rate) == pytest.approx(normal, abs=1e-9)
        assert offset == pytest.approx(absorbed / own.volume / np.linalg.norm(rate), rel=1e-8)
    for point in domain.points:
        assert domain.faces.margin(point) >= -1e-7 * domain.faces.size


@pytest.mark.parametrize("repeat", first(1, [(2, 1), (3, 2)], single=True))
def test_larger_cells_are_as_strong(repeat):
    rng = np.random.default_rng(3)
    for options in ({"bond": "flemish"}, {"lap": 0.3}):
        one, many = (
            PeriodicCell.of(concio.cell(block="rigid", friction=concio.JointLaw(0.7, 3.0, 1.0), repeat=r, **options))
            for r in ((1, 1), repeat)
        )
        for direction in rng.normal(size=(10, 3)):
            a, b = (associated_limit(c.problem(), c.load(direction)).multiplier for c in (one, many))
            assert a == pytest.approx(b, rel=1e-8)


def test_turning_mirroring_and_moving_the_cell_change_nothing():
    cell = concio.cell(bond="rubble", length=0.9, height=0.7, stone=0.3, seed=2, block="rigid",
                       friction=concio.JointLaw(0.5, cohesion=2.0, tensile_strength=1.0))  # fmt: skip
    own = PeriodicCell.of(cell)
    c, s = np.cos(0.4), np.sin(0.4)
    turn, mirror = np.array([[c, -s], [s, c]]), np.diag([-1.0, 1.0])
    others = [(PeriodicCell.of(moved(cell, Q, (1.0, 2.0))), stress_matrix(Q)) for Q in (turn, mirror, turn @ mirror)]
    others.append((PeriodicCell.of(other_origin(cell, 1)), np.eye(3)))
    leaned = 0
    for direction in np.random.default_rng(2).normal(size=(8, 3)):
        wanted = associated_limit(own.problem(), own.load(direction)).multiplier
        for other, T in others:
            found = associated_limit(other.problem(), other.load(T @ direction)).multiplier
            assert found == pytest.approx(wanted, rel=1e-7)
        straight = associated_limit(own.problem(), own.load(direction * [1, 1, -1])).multiplier
        leaned += abs(straight - wanted) > 1e-3 * wanted
    assert leaned, "a cell without symmetry, else turning the wrong way would go unseen"


def test_elastic_blocks_are_as_strong_as_rigid_ones():
    law = concio.JointLaw(0.65, cohesion=1.0, tensile_strength=1 / 0.65)
    found = concio.strength(
        concio.cell(block_size=(0.4, 0.175), friction=law), [(1, 0, 0), (1, -1, 0.3)], coulomb=False
    )
    exact = closed_form(0.175, 0.4, 0.65, 1.0)
    assert [r.multiplier for r in found.rays] == pytest.approx([exact.distance(r.direction) for r in found.rays])


@pytest.mark.long
def test_coulomb_numbers_stand_beside_the_bound():
    """Dry bond under vertical pressure: the path reaches the bound of shear; towers part without friction's help."""
    cell = concio.cell(block="rigid", block_size=(0.4, 0.175), friction=0.65)
    found = concio.strength(cell, [(1, 0, 0), (0, 0, 1)], stress=(0, -100, 0), faces=False)
    along, shear = found.rays
    assert along.multiplier == pytest.approx(0.65 * 100 * 0.4 / 0.35)
    assert along.carried == pytest.approx(along.multiplier)
    assert along.collapse_state.multiplier == pytest.approx(0.0, abs=1e-9)
    assert along.coulomb == pytest.approx(0.0, abs=1e-9)
    assert shear.multiplier == pytest.approx(closed_form(0.175, 0.4, 0.65, 0.0).distance((0, 0, 1), (0, -100, 0)))
    assert shear.carried == pytest.approx(shear.multiplier)
    assert shear.collapse_shown
    assert found.strain_rate(shear) == pytest.approx([0.557769, 0.414343, 1.0], abs=1e-6)
    table = found.table()
    assert table["associated"].tolist() == [along.multiplier, shear.multiplier]
    assert found.summary()["faces"] is None


def test_what_is_carried_without_end_and_what_is_not_carried_at_all():
    cell = concio.cell(block="rigid", friction=0.6)
    found = concio.strength(cell, [(-1, -1, 0), (1, 0, 0)], faces=False)
    assert [r.multiplier for r in found.rays] == [np.inf, pytest.approx(0.0, abs=1e-12)]
    with pytest.raises(NoEquilibriumError, match="beyond the strength"):
        concio.strength(cell, [(0, 0, 1)], stress=(0, 1.0, 0))
    smooth = concio.strength(concio.cell(block="rigid", friction=0.0), coulomb=False)
    assert smooth.domain is None
    with pytest.raises(InputError, match="no inside"):
        _ = smooth.faces


def test_directions_are_given_or_spread():
    cell = running(0.175, 0.4, 0.65, 1.0)
    found = concio.strength(cell, 24, coulomb=False, faces=False)
    D = np.array([r.direction for r in found.rays])
    assert np.linalg.norm(D, axis=1) == pytest.approx(np.ones(24))
    assert np.abs(D.mean(0)).max() < 0.05
    for wrong, words in ((0, "at least 1"), ([(1, 0)], "three numbers"), ([(0, 0, 0)], "zero"), ("all", "directions")):
        with pytest.raises(InputError, match=words):
            concio.strength(cell, wrong)
    with pytest.raises(InputError, match="three numbers"):
        concio.strength(cell, stress=(1, 2))


def test_half_spaces_know_their_corners_and_sections():
    normals = np.vstack([np.eye(3), -np.eye(3), [[1, 1, 0]], [[1, 1, 1]]])
    box = HalfSpaces.of(normals, np.array([1, 2, 3, 1, 1, 1, 2, 50.0]))
    kept = box.reduced()
    assert len(kept) == 7  # the last is redundant
    corners, own = kept.vertices
    assert own.all()
    assert len(corners) == 10
    assert np.array([kept.margin(v) for v in corners]) == pytest.approx(np.zeros(10), abs=1e-9)
    polygon = kept.section((1, 0, 0), (0, 1, 0), (0, 0, 0.5), 100.0)
    area = 0.5 * sum(p[0] * q[1] - p[1] * q[0] for p, q in pairwise([*polygon, polygon[0]]))
    assert area == pytest.approx(2 * 3 - 0.5)
    assert kept.distance((1, 0, 0)) == 1.0
    assert kept.distance((1, 1, 0), (0, 0, 1.0)) == pytest.approx(1.0)
    assert len(box.section((1, 0, 0), (0, 1, 0), (0, 0, 10.0), 100.0)) == 0
    half = HalfSpaces.of(np.array([[0, 0, 1.0]]), np.ones(1))
    assert half.distance((1, 0, 0)) == np.inf


DIRECTIONS = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0)]


def test_the_table_has_a_row_for_each_direction_with_the_strain_rate_of_its_mechanism():
    found = concio.strength(running(0.25, 0.125, 0.6, 5.0), DIRECTIONS, coulomb=False, faces=False)
    table = found.table()
    assert {len(column) for column in table.values()} == {4}
    rates = np.column_stack([v for k, v in table.items() if k.startswith("strain_rate")])
    for ray, row in zip(found.rays, rates, strict=True):
        np.testing.assert_array_equal(row, found.strain_rate(ray))


def test_the_worst_residual_is_the_largest_of_all_directions():
    found = concio.strength(running(0.25, 0.125, 0.6, 5.0), DIRECTIONS[:2], coulomb=False, faces=False)
    first, second = found.rays
    wrong = replace(second, associated=replace(second.associated, residual=0.25))
    assert replace(found, rays=(first, wrong)).worst >= 0.25
    assert not replace(found, rays=(wrong, first)).checked
