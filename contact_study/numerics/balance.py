"""Force balance of a contact under a mean pressure, whose tolerance shrinks with small loads and stresses."""

from typing import NamedTuple

import numpy as np

# In units of the contact modulus: the tolerance is proportional to mean pressures below LIGHT and to largest stresses
# below WEAK. At most LARGEST_SHARE of the load may be missing.
LIGHT, WEAK, LARGEST_SHARE = 1e-3, 1e-4, 1e-2
# Rounding of the largest displacement, whose stress in the stiffest wave no iteration can balance.
ROUNDING = 4 * np.finfo(float).eps


class Excess(NamedTuple):
    """Residual stress at single points and missing mean pressure, each over its tolerance."""

    residual: float
    load: float

    @property
    def balanced(self) -> bool:
        """Both are within their tolerance."""
        return max(self) <= 1

    @property
    def to_balance(self) -> float:
        """Factor on the residual that brings both within their tolerance."""
        return 1 / max(*self, np.finfo(float).tiny)


def excess(
    tolerance: float,
    residual: float,
    missing: float = 0.0,
    load: float = 0.0,
    stress: float = np.inf,
    rounding: float = 0.0,
    points: int = 1,
) -> Excess:
    """Compare largest residual and missing mean pressure with force balance, in units of the contact modulus."""
    rounding = min(rounding, tolerance)
    if not load:
        return Excess(residual / tolerance, 0.0)
    smallest = max(tolerance * min(1.0, stress / WEAK), rounding)
    share = min(tolerance / LIGHT, LARGEST_SHARE)
    return Excess(residual / smallest, abs(missing) / max(share * abs(load), rounding / np.sqrt(points)))
