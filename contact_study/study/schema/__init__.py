"""Sections and keys of the study file with units, defaults and help texts, and the physics that they make.

Every section is a frozen dataclass; files, sweeps and overrides are read elsewhere.
"""
