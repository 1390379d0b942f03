"""How the ground moves: records of earthquakes and pulses by name."""
