"""Sections and keys of the study file, with units, defaults and meanings."""
