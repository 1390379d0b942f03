"""Complementary pivoting on the sparse mixed form."""
