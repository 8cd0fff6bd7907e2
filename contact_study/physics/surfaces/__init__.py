"""Rigid surfaces, their heights on any grid and scales; spectra are in ``roughness``, files in ``height_maps``."""
