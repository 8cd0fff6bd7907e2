"""Height maps of instruments: formats, units, grids, and their preparation for a periodic calculation.

The surface that a map becomes lives in :mod:`contact_study.physics.surfaces`.
"""
