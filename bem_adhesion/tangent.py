"""Contact stiffness by the linearised problem: how a state gives way to a little more pressure, without another state.

Under a pressure that grows by dp every point that is free to move follows its balance, (K + φ'') x = −dp, and every
point that a wall holds stays. With y the answer to a unit right side the mean gap falls by <y> dp, and −dp/dū = 1/<y>:
what the difference of two states tends to, as long as no patch jumps.
"""

import numpy as np

from bem_adhesion.linearised import LinearisedContact

# The mean is the energy of the answer, whose error is the square of the residual's: 1e-8, beyond single precision.
REDUCTION, ITERATIONS = 1e-4, 400
# Stiffness of a held point, over the largest of the solid: what it gives way shows in the answer, most where a spring
# carries the mean. No step follows from it, so that it may be larger than in a descent.
PINNED = 1e6


def mean_compliance(linearised: LinearisedContact, curvature: np.ndarray, held: np.ndarray) -> float:
    """Mean displacement of the answer to a unit pressure (m/Pa).

    Parameters
    ----------
    linearised : LinearisedContact
        The linear solver.
    curvature : numpy.ndarray of float32
        φ'' (Pa/m), and where points are held what stands for infinite.
    held : numpy.ndarray of bool
        Points that a wall holds.

    Returns
    -------
    float
        Infinite where nothing holds the surfaces together; not a number at a fold or without convergence.
    """
    if not held.any() and not curvature.any():
        return np.inf
    right_side = np.where(held, np.float32(0), np.float32(1))
    result = linearised.solve(right_side, curvature, 1.0, REDUCTION, ITERATIONS)
    if result.negative_curvature or result.iterations == ITERATIONS:
        return np.nan
    return float(np.mean(linearised.solution, dtype=float))
