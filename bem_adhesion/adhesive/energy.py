"""Energy of an adhesive contact at a gap, its gradient, and the curvature of the law.

The residual is formed in float64; between two full evaluations K (d + h) follows the changes of d by transforms in
float32. Stresses are in units of the contact modulus; lengths in any unit that makes them of order one in float32.
"""

from functools import partial

import numpy as np

from bem_adhesion.kernels.local_energy import EnergyAndGradient, LocalEnergy
from bem_adhesion.operators.fourier import MakeOperator
from bem_adhesion.operators.free_space import Window
from bem_adhesion.operators.load import FieldLoad, Load
from contact_study.numerics.balance import ROUNDING, Excess, excess
from contact_study.numerics.grid import Grid
from contact_study.numerics.memory import Memory
from contact_study.physics.laws.base import TractionLaw

# Upper bound of the rounding of K times a change in float32, as a fraction of the largest change times the largest K;
# K d is formed again where the rounding since the last time may exceed this share of the residual.
CHANGE_ROUNDING, SHARE_OF_RESIDUAL = 3e-7, 0.1


class ContactEnergy:
    """The discretised contact on one grid, evaluated at one gap after another.

    At the last gap the field of ``solid`` is K d with the load's field, and ``curvature`` is φ''.
    """

    def __init__(
        self,
        grid: Grid,
        make_operator: MakeOperator,
        law: TractionLaw,
        window: Window | None = None,
        memory: Memory | None = None,
    ):
        memory = memory or Memory()
        make = partial(make_operator, memory=memory)
        self.grid = grid
        self.law = law
        self.window = window or Window(grid.shape)
        self.solid = make(grid, np.float64)
        self._single = make(grid, np.float32)
        self.local = LocalEnergy(law, self.solid.largest, window)
        self._rounded = 0.0
        self.curvature = memory.array(grid.shape, np.float32)
        self._right_side = memory.array(grid.shape, np.float32)

    def imbalance_at(self, gap: np.ndarray, load: Load) -> tuple[EnergyAndGradient, bool]:
        """Evaluate a gap; return its energy and gradient, and whether the surfaces detach from there."""
        state = self._evaluate(gap, load)
        return state, self._is_detaching(gap, state)

    def press(self, gap: np.ndarray, load: Load) -> np.ndarray:
        """Write K d and the load's field into the field of the solid, from which a solve may continue."""
        self._rounded = 0.0
        return load.press(gap, self.solid)

    def load_for(self, pressing: np.ndarray, gap: np.ndarray, pressure: float) -> FieldLoad:
        """Make the load whose field and K d of a gap add up to ``pressing``; a solve may continue from them."""
        self._rounded = 0.0
        self.solid.field[...] = gap
        load = FieldLoad(pressing - self.solid.apply(self.solid.stiffness), pressure=pressure)
        self.solid.field[...] = pressing
        return load

    def interpolate(self, coarser: "ContactEnergy", values: np.ndarray) -> np.ndarray:
        """Interpolate a field on a coarser grid to single precision, into a buffer that a solve overwrites."""
        coarser._single.field[...] = values
        return self._single.interpolate(coarser._single)

    def imbalance(self, gap: np.ndarray, load: Load) -> float:
        """Return the mean of K d + φ'(d) + load over the free points, for a gap that was evaluated last."""
        return self.local.imbalance(self.solid.field, gap, load.pressure)

    def excess_of(self, state: EnergyAndGradient, gap: np.ndarray, load: Load, tolerance: float) -> Excess:
        """Compare the residual at a gap that was evaluated last with what is allowed, see :func:`excess`."""
        pressure = 0.0 if self.solid.mean_stiffness else load.pressure  # a spring on the mean carries the rest
        missing = state.total / gap.size
        if state.largest > tolerance:  # whatever the stress
            return excess(tolerance, state.largest, missing, pressure)
        field = self.solid.field
        stress = max(float(field.max()) + load.pressure, -float(field.min()) - load.pressure)
        return excess(tolerance, state.largest, missing, pressure, stress, self.rounding(gap), gap.size)

    def rounding(self, gap: np.ndarray) -> float:
        """Return the residual that the rounding of a gap leaves."""
        return ROUNDING * self.solid.largest * float(gap.max())

    def _evaluate(self, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Evaluate energy and gradient; fill curvature, right side, and the field of the solid as :meth:`press`."""
        self.press(gap, load)
        return self._pressed(gap, load)

    def _evaluate_change(self, gap: np.ndarray, new: np.ndarray, load: Load) -> EnergyAndGradient:
        """Evaluate as :meth:`_evaluate` at a new gap, by the change from the one that was evaluated last."""
        change = self._single.field
        np.subtract(new, gap, out=change, casting="same_kind")
        largest = max(float(change.max()), -float(change.min()))
        self.solid.field += self._single.apply(self._single.stiffness)
        self._rounded += CHANGE_ROUNDING * largest * self.solid.largest
        return self._pressed(new, load)

    def _evaluate_from(self, known: np.ndarray | None, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Evaluate as :meth:`_evaluate`, from the gap that was pressed last, if there is one."""
        if known is None:
            return self._evaluate(gap, load)
        if known is gap:
            return self._pressed(gap, load)
        return self._unless_rounded(self._evaluate_change(known, gap, load), gap, load)

    def _unless_rounded(self, state: EnergyAndGradient, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Return the state, evaluated again where rounding may show in its residual."""
        return self._evaluate(gap, load) if self._rounded > SHARE_OF_RESIDUAL * state.largest else state

    def _undo_change(self) -> None:
        """Restore the solid's field before the last change."""
        self.solid.field -= self._single.field

    def _pressed(self, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Evaluate energy and gradient at a gap whose K d is in the solid's field."""
        return self.local.energy_and_gradient(self.solid.field, gap, load, self._right_side, self.curvature)

    def _is_detaching(self, gap: np.ndarray, state: EnergyAndGradient) -> bool:
        """Return whether a tension separates the surfaces with every point beyond the peak of the law.

        The mean gap then has negative curvature and an outward gradient, and both persist at any larger gap.
        """
        tension = self.solid.mean_stiffness == 0 and state.total < 0 and not self.local.anchored
        return tension and bool(self.window.inside(gap).min() > self.law.peak_distance)
