"""Structures by their parameters: panels, walls, arches, columns, rubble."""
