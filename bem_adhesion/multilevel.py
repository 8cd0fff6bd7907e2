"""Prediction of a load step from the grid of half the resolution.

Full approximation: the coarse grid solves for the *change* of the gap, with the fine grid's residual on its right
side, so that the prediction is exact in everything the coarse grid resolves (A. Brandt, Math. Comp. 31, 333 (1977)).
One prediction a load step: repeated cycles can end in another minimum of the non-convex energy.
"""

import numpy as np
from numba import njit

from bem_adhesion.adhesive import AdhesiveContact, NewtonResult
from contact_study.fields.fourier import interpolate
from contact_study.fields.grid import Grid
from contact_study.problem.laws.base import TractionLaw

# A grid that resolves the process zone E*Δγ/σ_max² by at least this many points is free of lattice trapping.
POINTS_PER_PROCESS_ZONE = 4
# A coarser grid still predicts as well: down to this many points the final states were the same (42 of 42 at 512²).
POINTS_FOR_PREDICTION = 1.25
# Tolerance on the coarse grids: their solutions are predictions.
COARSE_TOLERANCE = 1e-4
# A prediction takes no gap below this fraction of the equilibrium distance, or further below than it was.
CLOSEST_PREDICTION = 0.85


# Points along an axis below which a grid is not halved: nothing is left to save.
FEWEST_POINTS = 8


def process_zone(contact_modulus: float, law: TractionLaw) -> float:
    """Length E* Δγ / σ_max² over which the law bridges the edge of a contact (m)."""
    return contact_modulus * law.work_of_adhesion / law.peak_tensile_stress**2


def _predicts(grid: Grid, contact_modulus: float, law: TractionLaw) -> bool:
    return max(grid.spacing) * POINTS_FOR_PREDICTION <= process_zone(contact_modulus, law)


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
def _correct(gap, change, closest):
    """Add the change in place, but let no gap fall below the smaller of itself and ``closest``; flat arrays."""
    for i in range(gap.size):
        d = gap[i]
        gap[i] = max(d + change[i], min(d, closest))


class MultilevelContact:
    """An :class:`AdhesiveContact` whose load steps are predicted on coarser grids where these resolve the law.

    Parameters as for :class:`AdhesiveContact`.
    """

    def __init__(
        self,
        grid: Grid,
        contact_modulus: float,
        law: TractionLaw,
        shift: float,
        mean_stiffness: float = 0.0,
        threads: int = 1,
    ):
        arguments = (contact_modulus, law, shift, mean_stiffness, threads)
        self.finest = AdhesiveContact(grid, *arguments)
        self.coarser: MultilevelContact | None = None
        half = grid.with_shape((grid.shape[0] // 2, grid.shape[1] // 2))
        even = grid.shape[0] % 2 == 0 and grid.shape[1] % 2 == 0
        if even and min(half.shape) >= FEWEST_POINTS and _predicts(half, contact_modulus, law):
            self.coarser = MultilevelContact(half, *arguments)

    def equivalent_pairs(self, grid: Grid) -> float:
        """Transform pairs done so far on all grids, as float64 pairs on ``grid``."""
        coarser = self.coarser.equivalent_pairs(grid) if self.coarser else 0.0
        return self.finest.equivalent_pairs(grid) + coarser

    def solve(self, gap: np.ndarray, load: np.ndarray, tolerance: float, max_iterations: int) -> NewtonResult:
        """As :meth:`AdhesiveContact.solve`, after a prediction from the coarser grids."""
        if self.coarser:
            gap = self._predict(self.coarser, gap, load, max_iterations)
        return self.finest.solve(gap, load, tolerance, max_iterations)

    def _predict(
        self, coarser: "MultilevelContact", gap: np.ndarray, load: np.ndarray, max_iterations: int
    ) -> np.ndarray:
        pressure = self.finest.elastic_pressure(gap) + load
        coarse_gap = np.ascontiguousarray(gap[::2, ::2])
        coarse_load = pressure[::2, ::2] - coarser.finest.elastic_pressure(coarse_gap)
        result = coarser.solve(coarse_gap, coarse_load, COARSE_TOLERANCE, max_iterations)
        predicted = gap.copy()
        change = interpolate(result.gap - coarse_gap, self.finest.grid.shape)
        closest = CLOSEST_PREDICTION * self.finest.law.equilibrium_distance
        _correct(predicted.reshape(-1), change.reshape(-1), closest)
        return predicted
