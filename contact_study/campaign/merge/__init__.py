"""Datasets of one study, run in parts, joined into the one that a run of the whole study writes."""
