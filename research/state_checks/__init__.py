"""Checks of states of the continuum by other means than the solvers', one kind of contact a file."""
