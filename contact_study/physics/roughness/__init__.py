"""Spectra of rough surfaces: moments, statistics of heights, fits of self-affine laws; surfaces are in ``surfaces``."""
