"""Masonry arch bridges: how much of a vehicle is carried wherever it stands, and what that rests on."""
