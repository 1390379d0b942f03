"""Sparse and updated factorisations, and the units in which problems are solved."""
