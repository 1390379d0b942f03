"""A wall as a homogenised continuum, with the moduli and the strength of a cell, beside the wall of its blocks."""
