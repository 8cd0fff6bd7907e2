"""An adhesive contact at a gap: its energy, what is out of balance, and how the law curves.

For the solver that descends in that energy (:mod:`bem_adhesion.adhesive.newton`). The residual is formed in float64,
and on the way to it K (d + h) follows the changes of d, whose transforms are in float32. Stresses are in units of the
contact modulus; lengths in any, of order one for the sake of float32.
"""

from functools import partial

import numpy as np

from bem_adhesion.kernels.law import EnergyAndGradient
from bem_adhesion.kernels.wall import passes_of
from bem_adhesion.operators.fourier import MakeOperator
from bem_adhesion.operators.free_space import Window
from bem_adhesion.operators.load import FieldLoad, Load
from contact_study.numerics.balance import ROUNDING, Excess, excess
from contact_study.numerics.grid import Grid
from contact_study.numerics.memory import Memory
from contact_study.physics.laws.base import TractionLaw

# A step changes K (d + h) by K of the change, in float32. What that rounds off is less than this fraction of the
# largest change times the largest K (at most 2.8e-7 of 3000 changes, 32² to 1024² points). It is formed anew where all
# that was rounded off since the last time may be more than a share of the residual.
CHANGE_ROUNDING, SHARE_OF_RESIDUAL = 3e-7, 0.1


class ContactEnergy:
    """The discretised contact on one grid, evaluated at one gap after another.

    Parameters
    ----------
    grid : Grid
        The periodic grid.
    make_operator : MakeOperator
        The elastic solid. Its mean stiffness is that of the spring which carries the mean gap, zero under pressure
        control.
    law : TractionLaw
        The law of interaction.
    window : Window, optional
        Where on the grid there is a surface; everywhere without one.
    memory : Memory, optional
        Where its arrays lie.

    Attributes
    ----------
    window : Window
        Where there is a surface.
    solid : Operator
        The elastic solid, K d and the load's field at the last gap in its field.
    curvature : numpy.ndarray of float32, shape grid.shape
        φ'' at the last gap that was evaluated.
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
        self._passes = passes_of(law, self.solid.largest, window)
        self._free_passes = self._passes
        self._rounded = 0.0
        self.curvature = memory.array(grid.shape, np.float32)
        self._right_side = memory.array(grid.shape, np.float32)

    def imbalance_at(self, gap: np.ndarray, load: Load) -> tuple[EnergyAndGradient, bool]:
        """What is out of balance at a gap, and whether the surfaces separate for ever."""
        state = self._evaluate(gap, load)
        return state, self._runs_away(gap, state)

    def press(self, gap: np.ndarray, load: Load) -> np.ndarray:
        """K d and the load's field in the field of the solid; a solve may go on from it."""
        self._rounded = 0.0
        return load.press(gap, self.solid)

    def load_that_presses(self, pressing: np.ndarray, gap: np.ndarray, pressure: float) -> FieldLoad:
        """The load whose field and K d of a gap are given together; a solve may go on from them."""
        self._rounded = 0.0
        self.solid.field[...] = gap
        load = FieldLoad(pressing - self.solid.apply(self.solid.stiffness), pressure)
        self.solid.field[...] = pressing
        return load

    def interpolated(self, coarser: "ContactEnergy", values: np.ndarray) -> np.ndarray:
        """A field on a coarser grid, on this one, to single precision; in a buffer of which a solve takes hold."""
        coarser._single.field[...] = values
        return self._single.interpolate(coarser._single)

    def imbalance(self, gap: np.ndarray, load: Load) -> float:
        """Mean of K d + φ'(d) + load over the points that are free to move, of a gap that was evaluated last."""
        return self._passes.imbalance(self.solid.field, gap, load.pressure)

    def _evaluate(self, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Energy and gradient at a gap; fills curvature, right side, and the field of the solid as :meth:`press`."""
        self.press(gap, load)
        return self._state(gap, load)

    def _evaluate_change(self, gap: np.ndarray, new: np.ndarray, load: Load) -> EnergyAndGradient:
        """As :meth:`_evaluate` at a new gap, by the change from the one that was evaluated last."""
        change = self._single.field
        np.subtract(new, gap, out=change, casting="same_kind")
        largest = max(float(change.max()), -float(change.min()))
        self.solid.field += self._single.apply(self._single.stiffness)
        self._rounded += CHANGE_ROUNDING * largest * self.solid.largest
        return self._state(new, load)

    def _evaluate_from(self, known: np.ndarray | None, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """As :meth:`_evaluate`, from the gap that was pressed last, if there is one."""
        if known is None:
            return self._evaluate(gap, load)
        if known is gap:
            return self._state(gap, load)
        return self._unless_rounded(self._evaluate_change(known, gap, load), gap, load)

    def _unless_rounded(self, state: EnergyAndGradient, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """The state, evaluated anew where rounding may show in its residual."""
        return self._evaluate(gap, load) if self._rounded > SHARE_OF_RESIDUAL * state.largest else state

    def excess_of(self, state: EnergyAndGradient, gap: np.ndarray, load: Load, tolerance: float) -> Excess:
        """What is out of balance at a gap that was evaluated last, over what may be, see :func:`excess`."""
        pressure = 0.0 if self.solid.mean_stiffness else load.pressure  # the spring that ties the mean carries the rest
        missing = state.total / gap.size
        if state.largest > tolerance:  # whatever the stress
            return excess(tolerance, state.largest, missing, pressure)
        field = self.solid.field
        stress = max(float(field.max()) + load.pressure, -float(field.min()) - load.pressure)
        return excess(tolerance, state.largest, missing, pressure, stress, self.rounding(gap), gap.size)

    def rounding(self, gap: np.ndarray) -> float:
        """Residual that the rounding of a gap leaves."""
        return ROUNDING * self.solid.largest * float(gap.max())

    def _take_back(self) -> None:
        """The solid's field as it was before the last change."""
        self.solid.field -= self._single.field

    def _state(self, gap: np.ndarray, load: Load) -> EnergyAndGradient:
        """Energy and gradient at a gap that was pressed last, or by its change."""
        return self._passes.balance(self.solid.field, gap, load, self._right_side, self.curvature)

    def _runs_away(self, gap: np.ndarray, state: EnergyAndGradient) -> bool:
        """Whether the surfaces separate for ever: pulled apart with every point past the peak of the law.

        The mean gap then has negative curvature and a gradient outwards, and both persist at any larger gap.
        """
        tension = self.solid.mean_stiffness == 0 and state.total < 0 and self._passes is self._free_passes
        return tension and bool(self.window.inside(gap).min() > self.law.peak_distance)
