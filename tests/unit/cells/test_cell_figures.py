"""Figures of cells: that they draw what they say, on axes of their own or given ones."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

import concio
from concio.errors import InputError
from concio.plot.model_figure import plot_model

LAW = concio.JointLaw(0.65, cohesion=20.0, tensile_strength=10.0)
CELL = concio.cell(block="rigid", block_size=(0.4, 0.175), friction=LAW)


@pytest.fixture(scope="module")
def domain():
    return concio.strength(CELL, [(1, 0, 0), (0, 0, 1), (-1, -1, 0)], coulomb=False)


def test_a_cell_is_drawn_with_its_neighbours_in_grey():
    ax = plot_model(concio.cell(bond="flemish"))
    words = [t.get_text() for t in ax.get_legend().get_texts()]
    assert words == ["block", "neighbouring cells", "the cell"]
    grey = ax.collections[-1]
    assert len(grey.get_paths()) > 8
    ring = next(line for line in ax.lines if len(line.get_xdata()) == 5)
    assert np.ptp(ring.get_xydata(), axis=0) == pytest.approx([0.375, 0.25])


def test_sections_lie_on_the_boundary_of_the_domain(domain):
    ax = domain.plot.sections(others=(0.0, -50.0))
    assert ax.get_xlabel() == "stress yy [kN/m2]"
    drawn = [line.get_xydata() for line in ax.lines if len(line.get_xydata()) == 2 and line.get_color() == "#0072B2"]
    for ends in drawn:
        for yy, xy in ends:
            assert domain.faces.margin((0.0, yy, xy)) == pytest.approx(0.0, abs=1e-6)
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["stress xx = 0 kN/m2", "stress xx = -50 kN/m2"]
    with pytest.raises(InputError, match="no component"):
        domain.plot.sections(along="zz")


def test_strength_by_direction_is_that_of_the_half_spaces(domain):
    ax = domain.plot.uniaxial()
    tension = next(line for line in ax.lines if line.get_color() == "#D55E00")
    angle, value = tension.get_xdata(), tension.get_ydata()
    k = int(np.argmin(np.abs(angle - np.pi / 2)))
    assert value[k] == pytest.approx(domain.faces.distance((0, 1, 0)))
    assert value[0] == pytest.approx(domain.faces.distance((1, 0, 0)))


def test_all_figures_take_axes_and_return_them(domain):
    figure = Figure()
    ax = figure.add_subplot()
    assert domain.plot.sections(ax) is ax
    assert domain.plot.biaxial(figure.add_subplot()) is not None
    assert len(domain.plot.surface().collections) >= 4
    assert "Mechanism" in domain.plot.mechanism(1).get_title(loc="left")
    with pytest.raises(InputError, match="no mechanism"):
        domain.plot.mechanism(2)


def test_moduli_are_drawn_by_direction():
    moduli = concio.homogenise(concio.cell(joint=0.01, mortar=concio.Elastic(E=5e5, nu=0.2)))
    ax = moduli.plot.polar()
    young = ax.lines[0]
    assert young.get_ydata()[0] == pytest.approx(1e-6 * moduli.E_x)
    assert young.get_ydata()[45] == pytest.approx(1e-6 * moduli.E_y)


def test_a_path_and_its_states():
    path = concio.strain_path(concio.cell(block=concio.Elastic(1e7, 0.2)), [{"stress yy": -100.0}, {"strain xy": 3e-5}])
    ax = path.plot.curve()
    assert ax.get_xlabel() == "strain xy [-]"
    assert ax.lines[0].get_ydata().max() == pytest.approx(path.stress[:, 2].max())
    state = path.plot.state()
    assert "strain xy" in state.get_title(loc="left")
    result = path.result()
    assert result.plot.deformed() is not None
