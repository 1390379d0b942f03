"""The contact problem in plain arrays, its joint laws, and the solution that judges itself."""
