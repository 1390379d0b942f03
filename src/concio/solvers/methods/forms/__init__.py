"""The reductions of the paper and its kin to linear complementarity, and Lemke's method on them."""
