"""Frames, rigid motions and exact masses, in the plane and in space; nothing here knows of bodies or joints."""
