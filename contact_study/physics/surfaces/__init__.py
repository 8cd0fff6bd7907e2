"""Rigid surfaces: their heights on any grid, and the scales that are known before a surface is made.

Their keys in a study file live in :mod:`contact_study.study.schema.surface`, spectra in ``roughness``, files in
``height_maps``.
"""
