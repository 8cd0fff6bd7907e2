"""Text of the report: templates, and the wording that they share.

No numbers are computed here.
"""
