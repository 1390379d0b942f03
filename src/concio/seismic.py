"""Seismic assessment of local mechanisms: sites, checks, and the force that a tie needs.

>>> from concio import seismic
>>> site = seismic.Site({"SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}}, soil="B")
>>> site.levels
('SLV',)

The functions and classes are those of ``concio`` itself. Beside them are the mechanisms of an assessment, their
checks, and the classes of buildings and free-standing parts.
"""

from __future__ import annotations

from concio.analysis.seismic.assess import assess
from concio.analysis.seismic.assessment import Assessment
from concio.analysis.seismic.checks import Check
from concio.analysis.seismic.floor import Mode, Storeys
from concio.analysis.seismic.free_standing import FreeStanding
from concio.analysis.seismic.local_mechanism import LocalMechanism, NoMechanism
from concio.analysis.seismic.sections import OutOfPlane
from concio.analysis.seismic.site import Site
from concio.analysis.seismic.strengthening import Measure, strengthen
from concio.analysis.seismic.strip_ties import StripTie, strip_tie
from concio.analysis.seismic.variations import TieForce, tie_force, variations

__all__ = [
    "Assessment",
    "Check",
    "FreeStanding",
    "LocalMechanism",
    "Measure",
    "Mode",
    "NoMechanism",
    "OutOfPlane",
    "Site",
    "Storeys",
    "StripTie",
    "TieForce",
    "assess",
    "strengthen",
    "strip_tie",
    "tie_force",
    "variations",
]
