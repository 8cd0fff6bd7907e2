"""P(σ, ζ): the stress distribution of Persson's theory while the magnification grows."""

from collections.abc import Callable

import numpy as np

from theory.persson.contact import PerssonContact
from theory.persson.theory import PerssonTheory


def magnifications(theory: PerssonTheory, count: int) -> np.ndarray:
    """``count`` magnifications ζ > 1, evenly in ln ζ up to the highest; at ζ = 1 all stress is the mean pressure."""
    last = theory.wavevectors[-1] / theory.wavevectors[0]
    return np.geomspace(1.0, last, count + 1)[1:]


def stress_densities(contact: PerssonContact | None, zetas: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """P(σ, ζ) of a state as a function of the edges of bins: zero where it has detached, NaN where there is none.

    Parameters
    ----------
    contact : PerssonContact or None
        The state.
    zetas : numpy.ndarray, shape (n,)
        Magnifications ζ = q/q_L, above one up to the highest.

    Returns
    -------
    callable
        From edges, shape (m + 1,) (Pa), to means over the bins, shape (n, m) (1/Pa).
    """
    if contact is None or contact.detached:
        nothing = np.nan if contact is None else 0.0
        return lambda edges: np.full((zetas.size, edges.size - 1), nothing)
    first = contact.theory.wavevectors[0]
    return lambda edges: np.array([contact.stress_density(edges, float(zeta * first)) for zeta in zetas])
