"""The chain of strategies of method ``auto``."""
