"""Frames, rigid motions and exact masses, in the plane and in space; independent of bodies and joints."""
