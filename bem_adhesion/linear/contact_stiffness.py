"""Contact stiffness from the linearised equations of one state.

Under a pressure that grows by dp every free point follows its balance, (K + φ'') x = −dp, and a wall holds the other
points. Among all x of one mean that hold these points, the one in balance has the least energy, so that the error of

    −dp/dū = <x, (K + φ'') x> / <x>²

is the square of the error of x. The difference of two states tends to this value as long as no patch jumps. The solve
starts with the rigid displacement of the free points and removes what is out of balance except a constant, which is dp.
A spring of the control on the mean takes up a constant, too, and is not included.
"""

import numpy as np

from bem_adhesion.linear.conjugate_gradients import LinearisedContact
from contact_study.numerics.inner_product import inner_product


def mean_stiffness(
    linearised: LinearisedContact,
    curvature: np.ndarray,
    held: np.ndarray,
    reduction: float = 1e-4,
    iterations: int = 400,
) -> float:
    """Return −dp/dū, mean pressure over mean displacement (Pa/m): negative where tension falls with the gap.

    Zero where no force acts, infinite where a wall holds all points, NaN at a fold or without convergence.
    ``curvature`` is φ'' (Pa/m), and very large where points are ``held``.
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
        # At unit size: squares of a very small tail underflow in single precision.
        result = linearised.solve(right_side / np.float32(largest), curvature, 1.0, reduction, iterations)
        if result.negative_curvature or result.iterations == iterations:
            return np.nan
        displacement += np.where(held, 0, largest * linearised.solution.astype(float))
    bent = displacement - displacement.mean()
    energy = inner_product(bent, _flexure(linearised, displacement)) + inner_product(displacement, local * displacement)
    return float(energy / displacement.size / displacement.mean() ** 2)


def _flexure(linearised: LinearisedContact, displacement: np.ndarray) -> np.ndarray:
    """Return K x without a spring on the mean; its rounding is that of the bending part of x."""
    operator = linearised.operator
    operator.field[...] = displacement - displacement.mean()
    return operator.apply(operator.stiffness)
