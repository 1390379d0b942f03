"""concio: masonry of blocks held together by unilateral contact and Coulomb friction.

>>> import concio
>>> model = concio.running_bond_panel(courses=3, blocks=3, friction=0.6, top_pressure=10.0)
>>> result = concio.solve(model)
>>> result.status.name
'SOLVED'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from concio import bridges as bridges
    from concio import cells as cells
    from concio import cracks as cracks
    from concio import generate as generate
    from concio import motion as motion
    from concio import seismic as seismic
    from concio import trace as trace
    from concio.analysis.bridges.assess_bridge import assess_bridge
    from concio.analysis.bridges.bridge_result import BridgeResult
    from concio.analysis.cells.cell_path import strain_path
    from concio.analysis.cells.moduli import homogenise
    from concio.analysis.cells.strength import strength
    from concio.analysis.continuum.comparison import compare_with_continuum
    from concio.analysis.continuum.halving import halve_blocks
    from concio.analysis.cracks.diagnose import diagnose
    from concio.analysis.cracks.diagnosis import Diagnosis
    from concio.analysis.cracks.measurement import Candidate, Measurement
    from concio.analysis.limit import friction_margin, limit
    from concio.analysis.margins import friction_by_solving, load_margin
    from concio.analysis.motion.dynamics import dynamics
    from concio.analysis.motion.dynamics_result import DynamicsResult
    from concio.analysis.motion.let_go import let_go
    from concio.analysis.motion.push import push
    from concio.analysis.motion.push_result import PushResult
    from concio.analysis.motion.rocking import rock
    from concio.analysis.path import ControlPoint, PathResult, Stage, run_path
    from concio.analysis.result import Result
    from concio.analysis.seismic.assess import assess
    from concio.analysis.seismic.assessment import Assessment
    from concio.analysis.seismic.site import Site
    from concio.analysis.settlement import settle
    from concio.analysis.state_sensitivity import StateSensitivity, state_sensitivity
    from concio.analysis.step import solve
    from concio.analysis.thrust import thrust_line
    from concio.analysis.thrust_surface import thrust_surface
    from concio.contact.assembly import Assembly, assemble
    from concio.display import Units
    from concio.errors import ConcioError, GeometryError, InputError, MethodError, NoEquilibriumError, SolverError
    from concio.io.motion_file import load_motion, save_motion
    from concio.io.solids_out import write_solids
    from concio.model.compose import place
    from concio.model.crossing import Axle, Vehicle
    from concio.model.drawing.drawing import model_from_dxf
    from concio.model.file.reading import load, loads
    from concio.model.file.writing import dumps, save
    from concio.model.fill import Fill, Layer
    from concio.model.generate.arch_bridges import bridge
    from concio.model.generate.arch_on_piers import arch_on_piers
    from concio.model.generate.arches import arch
    from concio.model.generate.barrel import barrel
    from concio.model.generate.columns import buttress, column
    from concio.model.generate.dome import dome
    from concio.model.generate.drums import drums
    from concio.model.generate.extrusion import extrude
    from concio.model.generate.groins import cloister_vault, cross_vault
    from concio.model.generate.merging import merge
    from concio.model.generate.panel import running_bond_panel
    from concio.model.generate.periodic_cells import cell
    from concio.model.generate.plan_walls import tower, walls
    from concio.model.generate.rubble import rubble
    from concio.model.generate.walls import wall, wall_of_courses
    from concio.model.materials import Elastic, JointLaw, Rigid
    from concio.model.model import Body, JointRule, Load, Model, Support, Tie
    from concio.model.motion.records import read_record
    from concio.model.motion.signals import Pulse, Record
    from concio.model.picture.courses import trace_courses
    from concio.model.polyhedron import Polyhedron
    from concio.model.road.earth import with_fill, with_vehicle
    from concio.model.road.vehicles import find_vehicle
    from concio.model.solids.importing import model_from_solids
    from concio.problem.solution import Status
    from concio.studies.reliability import Reliability, multiplier_over, reliability
    from concio.studies.study import Stop, study
    from concio.studies.study_result import StudyResult, load_study
    from concio.studies.variables import Variable, variable
    from concio.verdict.verdict import Outcome, Verdict

__version__ = "0.2.0"

_HOMES = {
    "concio.analysis.bridges.assess_bridge": ("assess_bridge",),
    "concio.analysis.bridges.bridge_result": ("BridgeResult",),
    "concio.analysis.cells.moduli": ("homogenise",),
    "concio.analysis.cells.cell_path": ("strain_path",),
    "concio.analysis.cells.strength": ("strength",),
    "concio.analysis.continuum.comparison": ("compare_with_continuum",),
    "concio.analysis.continuum.halving": ("halve_blocks",),
    "concio.analysis.cracks.diagnose": ("diagnose",),
    "concio.analysis.cracks.diagnosis": ("Diagnosis",),
    "concio.analysis.cracks.measurement": ("Candidate", "Measurement"),
    "concio.analysis.limit": ("friction_margin", "limit"),
    "concio.analysis.margins": ("friction_by_solving", "load_margin"),
    "concio.analysis.path": ("ControlPoint", "PathResult", "Stage", "run_path"),
    "concio.analysis.result": ("Result",),
    "concio.analysis.motion.dynamics": ("dynamics",),
    "concio.analysis.motion.dynamics_result": ("DynamicsResult",),
    "concio.analysis.motion.let_go": ("let_go",),
    "concio.analysis.motion.push": ("push",),
    "concio.analysis.motion.push_result": ("PushResult",),
    "concio.analysis.motion.rocking": ("rock",),
    "concio.analysis.seismic.assess": ("assess",),
    "concio.analysis.seismic.assessment": ("Assessment",),
    "concio.analysis.seismic.site": ("Site",),
    "concio.io.motion_file": ("load_motion", "save_motion"),
    "concio.model.motion.records": ("read_record",),
    "concio.model.motion.signals": ("Pulse", "Record"),
    "concio.analysis.settlement": ("settle",),
    "concio.analysis.state_sensitivity": ("StateSensitivity", "state_sensitivity"),
    "concio.analysis.step": ("solve",),
    "concio.analysis.thrust": ("thrust_line",),
    "concio.analysis.thrust_surface": ("thrust_surface",),
    "concio.contact.assembly": ("Assembly", "assemble"),
    "concio.display": ("Units",),
    "concio.errors": (
        "ConcioError",
        "GeometryError",
        "InputError",
        "MethodError",
        "NoEquilibriumError",
        "SolverError",
    ),
    "concio.problem.solution": ("Status",),
    "concio.studies.reliability": ("Reliability", "multiplier_over", "reliability"),
    "concio.studies.study": ("Stop", "study"),
    "concio.studies.study_result": ("StudyResult", "load_study"),
    "concio.studies.variables": ("Variable", "variable"),
    "concio.verdict.verdict": ("Outcome", "Verdict"),
    "concio.model.generate.arch_on_piers": ("arch_on_piers",),
    "concio.model.generate.arches": ("arch",),
    "concio.model.generate.barrel": ("barrel",),
    "concio.model.generate.arch_bridges": ("bridge",),
    "concio.model.crossing": ("Axle", "Vehicle"),
    "concio.model.fill": ("Fill", "Layer"),
    "concio.model.road.earth": ("with_fill", "with_vehicle"),
    "concio.model.road.vehicles": ("find_vehicle",),
    "concio.model.generate.dome": ("dome",),
    "concio.model.generate.drums": ("drums",),
    "concio.model.generate.groins": ("cloister_vault", "cross_vault"),
    "concio.model.generate.plan_walls": ("tower", "walls"),
    "concio.model.generate.periodic_cells": ("cell",),
    "concio.model.generate.columns": ("buttress", "column"),
    "concio.model.generate.extrusion": ("extrude",),
    "concio.model.compose": ("place",),
    "concio.model.generate.merging": ("merge",),
    "concio.model.drawing.drawing": ("model_from_dxf",),
    "concio.model.picture.courses": ("trace_courses",),
    "concio.model.solids.importing": ("model_from_solids",),
    "concio.io.solids_out": ("write_solids",),
    "concio.model.file.reading": ("load", "loads"),
    "concio.model.file.writing": ("dumps", "save"),
    "concio.model.materials": ("Elastic", "JointLaw", "Rigid"),
    "concio.model.model": ("Body", "JointRule", "Load", "Model", "Support", "Temperature", "Tie"),
    "concio.model.stages": ("cycles",),
    "concio.model.polyhedron": ("Polyhedron",),
    "concio.model.generate.panel": ("running_bond_panel",),
    "concio.model.generate.rubble": ("rubble",),
    "concio.model.generate.walls": ("wall", "wall_of_courses"),
}
_NAMESPACES = ("bridges", "cells", "cracks", "generate", "motion", "seismic", "trace")
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [
    "Assembly",
    "Assessment",
    "Axle",
    "Body",
    "BridgeResult",
    "Candidate",
    "ConcioError",
    "ControlPoint",
    "Diagnosis",
    "DynamicsResult",
    "Elastic",
    "Fill",
    "GeometryError",
    "InputError",
    "JointLaw",
    "JointRule",
    "Layer",
    "Load",
    "Measurement",
    "MethodError",
    "Model",
    "NoEquilibriumError",
    "Outcome",
    "PathResult",
    "Polyhedron",
    "Pulse",
    "PushResult",
    "Record",
    "Reliability",
    "Result",
    "Rigid",
    "Site",
    "SolverError",
    "Stage",
    "StateSensitivity",
    "Status",
    "Stop",
    "StudyResult",
    "Support",
    "Temperature",
    "Tie",
    "Units",
    "Variable",
    "Vehicle",
    "Verdict",
    "__version__",
    "arch",
    "arch_on_piers",
    "assemble",
    "assess",
    "assess_bridge",
    "barrel",
    "bridge",
    "buttress",
    "cell",
    "cloister_vault",
    "column",
    "compare_with_continuum",
    "cross_vault",
    "cycles",
    "diagnose",
    "dome",
    "drums",
    "dumps",
    "dynamics",
    "extrude",
    "find_vehicle",
    "friction_by_solving",
    "friction_margin",
    "halve_blocks",
    "homogenise",
    "let_go",
    "limit",
    "load",
    "load_margin",
    "load_motion",
    "load_study",
    "loads",
    "merge",
    "model_from_dxf",
    "model_from_solids",
    "multiplier_over",
    "place",
    "push",
    "read_record",
    "reliability",
    "rock",
    "rubble",
    "run_path",
    "running_bond_panel",
    "save",
    "save_motion",
    "settle",
    "solve",
    "state_sensitivity",
    "strain_path",
    "strength",
    "study",
    "thrust_line",
    "thrust_surface",
    "tower",
    "trace_courses",
    "variable",
    "wall",
    "wall_of_courses",
    "walls",
    "with_fill",
    "with_vehicle",
    "write_solids",
]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    if name in _NAMESPACES:
        return import_module(f"concio.{name}")
    msg = f"module 'concio' has no attribute '{name}'"
    raise AttributeError(msg)


def __dir__() -> list[str]:
    return sorted((*__all__, *_NAMESPACES))
