"""Blocks in space from files of other programs, and back: OBJ, STL, COMPAS JSON, 3D DXF, Rhino 3dm."""
