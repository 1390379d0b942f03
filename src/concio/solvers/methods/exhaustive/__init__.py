"""Small structures: every combination of joint states, searched or excluded."""
