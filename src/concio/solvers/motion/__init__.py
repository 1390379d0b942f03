"""Letting a structure go: where it comes to rest, or how it moves away."""
