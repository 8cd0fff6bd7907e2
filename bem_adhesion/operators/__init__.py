"""Elastic solids on a grid, periodic or with free boundaries, and loads; no law and no solver."""
