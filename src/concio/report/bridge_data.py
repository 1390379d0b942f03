"""The data of a bridge as the report tells them: masonry, fill, road and vehicle, each with its source."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from concio.model.crossing import STRETCH, Vehicle
from concio.model.fill import Fill
from concio.model.materials import Elastic, JointLaw
from concio.model.road.spread import spread_rule
from concio.verdict.bridge_verdict import loaded_words

if TYPE_CHECKING:
    from concio.report.bridge_page import BridgeReport


def data_rows(page: BridgeReport) -> list[tuple[str, str]]:
    """Return name and value of every datum that the answer rests on."""
    model, fill = page.found.model, page.found.model.fill
    assert fill is not None
    rows = [*_masonry(page), *_fill(page, fill), *_vehicle(page, page.found.vehicle)]
    named = [(page.words[key], text) for key, text in rows]
    used = dict.fromkeys(rule.law for rule in model.rules)
    return [*named, *(row for name in used for row in _law(page, name, model.laws[name]))]


def _masonry(page: BridgeReport) -> list[tuple[str, str]]:
    """Return the rows of spans, rings, piers, width and materials."""
    model = page.found.model
    made: Mapping[str, Any] = model.generator
    given: Mapping[str, Any] = made.get("arguments") or {}
    spans: Sequence[float] = given.get("span") or made.get("spans") or ()
    rows = [("spans", _lengths(page, spans))] if spans else []
    if given:
        rows.append(("shape", page.words.get("shape_" + given["shape"].replace("-", "_"), given["shape"])))
        if any(r is not None for r in given["rise"]):
            rows.append(("rise", _lengths(page, given["rise"])))
        rows.append(("ring", _lengths(page, given["ring"], " + ")))
        if given["springing_ring"] != given["ring"]:
            rows.append(("springing_ring", _lengths(page, given["springing_ring"], " + ")))
        rows.append(("voussoirs", ", ".join(str(n) for n in given["voussoirs"])))
        if given["headers"]:
            rows.append(("headers", page.say("every", n=str(given["headers"]))))
        if given["pier_width"]:
            height = page.unit("length", given["pier_height"]) if given["pier_height"] else page.words["piers_fixed"]
            rows.append(("piers", f"{_lengths(page, given['pier_width'])}; {height}"))
        rows.append(("backing", page.unit("length", given["backing"]) if given["backing"] else page.words["nothing"]))
    elif isinstance(drawn := model.generator.get("drawn"), Mapping):
        rows.append(("ring_drawn", page.unit("length", drawn["ring"])))
        rows.append(("voussoirs", str(drawn["voussoirs"])))
        rows.append(("backing", page.unit("length", drawn["backing"]) if drawn["backing"] else page.words["nothing"]))
    else:
        rows.append(("blocks", str(len(model.free_bodies))))
    for name in dict.fromkeys(b.material for b in model.free_bodies):
        material = model.materials[name]
        told = page.words["rigid_blocks"]
        if isinstance(material, Elastic):
            told = f"E = {page.unit('modulus', material.E)}, nu = {page.n(material.nu)}"
        rows.append(("masonry", f"{told}, {_weight(page, material.unit_weight)}"))
    return rows


def _fill(page: BridgeReport, fill: Fill) -> list[tuple[str, str]]:
    """Return the rows of road and fill."""
    rows = []
    if fill.cover is not None:
        rows += [("cover", page.unit("length", fill.cover)), ("gradient", page.n(fill.gradient))]
    else:
        rows.append(("road", page.say("road_given", n=str(len(fill.road)))))
    if fill.layers:
        rows.append(("layers", "; ".join(
            page.say("layer", name=x.name, depth=page.unit("length", x.depth), weight=_weight(page, x.unit_weight))
            for x in fill.layers)))  # fmt: skip
    if fill.fill_line:
        line = page.say("road_given", n=str(len(fill.fill_line)))
        rows.append(("fill_line", f"{line}, {_weight(page, fill.surfacing_weight)}"))
    if fill.spandrels:
        walls = [page.unit("length", fill.spandrels), page.unit("length", fill.parapet)]
        rows.append(("spandrels", "; ".join([*walls, _weight(page, fill.spandrel_weight)])))
    rows.append(("fill_weight", _weight(page, fill.unit_weight)))
    if fill.friction_angle is not None:
        rows.append(("friction_angle", f"{page.n(fill.friction_angle)}\N{DEGREE SIGN}"))
        if fill.passive is None:
            rows.append(("mobilised", page.n(fill.mobilised)))
    if fill.cohesion:
        rows.append(("cohesion", page.unit("stress", fill.cohesion)))
    rule = spread_rule(fill.spread)
    rows += [
        ("passive", page.n(fill.passive_coefficient)),
        ("pressure", page.words["pressure_" + fill.pressure.replace(" ", "_")]),
        ("stiffness", page.unit("joint stiffness", fill.stiffness)),
        ("spread", f"{rule.name}: {page.told(rule.source)}" if rule.source else rule.name),
    ]
    return rows


def _vehicle(page: BridgeReport, vehicle: Vehicle) -> list[tuple[str, str]]:
    """Return the rows of the vehicle."""
    told = []
    for a in vehicle.axles:
        at, length = page.unit("length", a.at), page.unit("length", a.length or 0.0)
        if a.length is not None and a.length >= STRETCH:
            told.append(page.say("stretch", load=page.unit("line load", a.load / a.length), at=at, length=length))
        else:
            told.append(page.say("axle_at", load=page.unit("force", a.load), at=at))
    rows = [("vehicle", vehicle.name), ("axles", "; ".join(told))]
    if vehicle.loaded is not None and vehicle.uniform:
        rows.append(("loaded", loaded_words(vehicle.loaded, page.said)))
    rows += [(key, page.told(getattr(vehicle, key))) for key in ("source", "assumed") if getattr(vehicle, key)]
    return [*rows, ("dynamic", f"{page.n(vehicle.dynamic)}; {page.n(vehicle.factor)}")]


def _law(page: BridgeReport, name: str, law: JointLaw) -> list[tuple[str, str]]:
    """Return the rows of a joint law."""
    strength = law.compressive_strength
    told = page.words["unlimited"] if strength is None else page.unit("stress", strength)
    rows = [(page.say("friction", name=name), page.n(law.friction)), (page.say("strength", name=name), told)]
    for key in ("cohesion", "tensile_strength"):
        value = getattr(law, key)
        if value:
            rows.append((page.say("joint_" + key, name=name), page.unit("stress", value)))
    for key in ("normal_stiffness", "tangential_stiffness"):
        value = getattr(law, key)
        if value is not None:
            rows.append((page.say("joint_" + key, name=name), page.unit("joint stiffness", value)))
    return rows


def _lengths(page: BridgeReport, values: Sequence[float | None], between: str = "; ") -> str:
    return between.join(page.unit("length", v) for v in values if v is not None)


def _weight(page: BridgeReport, value: float) -> str:
    return page.unit("unit weight", value)
