"""Figures: every function takes ``ax=``, returns it, and never shows it."""
