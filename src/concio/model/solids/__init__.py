"""Blocks in space from files of other programs: OBJ, STL, PLY, OFF, COMPAS JSON, 3D DXF, Rhino 3dm, IFC."""
