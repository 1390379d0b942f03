"""Contact of bodies that move far: where their outlines are, which corners and edges touch, and what that couples."""
