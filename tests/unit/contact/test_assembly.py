"""From a model to its problem: load factors, imposed movements, errors of whole models."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import concio
from concio.analysis.lent_compliance import lent_assembly
from concio.analysis.parameters import parameters_of, stiffnesses_of
from concio.contact.assembly import assemble, assemble_beside
from concio.contact.detection import default_tolerance
from concio.contact.factors import load_factor
from concio.errors import GeometryError, InputError
from concio.model.model import Body, Load, Support
from models import box, model_of, on_ground, weight
from samples import first

STONE = {"kind": "rigid", "material": "stone"}


def two_groups():
    return on_ground(
        box("a", 0, 1, 0, 1, mesh_size=0.5), box("b", 0, 1, 1, 2, **STONE),
        loads=(weight(), Load("point", (5.0, 0.0), bodies=("b",), at=(0.0, 2.0), group="live")),
        supports=(Support("sink", "ground", displacement=(0.0, -0.01)),),
    )  # fmt: skip


def test_load_factors_scale_groups():
    assembly = assemble(two_groups())
    assert assembly.groups == ("dead", "live", "settlement")
    whole = assembly.problem()
    dead, live = assembly.problem({"live": 0.0}), assembly.problem({"dead": 0.0})
    np.testing.assert_allclose(dead.f + live.f, whole.f)
    np.testing.assert_allclose(assembly.problem({"dead": 2.0, "live": -3.0}).f, 2 * dead.f - 3 * live.f)
    half = assembly.problem({"settlement": 0.5})
    np.testing.assert_allclose(half.gap, whole.gap / 2)
    base = whole.gap > 1e-6
    np.testing.assert_allclose(whole.gap[base], 0.01)  # the ground sank away from the block
    assert base.sum() == 3
    with pytest.raises(InputError, match=r"no load group 'snow'.*dead, live, settlement"):
        assembly.problem({"snow": 1.0})


def test_problem_is_consistent():
    assembly = assemble(two_groups())
    p = assembly.problem()
    assert p.unknowns == 18 + 3
    assert p.bodies.tolist() == [0, 0, 18, 21]
    assert (p.K != p.K.T).nnz == 0
    assert abs(p.K @ p.R).max() < 1e-9 * abs(p.K).max()
    assert p.rigid_motions == 6
    assert p.slip_origin.shape == (p.pairs, 1)
    np.testing.assert_allclose(p.f[18:20], [5.0, -20.0])


def test_refused_models():
    with pytest.raises(InputError, match="nothing holds"):
        assemble(model_of(box("a", 0, 1, 0, 1)))
    with pytest.raises(InputError, match="every body is fixed"):
        assemble(model_of(box("a", 0, 1, 0, 1, kind="fixed")))
    with pytest.raises(InputError, match="no two bodies touch"):
        assemble(on_ground(box("a", 0, 1, 0.5, 1)))
    with pytest.raises(GeometryError, match=r"'a'.*'b'.*and 1 more"):
        assemble(on_ground(box("a", 0, 1, 0, 1), box("b", 0.9, 2, 0, 1), box("c", 1.9, 3, 0, 1)))


def test_tolerance_follows_the_size_and_not_the_place():
    model = on_ground(box("a", 0, 1, 0, 1))
    assert default_tolerance(model) == pytest.approx(1e-5)
    far = replace(model, bodies=tuple(replace(b, outline=b.outline + 1e4) for b in model.bodies))
    assert default_tolerance(far) == pytest.approx(1e-5)
    assert default_tolerance(replace(model, gap_tolerance=1e-3)) == 1e-3


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"outline": np.array([(0, 0), (1, 1), (3, 3.0)])}, "no area"),
        ({"outline": np.array([(0, 0), (1, 0)])}, "2 different vertices"),
        ({"outline": np.array([0, 1, 2.0])}, "shape"),
        ({"outline": np.array([(0, 0), (1, 0), (0, np.nan)])}, "not finite"),
        ({"thickness": 0.0}, "thickness"),
        ({"kind": "soft"}, "kind 'soft'"),
    ],
)
def test_refused_bodies(changes, message):
    with pytest.raises(InputError, match=rf"block 'b'.*{message}"):
        Body(**{"name": "b", "outline": np.array([(0, 0), (1, 0), (0, 1.0)]), **changes})


def test_outlines_are_kept_counter_clockwise_and_read_only():
    body = Body("b", np.array([(0, 0), (0, 2), (3, 2), (3, 0), (0, 0.0)]))
    assert len(body.outline) == 4
    assert body.area == pytest.approx(6.0)
    np.testing.assert_allclose(body.centroid, [1.5, 1.0])
    with pytest.raises(ValueError, match="read-only"):
        body.outline[0, 0] = 1.0


def test_names_and_materials_of_a_model():
    with pytest.raises(InputError, match="two bodies are called 'a'"):
        on_ground(box("a", 0, 1, 0, 1), box("a", 1, 2, 0, 1))
    with pytest.raises(InputError, match=r"material 'oak' is not defined.*block, stone"):
        on_ground(box("a", 0, 1, 0, 1, material="oak"))
    with pytest.raises(InputError, match="'rigid' has the material 'block'"):
        on_ground(box("a", 0, 1, 0, 1, kind="rigid"))
    with pytest.raises(InputError, match="'elastic' has the material 'stone'"):
        on_ground(box("a", 0, 1, 0, 1, material="stone"))
    with pytest.raises(InputError, match="no body called 'z'"):
        on_ground(box("a", 0, 1, 0, 1)).body("z")


def test_a_group_that_is_not_named_acts_as_described_and_a_strain_not_at_all() -> None:
    assert load_factor(None, "live") == load_factor({"dead": 3.0}, "live") == 1.0
    assert load_factor({"live": 0.5}, "live") == 0.5
    assert load_factor(None, "strain xy") == load_factor({"strain xx": 1e-3}, "strain xy") == 0.0


@pytest.mark.parametrize("name", ["arch", "blocks", "blocks_in_space", "arcade"])
def test_other_loads_on_the_same_structure_are_those_of_a_fresh_assembly(name: str) -> None:
    model = concio.load(Path(concio.__file__).parent / "model" / "templates" / f"{name}.toml")
    body = model.free_bodies[len(model.free_bodies) // 2]
    down = (0.0,) * (model.dim - 1) + (-3.0,)
    at = tuple(float(v) for v in body.centroid)
    loads = [*model.loads[:1], Load("point", down, bodies=(body.name,), at=at, group="moved")]
    shared = assemble(model).with_loads(loads)
    fresh = assemble(replace(model, loads=tuple(loads)))
    assert shared.model.loads == fresh.model.loads
    assert shared.groups == fresh.groups
    same_problems(shared.problem({"moved": 0.5}), fresh.problem({"moved": 0.5}))


def same_problems(one, other) -> None:
    for key in ("f", "load", "gap", "slip_origin", "area"):
        assert np.array_equal(getattr(one, key), getattr(other, key)), key
    for key in ("K", "C_n", "C_t", "inertia"):
        assert abs(getattr(one, key) - getattr(other, key)).max() == 0.0, key
    for key, value in vars(one.laws).items():
        if isinstance(value, np.ndarray):
            assert np.array_equal(value, getattr(other.laws, key)), key


@pytest.mark.parametrize("name", first(2, ["blocks", "blocks_in_space", "arch", "tower"]))
def test_a_model_beside_another_one_has_the_arrays_of_a_fresh_assembly(name: str) -> None:
    model = concio.load(Path(concio.__file__).parent / "model" / "templates" / f"{name}.toml")
    known, kinds = assemble(model), set()
    for p in (*parameters_of(model), *stiffnesses_of(model)):
        if p.kind not in kinds:
            kinds.add(p.kind)
            changed = p.change(1.1 * p.value)
            same_problems(assemble_beside(known, changed).problem(None), assemble(changed).problem(None))
    assert {"friction", "unit weight", "length"} <= kinds


def test_a_law_that_begins_to_crush_loses_its_points_without_area() -> None:
    """A square on its corner: with a compressive strength there is no joint, whatever was assembled before."""
    model = on_ground(concio.Body("a", [(0, 0), (1, 1), (0, 2), (-1, 1)], **STONE), box("b", 2, 3, 0, 1, **STONE))
    known = assemble(model)
    (name, law), *_ = model.laws.items()
    crushes = replace(model, laws={name: replace(law, compressive_strength=1e4)})
    assert 1 in known.pairs.body_b
    for found in (assemble(crushes), assemble_beside(known, crushes)):
        assert set(found.pairs.body_b.tolist()) == {2}


def test_a_compliance_that_was_chosen_for_loads_does_not_serve_for_others() -> None:
    lent = lent_assembly(concio.column(width=0.5, height=2.0, blocks=4, block="rigid", horizontal=0.1))
    assert lent.lent_compliance
    with pytest.raises(InputError, match="chosen for its loads"):
        lent.with_loads(lent.model.loads)
