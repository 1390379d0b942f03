"""Viscous relaxation: a structure let go in a resisting medium comes to rest, or moves away without bound."""
