"""Reductions and solvers of the contact problem, and the certificate that judges every answer.

Nothing in this room knows of masonry: it sees ``K, f, C_n, C_t``, gaps, laws and rigid motions.
"""
