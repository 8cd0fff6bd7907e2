"""Measured height maps: file formats, units, levelling, description."""
