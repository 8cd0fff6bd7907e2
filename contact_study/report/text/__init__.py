"""Text of the report: templates and the wording that they share; no numbers are computed here."""
