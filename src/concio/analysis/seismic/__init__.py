"""Seismic assessment of local mechanisms: spectra, kinematic checks, and what the code asks, as data."""
