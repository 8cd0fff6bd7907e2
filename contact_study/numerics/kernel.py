"""One decorator for compiled loops over arrays."""

from numba import njit

kernel = njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
"""Compile a function: IEEE division by zero, sums in any order, infinities and NaN kept."""
