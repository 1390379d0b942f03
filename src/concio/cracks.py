"""From cracks to cause: measurements, motions that may have caused them, and those that explain them.

>>> from concio import cracks
>>> sinks = cracks.Candidate("pier sinks", body="ground", direction=(0, -1), low=0.0)
>>> sinks.quantity
'motion'

The functions and classes are those of ``concio`` itself. Beside them are the parts of a diagnosis.
"""

from __future__ import annotations

from concio.analysis.cracks.cause import Cause
from concio.analysis.cracks.diagnose import diagnose
from concio.analysis.cracks.diagnosis import Diagnosis
from concio.analysis.cracks.future import Future
from concio.analysis.cracks.measurement import Candidate, Measurement
from concio.analysis.cracks.places import Place
from concio.analysis.cracks.undetermined import Unseen

__all__ = [
    "Candidate",
    "Cause",
    "Diagnosis",
    "Future",
    "Measurement",
    "Place",
    "Unseen",
    "diagnose",
]
