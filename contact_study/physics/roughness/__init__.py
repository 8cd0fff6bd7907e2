"""Spectra of rough surfaces: moments, statistics of heights, and fits of self-affine laws.

Surfaces with these spectra are drawn in :mod:`contact_study.physics.surfaces`.
"""
