"""Numerical methods that two of the packages use: grids, transforms, time integration, statistics.

No physics of contacts and no study files.
"""
