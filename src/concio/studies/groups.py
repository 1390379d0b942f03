"""Load groups that a study names and no run has are refused before the first run."""

from __future__ import annotations

from concio.arguments import closest
from concio.contact.assembly import PRESTRESS
from concio.contact.macroscopic_strain import STRAINS
from concio.errors import InputError
from concio.studies.sampling import Sample
from concio.studies.study_rows import Tables, Task

MOST_LOOKED_AT = 20
"""Runs whose models are made to find a group."""
UNWRITTEN = (PRESTRESS, *STRAINS)
"""Names that have factors and are those of no load."""


def check_groups(task: Task, sample: Sample) -> None:
    """Refuse load groups of ``factors`` and ``live`` that no run has, as far as models come from tables.

    Parameters
    ----------
    task : Task
    sample : Sample

    Raises
    ------
    InputError
        A factor names a group that does not exist, or outputs multiply one.
    """
    live = task.settings.live if any(o.multiplies and not o.name.startswith("bridge_") for o in task.outputs) else ()
    asked = dict.fromkeys([*task.settings.factors, *live])
    if not (asked and isinstance(task.source, Tables)):
        return
    if len(sample) > MOST_LOOKED_AT and any(v.distribution == "choice" for v in task.variables):
        return  # a choice that is rare may bring a group
    known: dict[str, None] = {}
    for numbers in sample.numbers[:MOST_LOOKED_AT].tolist():
        known |= dict.fromkeys(_groups(task, task.source, tuple(numbers)))
        if all(group in known for group in asked):
            return
    for group in asked:
        if known and group not in known:
            msg = f"there is no load group '{group}' in the models of the study"
            names = [name for name in known if name not in UNWRITTEN]
            raise InputError(msg, where=task.source.name, hint=closest(group, names, names="groups"))


def _groups(task: Task, source: Tables, numbers: tuple[float, ...]) -> tuple[str, ...]:
    """Return the names that factors of the model of a run may have; none where it cannot be made, as its row tells."""
    try:
        model = source.model(task.variables, numbers)
    except Exception:  # whatever is wrong with a run is told in its row
        return ()
    return (*model.load_groups, *UNWRITTEN)
