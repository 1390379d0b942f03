"""Tables of the report in space: reactions, the joints with the largest forces, the blocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.report.html_parts import table_html

if TYPE_CHECKING:
    from concio.analysis.result import Result


def space_tables_html(result: Result, rows: int) -> str:
    """Return the tables as HTML; of longer ones than ``rows`` the rows that matter most."""
    tables, units = result.tables, result.model.report
    joints, bodies, reactions = tables.joints(), tables.bodies(), tables.reactions()
    text = f"<h2>Reactions</h2>{table_html(reactions, ('support', 'force_x', 'force_y', 'force_z'), units=units)}"
    text += "<p class=note>Forces on the structure.</p>" + ties_html(result)
    strongest = np.argsort(-np.hypot(joints["normal_force"], joints["shear_size"]), kind="stable")
    columns: tuple[str, ...] = ("body_a", "body_b", "area", "normal_force", "shear_size", "torsion", "open_share")
    text += "<h2>Joints</h2>" + _note(len(strongest), rows, "the largest forces")
    text += table_html(joints, columns, rows=strongest[:rows], units=units)
    text += "<p class=note>Normal force: compression positive. Torsion: moment about the normal.</p>"
    free = np.flatnonzero(bodies["kind"] != "fixed")
    moved = np.sqrt(bodies["u_x"] ** 2 + bodies["u_y"] ** 2 + bodies["u_z"] ** 2)
    order = free[np.argsort(-moved[free], kind="stable")] if len(free) > rows else free
    columns = ("body", "role", "u_x", "u_y", "u_z", "s_1", "s_2", "s_3")
    text += "<h2>Blocks</h2>" + _note(len(free), rows, "the largest motion")
    text += table_html(bodies, columns, rows=order[:rows], units=units)
    return text + "<p class=note>Mean motion and mean principal stresses; tension positive.</p>"


def ties_html(result: Result) -> str:
    """Return the table of ties, plane or in space; nothing where there are none."""
    if not result.model.ties:
        return ""
    columns: tuple[str, ...] = ("tie", "body_a", "body_b", "tension", "elongation", "state")
    columns += tuple(f"force_{axis}" for axis in "xyz"[: result.model.dim])
    table = table_html(result.tables.ties(), columns, units=result.model.report)
    note = (
        "Tension of each tie, and its force on the first block; on the second, or on a fixed point, it is the opposite."
    )
    return f"<h2>Ties</h2>{table}<p class=note>{note}</p>"


def _note(count: int, rows: int, what: str) -> str:
    return "" if count <= rows else f"<p class=note>The {rows} with {what}, of {count:,}; the CSV tables hold all.</p>"
