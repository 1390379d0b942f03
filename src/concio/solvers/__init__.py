"""Solvers of the contact problem: they know its arrays and nothing of masonry."""
