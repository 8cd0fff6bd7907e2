"""Numerical methods of the theories: fixed points, tridiagonal systems, background threads."""
