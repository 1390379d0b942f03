"""Drawings in DXF: read, judged, mended."""
