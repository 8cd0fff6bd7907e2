"""A law that differs from point to point: its strength, and the gap at which a point yields under a hardness.

The strength multiplies energy, traction and curvature; equilibrium and range stay. A point at the pressure H of the
hardness yields: its law is continued below that gap by the constant pressure, φ + H times the depth. This is convex, so
that a step with yielding is a minimum of an energy as any other; what is below is permanent once the step has ended.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from bem_adhesion.kernels.law import CAUTION, LawKernels
from contact_study.numerics.kernel import kernel
from contact_study.physics.laws import TractionLaw

# Curvature of a point that yields at its yield gap, on whose other side it is elastic: a mark, as that of a held point.
YIELDS = np.float32(1e-30)


@dataclass(frozen=True)
class LocalLaw:
    """Strength and yield gap on a grid or in its window, in units of the law; None where all points are alike."""

    strength: np.ndarray | None = None
    hardness: float = np.inf
    yield_gap: np.ndarray | None = None

    @classmethod
    def of(cls, law: TractionLaw, strength: np.ndarray | None, hardness: float, shape: tuple[int, ...]) -> "LocalLaw":
        """Find the gap at which each point of a law yields."""
        if np.isinf(hardness):
            return cls(strength)
        carried = np.asarray(-hardness) if strength is None else -hardness / strength
        yields = np.zeros(()) if law.has_wall else law.repulsive_gap(carried)
        return cls(strength, hardness, np.broadcast_to(yields, shape))

    @property
    def uniform(self) -> bool:
        """Whether nothing changes the law."""
        return self.strength is None and self.yield_gap is None

    @property
    def strongest(self) -> float:
        """Largest strength."""
        return 1.0 if self.strength is None else float(self.strength.max())

    def scaled(self, length: float, stress: float) -> "LocalLaw":
        """Divide lengths by ``length`` and stresses by ``stress``."""
        yields = None if self.yield_gap is None else self.yield_gap / length
        return LocalLaw(self.strength, self.hardness / stress, yields)

    def on(self, here: Any) -> "LocalLaw":
        """Return that of some points, in memory of its own."""
        strength, yields = (None if each is None else np.ascontiguousarray(each[here]) for each in self._fields)
        return LocalLaw(strength, self.hardness, yields)

    def arguments(self, here: Any) -> tuple[np.ndarray | None, ...]:
        """Return what :meth:`LawKernels.evaluate`, or that of :class:`YieldingKernels`, takes for some points."""
        strength, yields = (None if each is None else each[here] for each in self._fields)
        return (strength,) if yields is None else (strength, yields)

    @property
    def _fields(self) -> tuple[np.ndarray | None, ...]:
        return self.strength, self.yield_gap


class YieldingKernels(LawKernels):
    """Kernels of a law with a hardness, outside a wall or not, by those without one."""

    def __init__(self, elastic: LawKernels, hardness: float):
        super().__init__(elastic.law)
        self._elastic, self._hardness = elastic, hardness
        self.margin, self.held = elastic.margin, elastic.held

    def evaluate(self, gap, traction, stiffness, strength=None, yield_gap=0.0):
        depth = yield_gap - gap
        total = self._elastic.evaluate(np.maximum(gap, yield_gap), traction, stiffness, strength)
        yields = depth > 0
        traction[yields], stiffness[yields] = -self._hardness, 0
        if not self.law.has_wall:
            traction[depth == 0] = -self._hardness  # without a rounding: so it is known in the gradient
        return total + self._hardness * float(depth.sum(where=yields))

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        if not self.law.has_wall:
            found = self._elastic.gradient(pressing, gap, traction, pressure, right_side, curvature)
            curvature[(traction == -self._hardness) & (right_side < 0)] = YIELDS
            return found
        constants = self.margin, self.held, self._hardness, YIELDS
        return _yielding_wall_gradient(pressing, gap, traction, pressure, *constants, right_side, curvature)

    def step(self, gap, step, limit, out, yield_gap, yielding):
        """Advance as :meth:`LawKernels.advance`; points below the yield gap, or ``yielding`` at it, move freely.

        None passes the yield gap, where the curvature changes: there the gradient decides to which side a point goes.
        """
        self._elastic.advance(np.maximum(gap, yield_gap), step, limit, out)
        np.maximum(out, yield_gap, out=out)
        np.copyto(out, np.minimum(gap + step, yield_gap), where=(gap < yield_gap) | yielding)


@kernel
def _yielding_wall_gradient(pressing, gap, traction, pressure, margin, held, hardness, mark, right_side, curvature):
    """Form the gradient outside a wall that carries up to ``hardness``; points beyond move and have the curvature."""
    energy = largest = square = total = 0.0
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            d = gap[i, j]
            carried = pressing[i, j] + pressure
            gradient = carried + traction[i, j]
            energy += (0.5 * pressing[i, j] + pressure) * d
            if d == 0.0 and gradient > 0.0 and carried <= hardness:
                right_side[i, j] = 0.0
                curvature[i, j] = held
                continue
            if d < 0.0:
                curvature[i, j] = mark
            elif d == 0.0 and gradient > 0.0:
                gradient = carried - hardness
                curvature[i, j] = mark
            else:
                curvature[i, j] += CAUTION * abs(gradient) / (d + margin)
            right_side[i, j] = -gradient
            largest = max(largest, abs(gradient))
            square += gradient * gradient
            total += gradient
    return energy, largest, square, total
