"""How large a model may be: more than this is taken for a typing error, and said before any work is done."""

from __future__ import annotations

LARGEST_BLOCKS = 500_000
"""Blocks that a generator makes."""
LARGEST_COORDINATE = 1e50
"""Coordinates [m]: products of larger ones are not numbers."""
LARGEST_UNKNOWNS = 20_000_000
"""Displacements of a mesh."""
LARGEST_REFINEMENT = 1_000
"""Times that an element is split along each side."""
LARGEST_STEPS = 1_000_000
"""Steps of a stage."""
LARGEST_SWEEPS = 1_000
"""Rounds in which stones are evened out."""
LARGEST_SEED = 2**63 - 1
