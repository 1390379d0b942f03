"""What differs between plane and space on the way from a model to its contact pairs, in one table.

Everything above and below is the same for both: bodies have vertices, a volume and a centroid, interfaces join two
bodies, pairs have a normal and d - 1 tangents.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from concio.contact.pairs import Pairs, make_pairs
from concio.contact.patch_pairs import make_patch_pairs, patch_marks
from concio.contact.sides import interface_breaks
from concio.fem.discretisation import Discretisation
from concio.model.interfaces.detect import Detection, detect_interfaces
from concio.model.interfaces.patches import detect_patches
from concio.model.interfaces.periodic import detect_periodic
from concio.model.model import Model
from concio.representation import short_repr


@short_repr
@dataclass(frozen=True)
class Geometry:
    """The steps that depend on the dimension.

    Parameters
    ----------
    detect : function of model and gap tolerance
        Finds the interfaces.
    marks : function of model and detection
        Where the meshes of bodies must have lines, for each body.
    pairs : function of discretisation and detection
        Makes contact pairs of the interfaces.
    """

    detect: Callable[[Model, float], Detection]
    marks: Callable[[Model, Detection], Mapping[int, Sequence[Any]]]
    pairs: Callable[[Discretisation, Detection], Pairs]


def _detect_plane(model: Model, tolerance: float) -> Detection:
    if model.periods is not None:
        return detect_periodic(model.outlines, model.periods, tolerance=tolerance)
    return detect_interfaces(model.outlines, tolerance=tolerance, reach=model.gap_reach)


def _detect_space(model: Model, tolerance: float) -> Detection:
    return detect_patches(model.polyhedra, tolerance=tolerance, reach=model.gap_reach)


GEOMETRIES: Mapping[int, Geometry] = MappingProxyType(
    {
        2: Geometry(
            _detect_plane,
            lambda model, found: interface_breaks(model, found.segments),
            lambda disc, found: make_pairs(disc, found.segments),
        ),
        3: Geometry(
            _detect_space,
            lambda model, found: patch_marks(model, found.patches),
            lambda disc, found: make_patch_pairs(disc, found.patches),
        ),
    }
)
"""The steps by dimension."""
