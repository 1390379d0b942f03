"""The capacity curve of a mechanism that is no linkage of one degree of freedom: the structure is pushed over.

:func:`concio.push` keeps no mechanism: it finds equilibria of the displaced structure, whatever moves then. It costs
half a minute for twenty blocks where a linkage costs a tenth of a second: it is asked only where the linkage cannot
answer, and of few blocks.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from concio.analysis.motion.push import push
from concio.analysis.seismic.curve import CapacityCurve
from concio.errors import ConcioError
from concio.model.model import Model
from concio.model.stages import ControlPoint

LARGEST = 24
"""Moving blocks of a model that is pushed over, at most."""


def pushed_curve(
    model: Model, groups: Sequence[str], sign: float, moving: Collection[int], control: ControlPoint
) -> CapacityCurve | None:
    """Return the capacity curve of a model in which some bodies may move; None where it is too large or fails.

    Parameters
    ----------
    model : Model
        With the loads of the earthquake.
    groups : sequence of str
        Load groups that push, times ``sign``.
    moving : collection of int
        Bodies that may move; all others are held.
    control : ControlPoint
    """
    if len(moving) > LARGEST:
        return None
    names = {model.bodies[b].name for b in moving}
    bodies = tuple(
        b if i in moving or b.kind == "fixed" else replace(b, kind="fixed") for i, b in enumerate(model.outlines)
    )
    loads = []
    for load in model.loads:
        value = tuple(sign * v for v in load.value) if load.group in groups else load.value
        on = tuple(word for word in load.bodies if word in names)
        if load.bodies and not on and all(b.name not in names or word not in (b.role, b.layer) for b in model.bodies
                                          for word in load.bodies):  # fmt: skip
            continue
        loads.append(replace(load, value=value))
    laws = {name: replace(law, tensile_strength=0.0) for name, law in model.laws.items()}
    supports = tuple(s for s in model.supports if s.body in names)
    try:
        found = push(
            replace(model, bodies=bodies, loads=tuple(loads), laws=laws, supports=supports), control=control,
            live=tuple(groups),
        )  # fmt: skip
    except ConcioError:
        return None
    d, alpha = np.asarray(found.displacement), np.asarray(found.multiplier)
    if len(d) < 3:
        return None
    end = float(found.capacity)
    if end == end:
        keep = d < end
        return CapacityCurve("pushed", np.append(d[keep], end), np.append(alpha[keep], 0.0), end)
    return CapacityCurve("pushed", np.append(d, d[-1]), np.append(alpha, 0.0), float(d[-1]), "joint opens")
