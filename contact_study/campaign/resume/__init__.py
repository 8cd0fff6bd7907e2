"""Continuing earlier runs: the work directory, the match of cases, and what of them a new run uses."""
