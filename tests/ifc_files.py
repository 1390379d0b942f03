"""IFC files for the tests, written line by line: a project, a storey, and whatever products ask for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

METRE, MILLIMETRE = "IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)", "IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.)"


class IfcText:
    """Instances of a file in the making; each method adds some and returns the reference to the last."""

    def __init__(self, unit: str = METRE, schema: str = "IFC4", world: Sequence[Sequence[float]] = ()) -> None:
        self.lines: list[str] = []
        self.schema = schema
        self.identifiers = 0
        units = self.add(f"IFCUNITASSIGNMENT(({self.add(unit)}))") if unit else "$"
        contexts = "$"
        if world:
            context = f"IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-05,{self.axes(*world)},$)"
            contexts = f"({self.add(context)})"
        self.project = self.add(f"IFCPROJECT({self.identifier()},$,'P',$,$,$,$,{contexts},{units})")
        self.storey = self.add(f"IFCBUILDINGSTOREY({self.identifier()},$,'Level 1',$,$,$,$,$,.ELEMENT.,0.)")

    def add(self, text: str) -> str:
        self.lines.append(f"#{len(self.lines) + 1}= {text};")
        return f"#{len(self.lines)}"

    def identifier(self) -> str:
        self.identifiers += 1
        return f"'{self.identifiers:022d}'"

    def point(self, at: Sequence[float]) -> str:
        return self.add(f"IFCCARTESIANPOINT({row(at)})")

    def direction(self, along: Sequence[float]) -> str:
        return self.add(f"IFCDIRECTION({row(along)})")

    def axes(self, at: Sequence[float] = (0, 0, 0), z: Sequence[float] | None = None,
             x: Sequence[float] | None = None) -> str:  # fmt: skip
        own = [self.direction(v) if v is not None else "$" for v in (z, x)]
        return self.add(f"IFCAXIS2PLACEMENT3D({self.point(at)},{own[0]},{own[1]})")

    def placed(self, axes: str, within: str = "$") -> str:
        return self.add(f"IFCLOCALPLACEMENT({within},{axes})")

    def triangulated(self, points: np.ndarray, triangles: Sequence[Sequence[int]]) -> str:
        table = self.add(f"IFCCARTESIANPOINTLIST3D(({','.join(map(row, points))}))")
        faces = ",".join(whole(t) for t in triangles)
        return self.add(f"IFCTRIANGULATEDFACESET({table},$,.T.,({faces}),$)")

    def polygonal(self, points: np.ndarray, faces: Sequence[Sequence[int]]) -> str:
        table = self.add(f"IFCCARTESIANPOINTLIST3D(({','.join(map(row, points))}))")
        own = ",".join(self.add(f"IFCINDEXEDPOLYGONALFACE({whole(f)})") for f in faces)
        return self.add(f"IFCPOLYGONALFACESET({table},.T.,({own}),$)")

    def brep(self, points: np.ndarray, faces: Sequence[Sequence[int]],
             holes: Sequence[tuple[int, Sequence[int]]] = ()) -> str:  # fmt: skip
        at = [self.point(p) for p in points]
        made = []
        for k, face in enumerate(faces):
            loops = [("OUTER", face), *(("", loop) for f, loop in holes if f == k)]
            bounds = []
            for word, loop in loops:
                line = self.add(f"IFCPOLYLOOP(({','.join(at[v] for v in loop)}))")
                bounds.append(self.add(f"IFCFACE{word}BOUND({line},.T.)"))
            made.append(self.add(f"IFCFACE(({','.join(bounds)}))"))
        shell = self.add(f"IFCCLOSEDSHELL(({','.join(made)}))")
        return self.add(f"IFCFACETEDBREP({shell})")

    def extruded(self, profile: str, depth: float, axes: str = "$", along: Sequence[float] = (0, 0, 1)) -> str:
        return self.add(f"IFCEXTRUDEDAREASOLID({profile},{axes},{self.direction(along)},{number(depth)})")

    def rectangle(self, x: float, y: float, axes: str = "$") -> str:
        return self.add(f"IFCRECTANGLEPROFILEDEF(.AREA.,$,{axes},{number(x)},{number(y)})")

    def shape(self, *items: str) -> str:
        return self.add(f"IFCSHAPEREPRESENTATION($,'Body','Brep',({','.join(items)}))")

    def mapped(self, shape: str, target: str, origin: str) -> str:
        source = self.add(f"IFCREPRESENTATIONMAP({origin},{shape})")
        return self.add(f"IFCMAPPEDITEM({source},{target})")

    def product(self, name: str, *items: str, kind: str = "IFCBUILDINGELEMENTPROXY", placement: str = "$") -> str:
        shape = self.add(f"IFCPRODUCTDEFINITIONSHAPE($,$,({self.shape(*items)}))") if items else "$"
        return self.add(f"{kind}({self.identifier()},$,'{name}',$,$,{placement},{shape},$,$)")

    def material(self, name: str, *products: str) -> None:
        self.relate("IFCRELASSOCIATESMATERIAL", f"({','.join(products)})", self.add(f"IFCMATERIAL('{name}',$,$)"))

    def relate(self, kind: str, first: str, second: str) -> str:
        return self.add(f"{kind}({self.identifier()},$,$,$,{first},{second})")

    def text(self) -> str:
        head = f"FILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('{self.schema}'));"
        body = "\n".join(self.lines)
        return f"ISO-10303-21;\nHEADER;\n{head}\nENDSEC;\nDATA;\n{body}\nENDSEC;\nEND-ISO-10303-21;\n"

    def write(self, path: Path) -> Path:
        path.write_text(self.text(), encoding="utf-8")
        return path


def number(value: float) -> str:
    """Return a real number as the exchange structure writes it: with a point."""
    text = repr(float(value))
    return text.replace("e", "E") if "." in text else text.replace("e", ".E")


def row(values: Sequence[float]) -> str:
    return f"({','.join(number(v) for v in values)})"


def whole(loop: Sequence[int]) -> str:
    """Return numbers of points, which count from 1."""
    return f"({','.join(str(int(v) + 1) for v in loop)})"
