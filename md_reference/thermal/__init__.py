"""Atoms at a temperature: hybrid Monte Carlo, molecular dynamics, tests of equilibration and checkpoints."""
