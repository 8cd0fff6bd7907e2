"""Spectra of rough surfaces: random realisations, moments, statistics and fits."""
