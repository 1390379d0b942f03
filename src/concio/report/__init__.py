"""The HTML report: one file that opens offline, with an interactive view, and the words an engineer reads."""
