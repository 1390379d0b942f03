"""Each body meshed: stiffness, consistent loads, rigid motions, stresses. Identical bodies are computed once."""
