"""Shared by all tests. Its place also puts this directory on the import path, for helpers such as ``rigid_walls``."""
