"""Verdicts: the question asked, the answer, its proof, what was not checked; all words that claim something."""
