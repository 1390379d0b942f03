"""concio: masonry of blocks held together by unilateral contact and Coulomb friction."""

from __future__ import annotations

__version__ = "0.1.0"
