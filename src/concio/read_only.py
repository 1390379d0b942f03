"""Arrays of results that cannot be written to: other numbers of a result are computed from them later on.

``result.contacts.normal_force += 1`` would change resultants, reactions and tables that are computed later, and leave
those that were computed before. It raises ``ValueError``; copy an array to change it.
"""

from __future__ import annotations

import dataclasses
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")


def read_only(cls: type[T]) -> type[T]:
    """Make the arrays of a dataclass read-only; stands below ``@dataclass``, which then calls what it adds.

    The object holds views: who made the arrays can still write to them.
    """
    before = getattr(cls, "__post_init__", None)

    def after(self: Any) -> None:
        if before is not None:
            before(self)
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray) and value.flags.writeable:
                object.__setattr__(self, field.name, locked(value))
            elif isinstance(value, dict) and value and all(isinstance(entry, np.ndarray) for entry in value.values()):
                object.__setattr__(self, field.name, {name: locked(entry) for name, entry in value.items()})

    type.__setattr__(cls, "__post_init__", after)
    return cls


def locked(values: np.ndarray) -> np.ndarray:
    """Return a view of an array that cannot be written to."""
    view = values.view()
    view.setflags(write=False)
    return view
