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
    from concio.analysis.result import Result
    from concio.analysis.step import solve
    from concio.contact.assembly import Assembly, assemble
    from concio.errors import ConcioError, GeometryError, InputError, MethodError, NoEquilibriumError, SolverError
    from concio.lcp.solution import Status
    from concio.model.materials import Elastic, JointLaw, Rigid
    from concio.model.model import Body, JointRule, Load, Model, Support, Tie
    from concio.model.panel import running_bond_panel

__version__ = "0.1.0"

_HOMES = {
    "concio.analysis.result": ("Result",),
    "concio.analysis.step": ("solve",),
    "concio.contact.assembly": ("Assembly", "assemble"),
    "concio.errors": (
        "ConcioError",
        "GeometryError",
        "InputError",
        "MethodError",
        "NoEquilibriumError",
        "SolverError",
    ),
    "concio.lcp.solution": ("Status",),
    "concio.model.materials": ("Elastic", "JointLaw", "Rigid"),
    "concio.model.model": ("Body", "JointRule", "Load", "Model", "Support", "Tie"),
    "concio.model.panel": ("running_bond_panel",),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [*_HOME, "__version__"]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    msg = f"module 'concio' has no attribute '{name}'"
    raise AttributeError(msg)


def __dir__() -> list[str]:
    return sorted(__all__)
