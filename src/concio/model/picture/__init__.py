"""Stones from pictures: orthophotos read, scaled and rectified; courses, regions and outlines traced into blocks."""
