"""Studies over many runs: tables that compare methods, forms and parameters."""
