"""Proofs in whole numbers: certificate files that a short program of its own recomputes without rounding."""
