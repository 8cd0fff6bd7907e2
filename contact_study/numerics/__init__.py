"""Numerical methods that two of the packages use; no physics of contacts and no study files."""
