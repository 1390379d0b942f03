"""Fill, road and vehicles on a plane model: faces below the fill, its weight and pressure, and how it spreads load."""
