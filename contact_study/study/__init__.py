"""Studies: sections and keys, reading, the sweep and its cases, and checks before any work starts.

A case makes its law, solid and surface from :mod:`contact_study.physics`. Running a study is the campaign's.
"""
