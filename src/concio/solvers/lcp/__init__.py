"""Linear complementarity problems as such, and the method of Lemke for them."""
