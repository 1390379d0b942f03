"""Large displacements: pushing a structure over, shaking it, and the records and pulses that shake it.

>>> from concio import motion
>>> pulse = motion.Pulse("half sine", amplitude=3.0, length=0.5)
>>> pulse.duration
0.5

The functions and classes are those of ``concio`` itself. Beside them are the result of :func:`concio.rock`, the
state from which another motion can start, and the energy balance.
"""

from __future__ import annotations

from concio.analysis.motion.dynamics import dynamics
from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.energy import EnergyBalance
from concio.analysis.motion.let_go import let_go
from concio.analysis.motion.push import push
from concio.analysis.motion.push_result import PushResult
from concio.analysis.motion.rocking import RockingResult, rock
from concio.analysis.motion.state import MotionState
from concio.io.motion_file import load_motion, save_motion
from concio.model.motion.records import read_record
from concio.model.motion.signals import Pulse, Record

__all__ = [
    "DynamicsResult",
    "EnergyBalance",
    "MotionState",
    "Pulse",
    "PushResult",
    "Record",
    "RockingResult",
    "dynamics",
    "let_go",
    "load_motion",
    "push",
    "read_record",
    "rock",
    "save_motion",
]
