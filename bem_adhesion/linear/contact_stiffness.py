"""Contact stiffness by the linearised problem: how a state gives way to a little more pressure, without another state.

Under a pressure that grows by dp every point that is free to move follows its balance, (K + φ'') x = −dp, and every
point that a wall holds stays. Of all x of one mean that hold these points the one in balance has the least energy, so
that

    −dp/dū = <x, (K + φ'') x> / <x>²

errs by the square of what x does: what the difference of two states tends to, as long as no patch jumps. To find it,
x starts as the rigid displacement of the free points and is relieved of all that is out of balance but for a constant,
which is dp. A spring of the control that ties the mean takes up a constant, too, and is not in it.
"""

import numpy as np

from bem_adhesion.linear.conjugate_gradients import LinearisedContact
from contact_study.numerics.inner_product import inner_product

REDUCTION, ITERATIONS = 1e-4, 400
# Stiffness of a held point, over the largest of the solid: what it gives way shows in the answer. No step follows from
# it, so that it may be larger than in a descent.
PINNED = 1e6


def mean_stiffness(linearised: LinearisedContact, curvature: np.ndarray, held: np.ndarray) -> float:
    """−dp/dū, mean pressure over mean displacement (Pa/m): negative where tension falls as surfaces part.

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
        Zero where nothing holds the surfaces together, infinite where a wall holds all points; not a number at a fold
        or without convergence.
    """
    if held.all():
        return np.inf
    if not held.any() and not curvature.any():
        return 0.0
    local = np.where(held, np.float32(0), curvature)
    displacement = (~held).astype(float)
    right_side = -(_flexure(linearised, displacement) + local)
    right_side -= right_side.mean(where=~held, dtype=float)
    right_side[held] = 0
    largest = float(np.abs(right_side).max())
    if largest > 0:
        # At unit size: squares of what is left of a tail may be nothing in single precision.
        result = linearised.solve(right_side / np.float32(largest), curvature, 1.0, REDUCTION, ITERATIONS)
        if result.negative_curvature or result.iterations == ITERATIONS:
            return np.nan
        displacement += np.where(held, 0, largest * linearised.solution.astype(float))
    bent = displacement - displacement.mean()
    energy = inner_product(bent, _flexure(linearised, displacement)) + inner_product(displacement, local * displacement)
    return float(energy / displacement.size / displacement.mean() ** 2)


def _flexure(linearised: LinearisedContact, displacement: np.ndarray) -> np.ndarray:
    """K x without the spring that may tie the mean; its rounding is that of what bends, not of the mean."""
    operator = linearised.operator
    operator.field[...] = displacement - displacement.mean()
    return operator.apply(operator.stiffness)
