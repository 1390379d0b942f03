"""From the tables of a model file to a :class:`concio.model.model.Model`.

A model is the sum of its parts: at most one generator, the blocks of ``blocks_file`` and those of ``[[blocks]]``, with
the materials, joints, rules, supports, loads and ties of the file on top of what the generator gave.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from concio.arguments import closest
from concio.display import Units
from concio.errors import InputError
from concio.model.file.acting_tables import (
    AnalysisTable,
    LoadTable,
    StageTable,
    SupportTable,
    TemperatureTable,
    TieTable,
)
from concio.model.file.analysis_keys import check_dimension, thickness_of_all
from concio.model.file.block_table import read_blocks
from concio.model.file.bodies import Materials, body_of, rigid_where_its_material_is
from concio.model.file.bridge_drawing_table import drawn_barrel, with_drawn_road
from concio.model.file.file_errors import placed
from concio.model.file.file_table import FileTable
from concio.model.file.parts_table import assembled_parts
from concio.model.file.road_tables import crossed
from concio.model.file.tables import CourseTable, JointTable, MaterialTable, Table
from concio.model.generate.bonds import Course
from concio.model.generate.generators import GENERATORS
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Body, JointRule, Load, Model, Support, Temperature, Tie, check_rules
from concio.model.polyhedron import Polyhedron
from concio.model.stages import ControlPoint, Stage

Laws = dict[str, JointLaw]
NO_BLOCKS = "the file describes no blocks"
"""What is said of a file that is sound so far, and has no blocks yet."""


def build(
    data: FileTable, folder: Path, where: str, read: Callable[[str], Model], thickness: float | None = None
) -> Model:
    """Return the model that the tables of a file describe, in kN and m.

    Parameters
    ----------
    data : FileTable
    folder : Path
        ``blocks_file`` is relative to it.
    where : str
        Name of the file, for messages.
    read : function
        Returns the model of another file, which a part names.
    thickness : float or None
        Of bodies that state none [m]: that of the file, or else of the file of which it is a part; None is 1 m.

    Raises
    ------
    InputError
        The parts of the file do not fit together; the message says where.
    """
    stated = data.analysis
    if thickness is not None:
        data = data.model_copy(update={"analysis": stated.model_copy(update={"thickness": thickness})})
    with placed(where):
        materials = {name: _material(table, f"[materials.{name}]") for name, table in data.materials.items()}
        laws = {name: _law(table, f"[joints.{name}]") for name, table in data.joints.items()}
        start = _start(data, materials, laws, folder, read)
        bodies = [*(start.bodies if start else ()), *_blocks_of_file(data, materials, folder)]
        bodies += [body_of(b, k, materials, data.analysis.thickness) for k, b in enumerate(data.blocks, 1)]
        if not bodies:
            msg = NO_BLOCKS
            hint = "add [[blocks]], blocks_file = ..., or one of " + ", ".join(f"[{name}]" for name in GENERATORS)
            raise InputError(msg, hint=hint)
        parts = _parts(data, bodies, start, materials, laws)
        model = replace(start, **parts) if start else Model(**parts)
    with placed(where):
        model = crossed(model, with_drawn_road(data.fill, data.bridge_drawing, folder), data.vehicle)
        _check_names(model)
        check_dimension(stated, model.dim, extruded=data.extrusion is not None)
        if data.extrusion is not None:
            from concio.model.generate.extrusion import extrude

            with placed("[extrusion]", own="extrude"):
                model = extrude(model, data.extrusion.thickness, held=data.extrusion.held)
    return model


def _parts(
    data: FileTable, bodies: list[Body | Polyhedron], start: Model | None, materials: Materials, laws: Laws
) -> dict[str, Any]:
    """Return the fields of the model; analysis keys count only where the file states them."""
    analysis = data.analysis
    chosen = {k: getattr(analysis, k) for k in analysis.model_fields_set if k != "thickness"}
    if analysis.refinement < 1:
        msg = f"refinement = {analysis.refinement} must be at least 1"
        raise InputError(msg, where="[analysis]")
    for key in ("mesh_size", "gap_tolerance", "gap_reach"):
        value = getattr(analysis, key)
        if value is not None and (value < 0 or (value == 0 and key == "mesh_size")):
            msg = f"{key} = {value:g} m must be {'positive' if key == 'mesh_size' else 'zero or positive'}"
            raise InputError(msg, where="[analysis]")
    for k, load in enumerate(map(_load, data.loads), 1):
        if start and load.kind == "weight" and load in start.loads:
            brought = "the drawing" if data.blocks_file else "the table that makes the structure"
            msg = f"the weight would count twice: {brought} brings it already, in load group '{load.group}'"
            raise InputError(msg, where=f"[[loads]] {k}", hint="leave this load out, or give it a group of its own")
    base = start.laws if start else {}
    every = {**base, **laws}
    rules = _rules(data, list(start.rules) if start else [], every, bodies)
    given: dict[str, Any] = {
        "bodies": tuple(bodies),
        "materials": {**(start.materials if start else {}), **materials},
        "laws": every,
        "rules": tuple(rules),
        "supports": (*(start.supports if start else ()), *(_support(t, k) for k, t in enumerate(data.supports, 1))),
        "loads": (*(start.loads if start else ()), *(_load(t) for t in data.loads)),
        "temperatures": (*(start.temperatures if start else ()), *(_temperature(t) for t in data.temperatures)),
        "ties": (*(start.ties if start else ()), *(_tie(t) for t in data.ties)),
        "stages": (*(start.stages if start else ()), *(_stage(t, k) for k, t in enumerate(data.stages, 1))),
        **chosen,
    }
    if data.periods is not None:
        given["periods"] = data.periods
    if data.report is not None:
        given["report"] = Units(**data.report.model_dump())
    if data.solver is not None:
        given["engine"] = data.solver.engine
    if data.title or not start:
        given["title"] = data.title
    if data.record or not start:
        given["generator"] = data.record
    return given


def _rules(
    data: FileTable, before: list[JointRule], laws: Laws, bodies: Sequence[Body | Polyhedron]
) -> list[JointRule]:
    found = list(before)
    if data.rules is None and not before:
        if len(laws) != 1:
            msg = "there are no joint laws" if not laws else f"there are {len(laws)} joint laws and no [[rules]]"
            raise InputError(msg, hint="add [joints.joint] with friction = ..., and [[rules]] where there are several")
        return [JointRule(next(iter(laws)))]
    for k, table in enumerate(data.rules or (), 1):
        with placed(f"[[rules]] {k}"):
            if table.law not in laws:
                msg = f"joint law '{table.law}' is not defined"
                raise InputError(msg, hint=closest(table.law, list(laws)) if laws else "add [joints.NAME]")
            found.append(JointRule(table.law, table.between, table.gap))
            check_rules(found[-1:], bodies)
    return found


def _start(
    data: FileTable, materials: Materials, laws: Laws, folder: Path, read: Callable[[str], Model]
) -> Model | None:
    """Return the model of the generator, of the parts or of the drawing, None where there is none of them."""
    named = [name for name in GENERATORS if getattr(data, name, None) is not None]
    drawing = data.blocks_file is not None and data.blocks_file.lower().endswith(".dxf")
    parts = getattr(data, "parts", [])
    solids = getattr(data, "solids_file", None) is not None
    if len(named) + drawing + bool(parts) + solids > 1:
        words = [f"[{n}]" for n in named] + ["a drawing"] * drawing + ["[[parts]]"] * bool(parts)
        words += ["solids_file"] * solids
        msg = "more than one of " + ", ".join(words)
        raise InputError(msg, hint="one file describes one structure; several generators go into [[parts]]")
    if data.drawing is not None and not drawing:
        msg = "[drawing] is given, but blocks_file is not a .dxf file"
        raise InputError(msg, hint="add blocks_file = 'wall.dxf' at the top, or leave [drawing] out")
    if data.solids is not None and not solids:
        msg = "[solids] is given, but solids_file is not"
        raise InputError(msg, hint="add solids_file = 'vault.obj' at the top, or leave [solids] out")
    if solids:
        return _from_solids(data, materials, laws, folder)
    if drawing:
        return _from_drawing(data, materials, laws, folder)
    if parts:
        return assembled_parts(parts, lambda part, label: _generated(part, data.analysis, materials, laws), read,
                               data.title, ruled=data.rules is not None)  # fmt: skip
    lines = drawn_barrel(data.bridge_drawing, getattr(data, "bridge", None), folder)
    return _generated(data, data.analysis, materials, laws, lines)


LAWS_OF_GENERATORS = {
    "joint": "friction", "ring joint": "ring_friction", "head": "head", "base": "base_friction",
    "side wall": "wall_friction",
}  # fmt: skip
"""Names of joint laws that generators make, and the key of their table that states each."""


def _generated(
    data: Any, analysis: AnalysisTable, materials: Materials, laws: Laws, lines: Mapping[str, Any] | None = None
) -> Model | None:
    """Return the model of the generator whose table is given, None where there is none; ``lines`` are of a survey."""
    name = next((name for name in GENERATORS if getattr(data, name, None) is not None), None)
    if name is None:
        return None
    table = getattr(data, name)
    arguments = {key: _argument(getattr(table, key), name, key, materials, laws) for key in table.model_fields_set}
    arguments |= {**(lines or {}), **thickness_of_all(analysis, name, table)}
    own = "wall" if name == "wall_of_courses" else name
    with placed(f"[{name}]", own=own):
        model = GENERATORS[name](**arguments)
    for word in materials:
        if word in model.materials and word in ("block", "mortar"):
            msg = f"'{word}' is the name of the material of [{name}] itself"
            raise InputError(msg, where=f"[materials.{word}]", hint=f"write [{name}.{word}], or choose another name")
    for word, key in LAWS_OF_GENERATORS.items():
        if word in laws and key in table.model_fields_set and model.laws.get(word, laws[word]) != laws[word]:
            msg = f"{key} of [{name}] and [joints.{word}] are both stated, and they differ"
            raise InputError(msg, where=f"[joints.{word}]", hint=f"leave one of them out, or write {key} = '{word}'")
    return model


def _argument(value: Any, table: str, key: str, materials: Materials, laws: Laws) -> Any:
    """Return a value of a generator's table as its function takes it."""
    if isinstance(value, MaterialTable):
        return _material(value, f"[{table}.{key}]")
    if isinstance(value, JointTable):
        return _law(value, f"[{table}.{key}]")
    if isinstance(value, CourseTable):
        return Course(tuple(value.unit), tuple(value.left), tuple(value.right), value.height)
    if isinstance(value, Table):
        return {name: _argument(getattr(value, name), table, "", materials, laws) for name in value.model_fields_set}
    if isinstance(value, list):
        return [_argument(v, table, "", materials, laws) for v in value]
    if isinstance(value, str) and key in ("block", "mortar", "lintel"):
        if value in ("elastic", "rigid") and key == "block" and value not in materials:
            return value
        return _named(value, f"[{table}], {key}", materials, "material")
    if isinstance(value, str) and key in ("friction", "head"):
        return _named(value, f"[{table}], {key}", laws, "joint law")
    return value


def _named(word: str, place: str, table: Mapping[str, Any], what: str) -> Any:
    if word not in table:
        msg = f"{what} '{word}' is not defined"
        new = f"give a number, or define [joints.{word}]" if what == "joint law" else f"define [materials.{word}]"
        raise InputError(msg, where=place, hint=closest(word, list(table)) if table else new)
    return table[word]


def _from_solids(data: FileTable, materials: Materials, laws: Laws, folder: Path) -> Model:
    from concio.model.solids.importing import model_from_solids

    table = data.solids
    options: dict[str, Any] = {} if table is None else {key: getattr(table, key) for key in table.model_fields_set}
    if materials:
        options["block"] = materials.get("block", next(iter(materials.values())))
    if laws:
        options["friction"] = next(iter(laws.values()))
    others = {name: material for name, material in materials.items() if name != "block"}
    model = model_from_solids(folder / str(data.solids_file), materials=others, **options)
    lost = [b.name for b in model.free_bodies if b.material == "block"]
    if lost and "block" not in materials and len(materials) > 1:
        more = f" and {len(lost) - 1} more" if len(lost) > 1 else ""
        msg = f"there is no material for block '{lost[0]}'{more}: {len(materials)} are defined, and no layer says which"
        hint = "give its layer or its name one in [solids.layers], or add [materials.block] for all other blocks"
        raise InputError(msg, hint=hint)
    return replace(model, laws={}, rules=()) if laws else model


def _from_drawing(data: FileTable, materials: Materials, laws: Laws, folder: Path) -> Model:
    from concio.model.drawing.drawing import model_from_dxf

    table = data.drawing
    options: dict[str, Any] = {"thickness": data.analysis.thickness}
    if table is not None:
        options |= {key: getattr(table, key) for key in table.model_fields_set - {"layers"}}
        options["layers"] = {
            layer: meaning.model_dump(exclude_none=True) if isinstance(meaning, Table) else meaning
            for layer, meaning in table.layers.items()
        }
    if materials:  # the drawing's own default is never meant; blocks that would take it are named below
        options["block"] = materials.get("block", next(iter(materials.values())))
    if laws:
        options["friction"] = next(iter(laws.values()))
    model = model_from_dxf(folder / str(data.blocks_file), materials=materials, **options)
    lost = dict.fromkeys(b.layer for b in model.free_bodies if b.material == "block" and "block" not in materials)
    if lost:
        names = ", ".join(f"'{layer}'" for layer in lost)
        msg = f"there is no material for blocks on layer {names}"
        layer = next(iter(lost))
        hint = f"write {layer} = 'A MATERIAL' in [drawing.layers], or add [materials.block] for all other layers"
        raise InputError(msg, hint=hint)
    used = {b.material for b in model.free_bodies}
    model = replace(model, materials={name: m for name, m in model.materials.items() if name in used})
    return replace(model, laws={}, rules=()) if laws else model


def _blocks_of_file(data: FileTable, materials: Materials, folder: Path) -> list[Body | Polyhedron]:
    if data.blocks_file is None or data.blocks_file.lower().endswith(".dxf"):
        return []
    bodies = read_blocks(folder / data.blocks_file, data.analysis.thickness, data.units.length)
    return [rigid_where_its_material_is(b, materials) for b in bodies]


def _material(table: MaterialTable, place: str) -> Elastic | Rigid:
    with placed(place):
        if table.kind == "rigid":
            if table.E is not None or table.nu is not None:
                msg = "a rigid material has no E and no nu"
                raise InputError(msg, hint="leave them out, or set kind = 'elastic'")
            return Rigid(table.unit_weight, table.expansion)
        if table.E is None:
            msg = "'E' is missing"
            raise InputError(msg, hint="give Young's modulus, or set kind = 'rigid'")
        given = {} if table.nu is None else {"nu": table.nu}
        return Elastic(table.E, unit_weight=table.unit_weight, expansion=table.expansion, **given)


def _law(table: JointTable, place: str) -> JointLaw:
    with placed(place):
        return JointLaw(**table.model_dump())


def _support(table: SupportTable, number: int) -> Support:
    if sum(v is not None for v in (table.edge, table.at, table.polygon)) > 1:
        msg = "edge and at are given together" if table.polygon is None else "two of edge, polygon and at are given"
        raise InputError(msg, where=f"[[supports]] {number} '{table.name}'", hint="a support holds an edge or a point")
    edge = table.edge if table.at is None else (table.at, table.at)
    region = None if table.polygon is None else tuple(table.polygon)
    return Support(
        table.name, table.body, edge, table.directions, table.displacement or (), table.rotation, table.group, region
    )  # fmt: skip


def _load(table: LoadTable) -> Load:
    region = None if table.polygon is None else tuple(table.polygon)
    return Load(table.kind, table.value, tuple(table.bodies), table.edge, table.at, table.group, table.face, region)


def _temperature(table: TemperatureTable) -> Temperature:
    return Temperature(**{**table.model_dump(), "bodies": tuple(table.bodies)})


def _tie(table: TieTable) -> Tie:
    return Tie(**table.model_dump())


def _stage(table: StageTable, number: int) -> Stage:
    if (table.control is None) != (table.until == 0):
        msg = "until is the motion of a control point, and one of the two is missing"
        hint = "give both control = { body = ..., at = [x, y] } and until, or neither"
        raise InputError(msg, where=f"[[stages]] {number} '{table.name}'", hint=hint)
    point = table.control
    control = None if point is None else ControlPoint(point.body, point.at, point.direction)
    return Stage(table.name, table.factors, control, table.until, table.steps)


def _check_names(model: Model) -> None:
    """Raise where a support, load or tie names a body that does not exist."""
    names = {b.name for b in model.bodies}
    sorts = {word for b in model.bodies for word in (b.name, b.role, b.layer) if word}
    used = [(f"[[supports]] '{s.name}'", s.body, names) for s in model.supports]
    used += [(f"[[ties]] '{t.name}'", w, names) for t in model.ties for w in (t.body_a, t.body_b) if w]
    used += [(f"[[stages]] '{s.name}'", s.control.body, names) for s in model.stages if s.control]
    used += [(f"[[loads]] of kind {load.kind}", w, sorts) for load in model.loads for w in load.bodies]
    used += [("[[temperatures]]", w, sorts) for change in model.temperatures for w in change.bodies]
    for place, word, known in used:
        if word not in known and not ("*" in word and any(fnmatchcase(name, word) for name in names)):
            msg = f"there is no body called '{word}'"
            hint = closest(word, sorted(known))
            if len(known) > 30 and not hint.startswith("did"):
                hint = "see the names with 'concio check'"
            raise InputError(msg, where=place, hint=hint)
