r"""Rocking under a horizontal share of the weights: a push of rigid blocks, seen as rotations.

In small displacements a toppling block keeps its multiplier for ever. A block of width b and height h that rocks about
its toe falls from b/h to zero as its centroid passes above the toe: :math:`\lambda = \tan(\arctan(b/h) - \theta)`. It
is :func:`concio.push` that follows it, with every load, tie, support and joint law of the model.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.motion.push import push
from concio.analysis.motion.push_result import PushEnding, PushResult
from concio.arguments import strict
from concio.errors import InputError
from concio.model.model import Load, Model, require_model
from concio.read_only import read_only
from concio.verdict.verdict import Verdict
from concio.views import Shown

Array = np.ndarray


@dataclass(frozen=True, eq=False)
@read_only
class RockingResult(Shown):
    """A rocking curve, from its peak on.

    Parameters
    ----------
    multiplier : (n,) array
        Multiplier of the horizontal share at each step.
    rotation : (n, B) array
        Rotation of each free body, anticlockwise [rad].
    centroid : (n, B, 2) array
        Position of each free body's centroid [m].
    names : tuple of str
        Names of the free bodies.
    reason : str
        Why the curve ends, in words.
    pushed : PushResult
        The push whose curve it is, from its beginning.
    """

    multiplier: Array
    rotation: Array
    centroid: Array
    names: tuple[str, ...]
    reason: str
    pushed: PushResult

    @property
    def verdict(self) -> Verdict:
        """What the structure carries sideways: the verdict of the push."""
        return self.pushed.verdict


@strict
def rock(model: Model, *, direction: float = 1.0, step: float = 0.005, smallest: float = 0.0) -> RockingResult:
    """Follow the collapse of rigid blocks under a horizontal share of the weights they carry in large displacements.

    Parameters
    ----------
    model : Model
        Rigid and fixed bodies, with all their loads, ties, supports and joint laws; where it has no load at all, its
        self-weight.
    direction : {1, -1}
        Side to which the share acts.
    step : float
        Largest step of the mean displacement of the masses [m].
    smallest : float
        Multiplier at which to stop.

    Raises
    ------
    InputError
        A body is elastic, or there is none that is rigid.
    NoEquilibriumError
        The structure does not stand at the start.

    Examples
    --------
    A block, 0.5 m wide and 2 m high, begins to turn over at 0.25 of its weight:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    >>> curve = concio.rock(pillar)
    >>> round(float(curve.multiplier[0]), 4)
    0.25
    """
    require_model(model)
    for body in model.bodies:
        if body.kind == "elastic":
            msg = "rocking needs rigid blocks, this one is elastic"
            hint = "give it kind = 'rigid' and a Rigid material, or use concio.push"
            raise InputError(msg, where=f"block '{body.name}'", hint=hint)
    free = [i for i, body in enumerate(model.bodies) if body.kind == "rigid"]
    if not free:
        msg = "there is no rigid body to rock"
        raise InputError(msg, hint="give the blocks kind = 'rigid'")
    loaded = model if model.loads else replace(model, loads=(Load("weight", (0.0, -1.0)),))
    found = push(loaded, live=(), direction=direction, step=step, smallest=smallest)
    at = slice(found.peak_step, None)
    fell = f"the multiplier fell to {smallest:g}"
    return RockingResult(
        found.multiplier[at],
        found.rotation[at][:, free],
        found.centre[at][:, free],
        tuple(model.bodies[i].name for i in free),
        fell if found.ending is PushEnding.LOST else found.ending.value,
        found,
    )
