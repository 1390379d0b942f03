"""One load step, load paths, limit loads: immutable results that carry their own proof."""
