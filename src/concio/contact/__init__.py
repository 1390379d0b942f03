"""Interfaces between bodies become contact pairs; the result is one :class:`ContactProblem` of plain arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from concio.contact.assembly import Assembly, assemble
    from concio.contact.detection import detect

__all__ = ["Assembly", "assemble", "detect"]


def __getattr__(name: str) -> Any:
    if name in __all__:
        from concio.contact import assembly, detection

        return getattr(detection if name == "detect" else assembly, name)
    msg = f"module {__name__!r} has no attribute {name!r}"
    raise AttributeError(msg)
