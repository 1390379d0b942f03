"""Which faces touch, and what is wrong with outlines."""
