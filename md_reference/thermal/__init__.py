"""Atoms at a temperature: hybrid Monte Carlo, molecular dynamics, tests of equilibration and checkpoints.

Loading paths of a study are in the room above.
"""
