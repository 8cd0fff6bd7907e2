"""Atoms at a temperature: hybrid Monte Carlo and Langevin dynamics."""
