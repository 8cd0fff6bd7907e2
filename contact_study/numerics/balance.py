"""When a contact under a mean pressure is in balance, by one definition for the continuum and the atoms.

The tolerance of a residual is a share of the contact modulus. A stress that is small beside the modulus need not be
small beside a light load: the whole of a pressure of a nanonewton on a large cell may be. So the tolerance shrinks with
the load and with the largest stress of the interface where these are small, down to what rounding leaves.
"""

from typing import NamedTuple

import numpy as np

# Of mean pressures below the first and of largest stresses below the second number the tolerance is the same share that
# it is of these numbers. No more than LARGEST_SHARE of the load is ever missing. All in units of the contact modulus.
LIGHT, WEAK, LARGEST_SHARE = 1e-3, 1e-4, 1e-2
# Roundings of the largest displacement: what they bend the stiffest wave by cannot be balanced.
ROUNDING = 4 * np.finfo(float).eps


class Excess(NamedTuple):
    """What is out of balance at single points, and what is missing of the mean pressure, over what may be."""

    residual: float
    load: float

    @property
    def balanced(self) -> bool:
        """Whether neither is more than it may be."""
        return max(self) <= 1

    @property
    def to_balance(self) -> float:
        """Factor on what is out of balance by which it is no more than it may be."""
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
    """How far a state is from balance; all stresses in units of the contact modulus.

    Parameters
    ----------
    tolerance : float
        Largest residual where load and stress are not small.
    residual : float
        Largest stress out of balance at a point.
    missing : float, optional
        Mean pressure that is applied and not carried.
    load : float, optional
        Mean pressure that is applied; none, and only the residual counts.
    stress : float, optional
        Largest stress of the interface.
    rounding : float, optional
        Residual that rounding leaves at a point.
    points : int, optional
        Over which the mean is taken.
    """
    rounding = min(rounding, tolerance)
    if not load:
        return Excess(residual / tolerance, 0.0)
    smallest = max(tolerance * min(1.0, stress / WEAK), rounding)
    share = min(tolerance / LIGHT, LARGEST_SHARE)
    return Excess(residual / smallest, abs(missing) / max(share * abs(load), rounding / np.sqrt(points)))
