"""Figures from curves, bands and maps."""
