"""Stones from pictures: an orthophoto is scaled or rectified, and its blocks are traced.

>>> import numpy as np
>>> from concio import trace
>>> grey = np.full((40, 120), 0.8)
>>> grey[19:21] = grey[:20, 59:61] = grey[20:, 29:31] = grey[20:, 89:91] = 0.4
>>> found = trace.trace_courses(trace.Photo(grey, 0.01), (0.6, 0.2))
>>> len(found.model(thickness=0.3).free_bodies)
5

Courses of regular masonry are found by :func:`trace_courses` even where joints are faint; stones between clear joints
by :func:`trace_regions`; rubble by :func:`trace_outlines` from some clicks around each stone; a segmentation of your
own by :func:`trace_labels`. A :class:`Tracing` has its doubtful joints first, can be corrected, and gives a model.
"""

from __future__ import annotations

from concio.model.picture.courses import trace_courses
from concio.model.picture.photo import Photo, read_photo
from concio.model.picture.regions import trace_outlines, trace_regions, wire
from concio.model.picture.tracing import TracedJoint, Tracing, trace_labels

__all__ = [
    "Photo",
    "TracedJoint",
    "Tracing",
    "read_photo",
    "trace_courses",
    "trace_labels",
    "trace_outlines",
    "trace_regions",
    "wire",
]
