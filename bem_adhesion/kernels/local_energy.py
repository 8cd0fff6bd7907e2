"""Local energy of the interface: a law or a wall, in a window of the grid or everywhere, and anchor springs."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from bem_adhesion.kernels.law import HELD, PINNED, blocks, kernels_of, law_gradient
from bem_adhesion.kernels.local_law import YIELDS, LocalLaw, YieldingKernels
from bem_adhesion.operators import Load, Window
from contact_study.numerics.kernel import inner_product
from contact_study.physics.laws import TractionLaw


class EnergyAndGradient(NamedTuple):
    """Energy, max|gradient|, Σ gradient² and Σ gradient at a gap; the sums run over all points."""

    energy: float
    largest: float
    square: float
    total: float


class LocalEnergy:
    """Energy of all points of an interface; a wall needs the largest stiffness of the solid (Pa/m).

    Outside the window no law acts; ``pointwise`` makes it differ inside. ``springs`` hold every point to a gap:
    stiffness (Pa/m), and that gap (m).
    """

    springs: tuple[float | np.ndarray, np.ndarray] | None = None

    def __init__(
        self, law: TractionLaw, largest: float = 1.0, window: Window | None = None, pointwise: LocalLaw | None = None
    ):
        self._kernels = kernels_of(law, largest)
        self.pointwise = pointwise or LocalLaw()
        self._yielding: Any = None  # points that do at their yield gap, since the last :meth:`hold`
        if self.pointwise.yield_gap is not None:
            self._kernels = YieldingKernels(self._kernels, self.pointwise.hardness)
        self._window = window
        self._inside: Any = window or ...
        self._held = self._kernels.held
        self.margin = self._kernels.margin

    def evaluate(
        self, gap: np.ndarray, traction: np.ndarray, stiffness: np.ndarray, here: slice = slice(None)
    ) -> float:
        """Write φ' and φ'' of the law, with the springs' part of φ'; return Σ φ over all points (J/m²).

        The gap is that of all rows, or of the rows ``here``.
        """
        if self._window is None:
            potential = self._kernels.evaluate(gap, traction, stiffness, *self.pointwise.arguments(here))
        else:
            inside = np.ascontiguousarray(gap[self._window])
            own_traction, own_stiffness = np.empty_like(inside), np.empty(inside.shape, stiffness.dtype)
            potential = self._kernels.evaluate(inside, own_traction, own_stiffness, *self.pointwise.arguments(here))
            traction[...], stiffness[...] = 0, 0
            traction[self._window], stiffness[self._window] = own_traction, own_stiffness
        if self.springs is not None:
            spring, anchor = self.springs
            stretch = gap - anchor
            pull = spring * stretch
            potential += 0.5 * inner_product(pull, stretch)
            traction += pull
        return potential

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        """Form the gradient as :meth:`LawKernels.gradient`, and add the springs to the curvature of free points."""
        if self._window is None:
            result = self._kernels.gradient(pressing, gap, traction, pressure, right_side, curvature)
        else:
            rows, columns = self._window

            def form(here, gradient, *constants):
                fields = pressing[here], gap[here], traction[here]
                return gradient(*fields, pressure, right_side[here], curvature[here], *constants)

            energy, largest, square, total = form((rows, columns), self._kernels.gradient)
            for here in ((rows, slice(columns.stop, None)), (slice(rows.stop, None), slice(None))):
                found = form(here, law_gradient, 0.0, np.inf)
                energy, largest = energy + found[0], max(largest, found[1])
                square, total = square + found[2], total + found[3]
            result = energy, largest, square, total
        if self.springs is not None:
            free = np.ones_like(curvature) if self._held is None else (curvature != self._held).astype(curvature.dtype)
            curvature += np.asarray(self.springs[0], np.float32) * free
        return result

    def energy_and_gradient(
        self, pressing: np.ndarray, gap: np.ndarray, load: Load, right_side: np.ndarray, curvature: np.ndarray
    ) -> EnergyAndGradient:
        """Write −gradient and φ'', raised where points are out of balance, given K d + field; block by block."""
        energy, largest, square, total = load.energy, 0.0, 0.0, 0.0
        for here, traction in self._blocks(gap):
            energy += self.evaluate(gap[here], traction, curvature[here], here)
            energy += load.rest_of_energy(pressing, gap, here)
            found = self.gradient(pressing[here], gap[here], traction, load.pressure, right_side[here], curvature[here])
            energy, largest = energy + found[0], max(largest, found[1])
            square, total = square + found[2], total + found[3]
        # A maximum passes over what is not a number.
        return EnergyAndGradient(energy, largest if np.isfinite(square) else np.inf, square, total)

    def traction(self, gap: np.ndarray, out: np.ndarray) -> float:
        """Write φ' alone; return Σ φ over all points (J/m²)."""
        total = 0.0
        for here, scratch in self._blocks(gap):
            total += self.evaluate(gap[here], scratch, np.empty(scratch.shape, np.float32), here)
            out[here] = scratch
        return total

    def imbalance(self, pressing: np.ndarray, gap: np.ndarray, pressure: float) -> float:
        """Return the mean of pressing + φ' + pressure over the points that do not touch a wall (Pa)."""
        total, free = 0.0, 0
        for here, traction in self._blocks(gap):
            self.evaluate(gap[here], traction, np.empty(traction.shape, np.float32), here)
            traction += pressing[here]
            moving = ~self._touching(gap[here])
            total, free = total + float(traction.sum(where=moving)), free + int(np.count_nonzero(moving))
        return total / free + pressure if free else 0.0

    def hold(self, curvature: np.ndarray, step: np.ndarray) -> None:
        """Set the step of the points that a wall holds to zero; keep which yield for :meth:`advance`."""
        if self._held is not None:
            step[curvature == self._held] = 0
        if self.pointwise.yield_gap is not None:
            self._yielding = (curvature == YIELDS)[self._inside]

    def without_yielding(self, gap: np.ndarray) -> np.ndarray:
        """Return a gap with those of points that yield raised to where they do, the gap to a surface so indented."""
        if self.pointwise.yield_gap is None:
            return gap
        raised = gap.copy()
        np.maximum(gap[self._inside], self.pointwise.yield_gap, out=raised[self._inside])
        return raised

    def pin(self, curvature: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """Set the curvature of points that touch a wall to a very large value; return which points touch."""
        held = self._touching(gap)
        if self._held is not None:
            curvature[held] = np.float32(PINNED / HELD) * self._held
        return held

    def reaction(self, pressing: np.ndarray, gap: np.ndarray, pressure: float) -> np.ndarray | float:
        """Return a wall's pressure, pressing + φ' + pressure where the gap is zero; zero without a wall."""
        if self._held is None:
            return 0.0
        reaction = np.zeros_like(gap)
        own, pressing, gap = reaction[self._inside], pressing[self._inside], gap[self._inside]
        for here in blocks(gap):
            traction = np.empty_like(gap[here])
            scratch = np.empty(traction.shape, np.float32)
            self._kernels.evaluate(gap[here], traction, scratch, *self.pointwise.arguments(here))
            np.copyto(own[here], pressing[here] + traction + pressure, where=gap[here] == 0)
        return reaction

    def advance(self, gap: np.ndarray, step: np.ndarray, limit: float, out: np.ndarray) -> None:
        """Write the gap after a Newton step, see :meth:`LawKernels.advance`."""
        if self._window is None:
            self._advance_law(gap, step, limit, out)
            return
        np.add(gap, step, out=out)
        inside, own_step = (np.ascontiguousarray(field[self._window]) for field in (gap, step))
        moved = np.empty_like(inside)
        self._advance_law(inside, own_step, limit, moved)
        out[self._window] = moved

    def _advance_law(self, gap: np.ndarray, step: np.ndarray, limit: float, out: np.ndarray) -> None:
        if isinstance(self._kernels, YieldingKernels):
            self._kernels.step(gap, step, limit, out, self.pointwise.yield_gap, self._yielding)
        else:
            self._kernels.advance(gap, step, limit, out)

    def _touching(self, gap: np.ndarray) -> np.ndarray:
        """Return which points touch a wall."""
        touching = np.zeros(gap.shape, bool)
        if self._held is not None:
            touching[self._inside] = gap[self._inside] == 0
        return touching

    def _blocks(self, gap: np.ndarray) -> Iterable[tuple[slice, np.ndarray]]:
        """Yield rows, and memory for a field on them; window and springs take all rows at once."""
        if self._window is not None or self.springs is not None:
            yield slice(None), np.empty_like(gap)
            return
        scratch = None
        for here in blocks(gap):
            rows = len(gap[here])
            scratch = np.empty_like(gap[here]) if scratch is None else scratch
            yield here, scratch[:rows]
