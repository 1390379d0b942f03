"""The iterative methods of contact mechanics: one file a method."""
