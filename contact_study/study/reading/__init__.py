"""Input of a study beside its TOML text: tables and spectra from files, overrides, values that are chosen.

Height maps are physics, and read in :mod:`contact_study.physics.height_maps`.
"""
