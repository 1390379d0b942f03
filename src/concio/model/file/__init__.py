"""Model files in TOML and tables of blocks, read and written."""
