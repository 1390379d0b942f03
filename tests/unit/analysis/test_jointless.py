"""Models in which no two bodies touch: supports or ties hold the blocks, and linear elasticity gives the answer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse.linalg as spla

import concio
from commands import run
from concio.errors import InputError
from concio.io import load_result, write_result
from concio.model.materials import Elastic
from concio.model.model import Load, Model, Support, Tie
from concio.plot.figures import suitable_figures
from concio.problem.solution import Status
from concio.solvers.methods import METHODS
from models import box, model_of, weight

LEFT, RIGHT, TOP, BASE = ((0, 0), (0, 0)), ((2, 0), (2, 0)), ((0, 1), (2, 1)), ((0, 0), (2, 0))
HINGE, ROLLER = Support("hinge", "block", LEFT), Support("roller", "block", RIGHT, "y")
PUSH = Load("point", (0.0, -6.0), bodies=("block",), at=(1.0, 1.0))
STONE = {"kind": "rigid", "material": "stone"}


def block(*loads: Load, stone: bool = False, **options: object) -> Model:
    """One block, 2 x 1 m."""
    return model_of(box("block", 0, 2, 0, 1, **(STONE if stone else {"mesh_size": 0.25})), loads=loads, **options)


def test_uniform_stress_is_exact() -> None:
    """Patch test: a block on rollers under uniform pressure shortens by q h / E and widens by nu q l / E."""
    E, nu, q = 1e4, 0.2, 50.0
    model = block(
        Load("pressure", (q,), edge=TOP),
        materials={"block": Elastic(E, nu, 0.0)},
        supports=(Support("base", "block", BASE, "y"), Support("pin", "block", LEFT, "x")),
    )
    result = concio.solve(model)
    assert len(result.assembly.pairs) == 0
    x, y = result.nodes("block").T
    exact = np.column_stack([nu * q / E * x, -q / E * y]).ravel()
    np.testing.assert_allclose(result.displacement, exact, atol=1e-10 * np.abs(exact).max())
    assert result.reactions["base"] == pytest.approx((0.0, 2.0 * q), abs=1e-9)
    assert result.certificate.worst <= 1e-10


def test_point_load_on_two_supports() -> None:
    """The answer is K u = f with the held nodes left out, and each support carries half."""
    result = concio.solve(block(PUSH, supports=(HINGE, ROLLER)))
    x, y = result.nodes("block").T
    at_left, at_right = (np.flatnonzero((x == end) & (y == 0.0))[0] for end in (0.0, 2.0))
    free = np.delete(np.arange(2 * len(x)), [2 * at_left, 2 * at_left + 1, 2 * at_right + 1])
    f = np.zeros(2 * len(x))
    f[2 * np.flatnonzero((x == 1.0) & (y == 1.0)) + 1] = -6.0
    u = np.zeros(2 * len(x))
    u[free] = spla.spsolve(result.assembly.K.tocsc()[free][:, free], f[free])
    np.testing.assert_allclose(result.displacement, u, atol=1e-10 * np.abs(u).max())
    assert result.reactions["hinge"] == pytest.approx((0.0, 3.0), abs=1e-9)
    assert result.reactions["roller"] == pytest.approx((0.0, 3.0), abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_gives_the_linear_answer(method: str) -> None:
    model = block(PUSH, weight(), supports=(HINGE, ROLLER))
    plain, named = concio.solve(model), concio.solve(model, method=method)
    assert named.status is Status.SOLVED
    np.testing.assert_array_equal(named.displacement, plain.displacement)


def test_a_settlement_of_a_statically_determinate_block_is_a_rigid_motion() -> None:
    result = concio.solve(block(supports=(HINGE, replace(ROLLER, displacement=(0.0, -0.02)))))
    x, y = result.nodes("block").T
    np.testing.assert_allclose(result.displacement, np.column_stack([0.01 * y, -0.01 * x]).ravel(), atol=1e-12)


@pytest.mark.parametrize("stone", [False, True])
def test_ties_hold_a_hanging_block(stone: bool) -> None:
    """Two vertical bars carry half the weight each; without one of them the block turns, and a mechanism proves it."""
    bars = tuple(Tie(f"bar {x}", "block", (x, 1.0), "", (x, 3.0), 1e4) for x in (0.0, 2.0))
    result = concio.solve(block(weight(), stone=stone, ties=bars))
    assert result.contacts.normal_force == pytest.approx([20.0, 20.0], rel=1e-9)
    fallen = concio.solve(block(weight(), stone=stone, ties=bars[:1]), on_failure="return")
    assert fallen.status is Status.NO_EQUILIBRIUM


@pytest.mark.parametrize("stone", [False, True])
def test_a_missing_roller_is_a_mechanism(stone: bool) -> None:
    result = concio.solve(block(weight(), stone=stone, supports=(HINGE,)), on_failure="return")
    assert result.status is Status.NO_EQUILIBRIUM
    assert result.mechanism is not None
    assert result.mechanism.power > 0
    assert set(suitable_figures(result)) == {"model", "mechanism"}


@pytest.mark.long
@pytest.mark.usefixtures("blank_figures")
@pytest.mark.parametrize("stone", [False, True])
def test_files_figures_and_tables(stone: bool, tmp_path: Path) -> None:
    result = concio.solve(block(PUSH, stone=stone, supports=(HINGE, ROLLER)))
    write_result(result, tmp_path / "out")
    again = load_result(tmp_path / "out")
    assert again.reactions == result.reactions
    assert (tmp_path / "out" / "report.html").exists()
    assert {len(column) for column in result.tables.contacts().values()} == {0}
    assert {len(column) for column in result.tables.joints().values()} == {0}
    for draw in suitable_figures(result).values():
        draw()


def test_what_nothing_holds_is_refused_still() -> None:
    ground = box("ground", 0, 2, -3, -2, kind="fixed")
    loose = box("block", 0, 2, 0, 1, mesh_size=0.5)
    sinks = Support("sinks", "ground", displacement=(0.0, -0.1))
    for model in (model_of(loose, ground, loads=(PUSH,)), model_of(loose, ground, loads=(PUSH,), supports=(sinks,))):
        with pytest.raises(InputError, match="no two bodies touch"):
            concio.solve(model)
    with pytest.raises(InputError, match="nothing holds the structure"):
        concio.solve(block(PUSH))
    between = Tie("between", "block", (0.0, 1.0), "other", (0.0, 2.0), 1e4)
    with pytest.raises(InputError, match="nothing holds the structure"):
        concio.solve(model_of(loose, box("other", 0, 2, 2, 3, **STONE), loads=(PUSH,), ties=(between,)))


def test_paths_limits_and_comparisons_say_that_there_is_nothing_to_follow(tmp_path: Path) -> None:
    model = block(replace(PUSH, group="live"), weight(), supports=(HINGE, ROLLER))
    for call in (concio.limit, concio.run_path, concio.load_margin, concio.friction_margin, concio.settle):
        with pytest.raises(InputError, match="no joint and no tie"):
            call(model)
    concio.save(model, tmp_path / "block.toml")
    for command in ("limit", "path", "compare"):
        code, _, err = run(command, tmp_path / "block.toml")
        assert code == 2, err
        assert "no joint and no tie" in err
    assert run("check", tmp_path / "block.toml")[0] == 0
    assert run("run", tmp_path / "block.toml")[0] == 0


def standing(*supports: Support, kind: str = "elastic") -> Model:
    """One box of 2 x 1 x 3 m under its weight and a push, in space."""
    material = {"kind": "rigid", "material": "stone"} if kind == "rigid" else {"mesh_size": 1.0}
    return Model(
        (concio.Polyhedron.box("block", (0, 0, 0), (2, 1, 3), **material),),
        {"block": Elastic(1e5, 0.2, 20.0), "stone": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.5)},
        supports=supports, loads=(Load("weight", (0.1, 0.0, -1.0)),),
    )  # fmt: skip


FLOOR = ((0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0))


@pytest.mark.parametrize("kind", ["elastic", "rigid"])
def test_a_block_in_space_held_by_its_support(kind: str) -> None:
    result = concio.solve(standing(Support("base", "block", polygon=FLOOR), kind=kind))
    assert result.solved
    assert result.reactions["base"] == pytest.approx([-12.0, 0.0, 120.0], abs=1e-9)


@pytest.mark.parametrize("kind", ["elastic", "rigid"])
def test_a_block_in_space_that_nothing_holds(kind: str) -> None:
    """Rollers below let it slide away: proven by a motion."""
    model = standing(Support("base", "block", polygon=FLOOR, directions="z"), kind=kind)
    result = concio.solve(model, on_failure="return")
    assert result.status is Status.NO_EQUILIBRIUM
    assert result.mechanism is not None
    with pytest.raises(concio.NoEquilibriumError):
        concio.solve(model)
