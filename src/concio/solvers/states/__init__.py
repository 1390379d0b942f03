"""Contact in given states of the pairs: read off a point, solved for exactly, settled where some are undecided."""
