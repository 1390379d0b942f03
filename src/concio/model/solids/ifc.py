"""IFC (IFC2x3 to IFC4x3, STEP physical file): each product that has a body is a block, or several.

Its name is the product's, its layer the name of its material; ``layers`` of an import also chooses by class
(``IfcWall``), storey or assembly, type and presentation layer. What cannot be read is reported with its instance, and
can be left out by name as everything else.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from concio.errors import InputError
from concio.model.solids.ifc_geometry import TESSELLATE, Bodies, Surface, moved
from concio.model.solids.ifc_placement import Placements, metres_of, world_left_out
from concio.model.solids.shapes import FIXED, Scene, Shape, check_size
from concio.model.solids.step_file import Instance, Reference, StepFile

NO_BLOCKS = {
    "IFCOPENINGELEMENT", "IFCOPENINGSTANDARDCASE", "IFCSPACE", "IFCSPATIALZONE", "IFCEXTERNALSPATIALELEMENT", "IFCGRID",
    "IFCANNOTATION", "IFCVIRTUALELEMENT", "IFCSITE", "IFCBUILDING", "IFCBUILDINGSTOREY", "IFCPORT", "IFCREFERENT",
    "IFCVOIDINGFEATURE", "IFCEARTHWORKSCUT", "IFCPROJECTIONELEMENT", "IFCSURFACEFEATURE",
}  # fmt: skip
"""Classes of products that are not bodies of their own."""
FEATURES = {"IFCRELVOIDSELEMENT": ("an opening", "cut out"), "IFCRELPROJECTSELEMENT": ("a projection", "joined to it")}
"""Relations to what is cut out of a body or joined to it: what it is, and what is not done."""
NAMES = (
    "IfcBeam", "IfcBuildingElement", "IfcBuildingElementPart", "IfcBuildingElementProxy", "IfcColumn", "IfcCovering",
    "IfcDiscreteAccessory", "IfcDoor", "IfcElementAssembly", "IfcFooting", "IfcFurnishingElement", "IfcFurniture",
    "IfcGeographicElement", "IfcMember", "IfcPlate", "IfcRailing", "IfcRoof", "IfcSlab", "IfcStair", "IfcStairFlight",
    "IfcWall", "IfcWallStandardCase", "IfcWindow",
)  # fmt: skip
"""How common classes are written by their standard; a file has capital letters only."""
_WRITTEN = {name.upper(): name for name in NAMES}


def read_ifc(path: Path) -> Scene:
    """Return the bodies of the products of an IFC file.

    Raises
    ------
    InputError
        The file is missing, cut off, no IFC, or its products cannot be identified; the message names the instance.
    """
    try:
        file = StepFile(path)
        if not file.schema.startswith("IFC"):
            msg = f"the schema of the file is '{file.schema[:40]}', not IFC"
            raise InputError(msg, hint="export the model as IFC")
        return _scene(file)
    except InputError as error:
        raise InputError(error.what, where=str(path), hint=error.hint) from None


def _scene(file: StepFile) -> Scene:
    words, bodies, placements = _Words(file), Bodies(), Placements()
    metres = metres_of(file)
    features = {r.value(4): (*FEATURES[r.kind], r.value(5)) for r in file.of_kind(*FEATURES)}
    shapes: list[Shape] = []
    left_out = world_left_out(file)
    total = 0
    for number in file.roots():
        kind = file.kind(number)
        if kind.startswith(("IFCREL", "IFCPROPERTY", "IFCELEMENTQUANTITY")) or kind in NO_BLOCKS:
            continue
        product = file[number]
        shape = product.value(6)
        if not isinstance(shape, Reference) or shape not in file or file.kind(shape) != "IFCPRODUCTDEFINITIONSHAPE":
            continue
        name = product.text(2) or product.text(7) or f"#{number}"
        layer, tags, fixed = words.of(product)
        source = f"#{number} {_WRITTEN.get(kind, kind)}"
        unreadable: tuple[str, str] | None = None
        surfaces: list[Surface] = []
        try:
            items = _body(file[shape])
            if items is None:
                left_out.append(f"'{name}' ({source}) has no body")
                continue
            for host in words.hosts(product):
                if host.number in features:
                    whole = "" if host is product else f"is part of {host.label}, which "
                    word, done, number = features[host.number]
                    hint = f"{TESSELLATE}, openings cut and projections joined, or model the blocks round the opening"
                    product.refuse(f"{whole}has {word}, #{number}, which is not {done}", hint)
            matrix = placements.matrix(product.open_instance(5))
            surfaces = [moved(s, matrix) for item in items for s in bodies.surfaces(item)]
        except InputError as error:
            unreadable = (error.what, error.hint or "")
            surfaces = [(np.zeros((0, 3)), ())]
        shapes += [Shape(name, layer, p, f, fixed, tuple(tags), source, unreadable) for p, f in surfaces]
        total += sum(len(p) for p, _ in surfaces)
        check_size(total, file.where)
    return Scene(tuple(shapes), metres, tuple(left_out))


def _body(shape: Instance) -> list[Instance] | None:
    """Return the items of the body of a product, None where it has none."""
    found, bodies = None, []
    for representation in shape.instances(2):
        if representation.kind != "IFCSHAPEREPRESENTATION":
            continue
        own, sort = representation.text(1), representation.text(2)
        solid = sort in ("Brep", "SweptSolid", "Tessellation", "SurfaceModel", "MappedRepresentation", "AdvancedBrep",
                         "Clipping", "CSG", "SolidModel", "AdvancedSweptSolid")  # fmt: skip
        bodies += [f"#{representation.number}"] if own == "Body" else []
        if len(bodies) > 1:
            shape.refuse(f"has more than one body: {', '.join(bodies)}", "export one representation of the body")
        if own == "Body" or (found is None and own in ("", "Facetation", "Mesh") and solid):
            found = representation.instances(3)
    return found


class _Words:
    """What chooses a product beside its name: material, class, type, storey, assembly and presentation layer."""

    def __init__(self, file: StepFile) -> None:
        self.file = file
        self.material: dict[int, Instance] = {}
        self.type: dict[int, Instance] = {}
        self.parent: dict[int, Instance] = {}
        self.presented: dict[int, str] = {}
        for relation in file.of_kind("IFCRELASSOCIATESMATERIAL"):
            self.material |= dict.fromkeys(_numbers(relation, 4), relation.instance(5))
        for relation in file.of_kind("IFCRELDEFINESBYTYPE"):
            self.type |= dict.fromkeys(_numbers(relation, 4), relation.instance(5))
        for relation in file.of_kind("IFCRELCONTAINEDINSPATIALSTRUCTURE"):
            self.parent |= dict.fromkeys(_numbers(relation, 4), relation.instance(5))
        for relation in file.of_kind("IFCRELAGGREGATES"):
            self.parent |= dict.fromkeys(_numbers(relation, 5), relation.instance(4))
        for layer in file.of_kind("IFCPRESENTATIONLAYERASSIGNMENT", "IFCPRESENTATIONLAYERWITHSTYLE"):
            self.presented |= dict.fromkeys(_numbers(layer, 2), layer.text(0))

    def of(self, product: Instance) -> tuple[str, list[str], bool]:
        """Return the material's name, all other words, and whether a word of its own says that it is fixed."""
        own = self.type.get(product.number)
        material = self.material.get(product.number) or (self.material.get(own.number) if own else None)
        layers = list(dict.fromkeys(self._layers(product)))
        kind = product.text(4)
        tags = [_WRITTEN.get(product.kind, product.kind), *layers, kind, own.text(2) if own else ""]
        tags += [at.text(2) for at in self.hosts(product)[1:] if at.kind != "IFCPROJECT"]
        fixed = any(word.lower() in FIXED for word in (*layers, kind))
        return _material(material), [tag for tag in dict.fromkeys(tags) if tag], fixed

    def hosts(self, product: Instance) -> list[Instance]:
        """Return a product and what it is part of, one after the other: an assembly, a storey, a building."""
        found, seen = [product], {product.number}
        while found[-1].number in self.parent and self.parent[found[-1].number].number not in seen:
            found.append(self.parent[found[-1].number])
            seen.add(found[-1].number)
        return found

    def _layers(self, product: Instance) -> Iterator[str]:
        for representation in product.instance(6).instances(2):
            items = representation.value(3)
            for number in (representation.number, *(items if isinstance(items, tuple) else ())):
                if number in self.presented:
                    yield self.presented[number]


def _numbers(relation: Instance, place: int) -> list[int]:
    return [int(v) for v in relation.listed(place) if isinstance(v, Reference)]


def _material(chosen: Instance | None) -> str:
    """Return the name of a material, or those of all in a set of layers or constituents, joined by plus signs."""
    names: dict[str, None] = {}
    waiting = [] if chosen is None else [chosen]
    seen: set[int] = set()
    while waiting:
        at = waiting.pop(0)
        if at.number in seen:
            continue
        seen.add(at.number)
        if at.kind == "IFCMATERIAL":
            names[at.text(0)] = None
        elif at.kind.startswith("IFCMATERIAL"):
            inner = [v for a in at.arguments for v in (a if isinstance(a, tuple) else (a,))]
            waiting += [at.file[v] for v in inner if isinstance(v, Reference) and v in at.file]
    return " + ".join(name for name in names if name)
