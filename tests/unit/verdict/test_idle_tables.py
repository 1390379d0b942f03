"""Laws and materials that a file states and nothing uses are said: the answer is that of others."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import concio
from concio.errors import InputError
from concio.verdict.attention import attention_of


def said(text: str) -> list[str]:
    model = concio.loads(text)
    found = attention_of(model, concio.assemble(model).detection)
    return [sentence for sentence in found if "is stated, and no" in sentence]


@given(st.floats(0.1, 0.9), st.floats(15.0, 30.0), st.booleans(), st.booleans())
def test_a_law_or_material_beside_a_generator_is_used_or_said(
    friction: float, weight: float, ruled: bool, named: bool
) -> None:
    """A column with [joints.weak] of friction 0.2 was carried with the 0.6 of the generator, and nothing was said."""
    block = '"stone"' if named else '"rigid"'
    text = (
        f"[column]\nwidth = 1.0\nheight = 0.5\nblocks = 1\nblock = {block}\n[joints.weak]\nfriction = {friction!r}\n"
        f'[materials.stone]\nkind = "rigid"\nunit_weight = {weight!r}\n'
    )
    text += '[[rules]]\nlaw = "weak"\n' if ruled else ""
    model = concio.loads(text)
    used = {model.rule_between(*model.bodies).law: None}
    used_law, used_stone = model.laws[next(iter(used))], model.materials[model.free_bodies[0].material]
    found = said(text)
    assert any("joint law 'weak'" in s for s in found) == (used_law.friction != friction)
    assert any("material 'stone'" in s for s in found) == (used_stone.unit_weight != weight)


@pytest.mark.parametrize("order", [("tuff", "stone"), ("stone", "tuff")])
def test_solids_without_a_layer_are_of_no_material_where_there_are_several(
    order: tuple[str, str], tmp_path: Path
) -> None:
    """All of them were of the material that the file states first."""
    solids = [
        concio.Polyhedron.box(n, (2 * k, 0, 0), (2 * k + 1, 1, 1), kind="rigid") for k, n in enumerate(("one", "two"))
    ]
    drawn = concio.Model(tuple(solids), {"block": concio.Rigid()}, {"joint": concio.JointLaw(0.6)})
    concio.write_solids(tmp_path / "solids.obj", drawn)
    weights = {"tuff": 16.0, "stone": 25.0}
    tables = [f'[materials.{name}]\nkind = "rigid"\nunit_weight = {weights[name]}\n' for name in order]
    head, joint = 'solids_file = "solids.obj"\n', "[joints.dry]\nfriction = 0.6\n"

    def read(*parts: str) -> concio.Model:
        return concio.loads(head + "".join(parts) + joint, folder=tmp_path)

    for layers in ("", '[solids.layers]\none = "stone"\n'):
        with pytest.raises(InputError, match="there is no material for block"):
            read(layers, *tables)
    model = read('[solids.layers]\none = "stone"\ntwo = "tuff"\n', *tables)
    assert {b.name: model.materials[b.material].unit_weight for b in model.bodies} == {"one": 25.0, "two": 16.0}
    assert read(tables[0]).materials["block"].unit_weight == weights[order[0]]
