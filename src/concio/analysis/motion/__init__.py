"""Large displacements: pushing a structure over, and shaking it."""
