"""What figures, reports and files show, computed from results; no drawing here."""
