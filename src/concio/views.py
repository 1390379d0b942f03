"""Views of models and results, looked up by class: figures, tables, pages of a notebook, reports.

A result holds numbers and imports none of its views. It asks for one by its name, and :data:`VIEWS` says what makes it;
the module that does is loaded at that moment. A subclass has the views of its bases.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

VIEWS: dict[str, dict[str, str]] = {
    "plot": {
        "Result": "concio.plot.plots_of:plots_of",
        "LimitResult": "concio.plot.limit_accessor:LimitPlots",
        "PathResult": "concio.plot.path_accessor:PathPlots",
        "Moduli": "concio.plot.cell_accessor:ModuliPlots",
        "StrengthDomain": "concio.plot.cell_accessor:StrengthPlots",
        "CellPath": "concio.plot.cell_accessor:CellPathPlots",
        "ContinuumComparison": "concio.plot.continuum_accessor:ContinuumPlots",
        "BlockHalving": "concio.plot.continuum_accessor:HalvingPlots",
        "StudyResult": "concio.plot.study_figures:StudyPlots",
        "Diagnosis": "concio.plot.diagnosis_accessor:DiagnosisPlots",
        "BridgeResult": "concio.plot.bridge_accessor:BridgePlots",
    },
    "tables": {
        "Result": "concio.post.tables_of:tables_of",
        "PathResult": "concio.post.path_tables:PathTables",
    },
    "notebook": {
        "Model": "concio.report.notebook:model_html",
        "Shown": "concio.report.notebook:result_html",
    },
    "viewer": {"Result": "concio.report.inline:inline_report"},
    "report": {
        "Assessment": "concio.report.assessment_page:write_assessment_report",
        "Diagnosis": "concio.report.diagnosis_page:write_diagnosis_report",
        "StudyResult": "concio.report.study_page:write_study_report",
        "BridgeResult": "concio.report.bridge_page:write_bridge_report",
    },
}
"""What makes a view of an object of a class: ``VIEWS[view][class]`` is "module:name", called with the object."""


def view(shown: object, name: str, *args: Any, **options: Any) -> Any:
    """Return a view of a model or a result.

    Parameters
    ----------
    shown : object
    name : {"plot", "tables", "notebook", "viewer", "report"}
    *args, **options
        Handed to what makes the view, after the object.

    Raises
    ------
    TypeError
        Objects of that class have no such view.
    """
    for cls in type(shown).__mro__:
        if maker := VIEWS[name].get(cls.__name__):
            module, _, function = maker.partition(":")
            return getattr(import_module(module), function)(shown, *args, **options)
    msg = f"{type(shown).__name__} has no view '{name}'"
    raise TypeError(msg)


class Shown:
    """Base of what a notebook displays; a result by the sentence and the question of its verdict."""

    def _repr_html_(self) -> str:
        return str(view(self, "notebook"))
