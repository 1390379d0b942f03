"""Linear programmes of statics: existence, mechanism, limit load, collapse states."""
