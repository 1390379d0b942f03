"""Drawings in DXF: read, judged, repaired."""
