"""The hereditary integral of a Prony series over the steps that a surface has made, summed anew at any time.

    h_i(t) = ∫ exp(−(t − s)/τ_i) u'(s) ds,        p(q, t) = (q/2) [E_∞ u + Σ E_i h_i],

u' constant in each step. Nothing is carried from step to step but the steps themselves.
"""

from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace, Viscoelastic
from research.state_checks.balance import PeriodicSurface

# Of the quadrature of what a step dissipates: Gauss's points on intervals that halve towards the step's beginning.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
# The first of them over the time in which the branch fades.
SHORTEST = 0.5


@dataclass
class History:
    """The way of a surface on a viscoelastic half-space."""

    solid: Viscoelastic
    grid: Grid
    times: list[float] = field(default_factory=lambda: [0.0])
    moves: list[np.ndarray] = field(default_factory=list)

    def go(self, displacement: np.ndarray, duration: float) -> None:
        """One step more, to a displacement whose mean is of no consequence (m), in a time (s)."""
        self.moves.append(displacement - displacement.mean() - self.displacement)
        self.times.append(self.times[-1] + duration)

    @property
    def displacement(self) -> np.ndarray:
        """At the end of the steps (m)."""
        return sum(self.moves, start=np.zeros(self.grid.shape))

    def carried(self, branch: int, time: float) -> np.ndarray:
        """h_i at a time that is not before the end of the last step but one (m)."""
        tau = self.solid.relaxation_times[branch]
        total = np.zeros(self.grid.shape)
        for begin, end, move in zip(self.times, self.times[1:], self.moves, strict=False):
            until = min(end, time)
            share = tau / (end - begin) * (np.exp(-(time - until) / tau) - np.exp(-(time - begin) / tau))
            total += share * move
        return total

    def shift(self, duration: float) -> tuple[HalfSpace, np.ndarray]:
        """What the next step of a duration (s) meets: p = (E q/2)(u + v) at its end, as E and v (m)."""
        shares = [tau / duration * -np.expm1(-duration / tau) for tau in self.solid.relaxation_times]
        modulus = self.solid.contact_modulus + float(np.dot(self.solid.branch_moduli, shares))
        end = self.times[-1] + duration
        rest = [  # as if the surface stood still, less what the step takes from where it stands
            branch * (self.carried(number, end) - share * self.displacement)
            for number, (branch, share) in enumerate(zip(self.solid.branch_moduli, shares, strict=True))
        ]
        return HalfSpace(modulus), sum(rest, start=np.zeros(self.grid.shape)) / modulus

    @property
    def pressure(self) -> np.ndarray:
        """At the end of the steps, but for its mean (Pa)."""
        springs = self.solid.contact_modulus * self.displacement
        for number, branch in enumerate(self.solid.branch_moduli):
            springs = springs + branch * self.carried(number, self.times[-1])
        return self._unit.elastic(springs)

    @property
    def stored(self) -> float:
        """In all springs at the end of the steps, per area (J/m²)."""
        energy = self.solid.contact_modulus * self._product(self.displacement, self.displacement)
        for number, branch in enumerate(self.solid.branch_moduli):
            carried = self.carried(number, self.times[-1])
            energy += branch * self._product(carried, carried)
        return 0.5 * energy

    @property
    def dissipated(self) -> float:
        """In the last step, per area, by quadrature of E_i h_i²/τ_i (J/m²)."""
        begin, end = self.times[-2:]
        length, move = end - begin, self.moves[-1]
        total = 0.0
        for number, (branch, tau) in enumerate(zip(self.solid.branch_moduli, self.solid.relaxation_times, strict=True)):
            # Within the step h fades from what it was, and grows by what the step adds.
            first = self.carried(number, begin)
            products = self._product(first, first), self._product(first, move), self._product(move, move)
            halvings = max(1, int(np.ceil(np.log2(length / (SHORTEST * tau)))))
            edges = length * np.concatenate([[0.0], 0.5 ** np.arange(halvings, -1, -1)])
            for left, right in pairwise(edges):
                at = left + 0.5 * (1 + NODES) * (right - left)
                fades, grows = np.exp(-at / tau), tau / length * -np.expm1(-at / tau)
                squares = fades**2 * products[0] + 2 * fades * grows * products[1] + grows**2 * products[2]
                total += 0.5 * (right - left) * branch / tau * float(WEIGHTS @ squares)
        return total

    @cached_property
    def _unit(self) -> PeriodicSurface:
        return PeriodicSurface(HalfSpace(1.0), self.grid)

    def _product(self, one: np.ndarray, other: np.ndarray) -> float:
        """Mean of u K v for a modulus of one."""
        return float(np.mean(one * self._unit.elastic(other)))
