"""Contact of an elastic solid with a rigid rough solid that neither adheres nor gives way.

Pressure and gap satisfy the Signorini conditions, gap >= 0, pressure >= 0, gap × pressure = 0, at every point of the
grid, for a given mean pressure or mean gap. The algorithm is in :mod:`bem_adhesion.active_set`.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from bem_adhesion.active_set import ContactLevel
from bem_adhesion.arguments import check_arguments
from bem_adhesion.bounded_set import BoundedLevel
from bem_adhesion.linearised import LinearisedContact
from bem_adhesion.operator import periodic
from bem_adhesion.roughness import typical_wavenumber
from bem_adhesion.solution import Outcome, Solution
from bem_adhesion.tangent import PINNED, mean_stiffness
from contact_study.fields.arguments import check_step, positive
from contact_study.fields.grid import Grid
from contact_study.problem.elasticity import Elasticity, elasticity_of

SIMILAR_LOAD = 16
"""Change of the mean pressure, as a fraction, times points along the longer side, up to which an earlier state is a
better start than the coarser grids.

In one iteration the edge of contact moves by about a spacing. A fresh nested start costs 19 to 30 pairs at any load
and on any grid; from an earlier state it is 16 to 22 up to this limit, 20 to 30 at twice of it, 35 to 50 for a factor
of two in the load (256² to 1024², roughness cut off at 12 waves and at 8 points a wave)."""

LARGEST_SHARE = 1 - 1e-9
"""Share of the hardness up to which a pressure is looked for under gap control: no point of a grid is open then."""

AT_HARDNESS = 1e-8
"""Share of the hardness by which one of many points that yield may miss it, its mean over them found to rounding."""


class HardWallContact:
    """One rough surface against an elastic solid, to be solved at any number of loads.

    Parameters
    ----------
    height : numpy.ndarray, shape grid.shape
        Heights of the rigid surface, toward the block (m); their mean is of no consequence. Minus infinity is a point
        without a surface, see :class:`~bem_adhesion.free_contact.FreeContact`.
    grid : Grid
        The periodic grid; any shape. Shapes that can be halved converge in half the time.
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* = E / (1 − ν²) of a half-space (Pa).
    control : {"pressure", "gap"}
        What a step prescribes.
    tolerance : float, optional
        Largest gap inside the contact and largest penetration outside, in units of the rms height; under gap control
        also the largest error of the mean gap.
    max_iterations : int, optional
        Limit of active-set iterations on each grid.
    threads : int, optional
        Threads of the transforms.
    hardness : float, optional
        Largest pressure (Pa): points that carry it give way, see :class:`~bem_adhesion.plastic.PlasticContact`, which
        keeps what they gave way by.
    unit : float, optional
        Length that the tolerance is in units of, in place of the rms height (m): that of a surface before it yielded.

    Raises
    ------
    ValueError
        If a height is not finite, the shapes differ, the modulus, the tolerance or the hardness is not positive, or
        ``control`` is unknown.
    """

    def __init__(
        self,
        height: np.ndarray,
        grid: Grid,
        elasticity: Elasticity | float,
        control: str = "pressure",
        tolerance: float = 1e-10,
        max_iterations: int = 200,
        threads: int = 1,
        hardness: float | None = None,
        unit: float | None = None,
    ):
        check_arguments(np.where(np.isneginf(height), 0.0, height), grid, control, tolerance, max_iterations)
        self.control = control
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self.elasticity = elasticity_of(elasticity)
        self.grid = grid
        self.hardness = np.inf if hardness is None else positive("hardness", hardness, "Pa")
        self._height = height
        present = height[np.isfinite(height)]
        self._bounded = present.size == height.size
        self._mean_height = float(present.mean())
        mean_free = height - self._mean_height
        rms_height = float(np.sqrt(np.mean((present - self._mean_height) ** 2)))
        self._unit = unit or rms_height
        self._flat = rms_height <= np.finfo(float).eps * np.abs(present).max()
        if self._flat and not self._bounded:
            raise ValueError("height: a flat punch with free boundaries has no height to measure errors by")
        if not self._flat:
            period = max(grid.size)
            modulus = self.elasticity.contact_modulus
            self._pressure_unit = modulus * self._unit / period
            unit_grid = Grid(grid.shape, (grid.size[0] / period, grid.size[1] / period))
            mean_free /= self._unit
            make_operator = periodic(self.elasticity.scaled(period, modulus), threads=threads)
            self._level = (
                ContactLevel(mean_free, unit_grid, make_operator)
                if hardness is None
                else BoundedLevel(self.hardness / self._pressure_unit, mean_free, unit_grid, make_operator)
            )

    def separated(self) -> np.ndarray:
        """The state without contact to start from: no pressure anywhere (Pa), in no memory and read-only."""
        return np.broadcast_to(0.0, self.grid.shape)

    def step(self, state: np.ndarray, target: float) -> Solution:
        """The contact at a load. It is unique: the state to start from is a matter of work alone.

        Parameters
        ----------
        state : numpy.ndarray, shape grid.shape
            ``Solution.state`` of a similar contact, or :meth:`separated`: a pressure (Pa). It is the start, in place of
            the coarser grids, where its mean is near to the one asked for.
        target : float
            Mean pressure, >= 0 (Pa), or mean gap, >= 0 (m), as ``control`` says. Above the gap of first touch there is
            no contact, at zero the pressure is the least of full contact.

        Returns
        -------
        Solution
            ``residual`` is what ``tolerance`` bounds. Contact is where the pressure is positive; the gap there is zero.

        Raises
        ------
        ValueError
            If the target is negative or not finite, is a pressure not below the hardness, or the state has another
            shape.
        """
        check_step(self.control, target, state, self.grid.shape)
        if target < 0:
            raise ValueError(f"target = {target:g}: a hard wall without adhesion has no negative mean {self.control}")
        if self.control == "pressure" and target >= self.hardness:
            raise ValueError(f"target = {target:g}: no state carries the hardness, {self.hardness:g} Pa, or more")
        if self.control == "gap" and target == 0 and np.isfinite(self.hardness):
            raise ValueError("target = 0: with a hardness surfaces close at no one pressure; give a gap above zero")
        return self._at_pressure(state, target) if self.control == "pressure" else self._at_gap(state, target)

    def stiffness(self, solution: Solution) -> float:
        """−dp/dū of a state, mean pressure over mean gap (Pa/m): zero without contact, infinite in full contact.

        Parameters
        ----------
        solution : Solution
            A state of this contact.
        """
        touching = solution.state > 0
        if self._flat or touching.all():
            return np.inf if touching.all() else 0.0
        single = self._level.single
        shift = typical_wavenumber(np.where(np.isfinite(self._height), self._height, self._mean_height), self.grid)
        shift *= 0.5 * max(self.grid.size)  # K of that wave in units of the modulus over the period
        curvature = np.where(touching, np.float32(PINNED * single.largest), np.float32(0))
        found = mean_stiffness(LinearisedContact(single, shift), curvature, touching)
        return found * self.elasticity.contact_modulus / max(self.grid.size)

    def _at_pressure(self, state: np.ndarray, mean_pressure: float) -> Solution:
        if self._flat:
            return self._solution(np.full(self.grid.shape, mean_pressure), np.zeros(self.grid.shape))
        if mean_pressure == 0:
            flat = np.full(self.grid.shape, self._height.max())
            return self._solution(
                np.zeros(self.grid.shape), flat - self._height, surface=None if self._bounded else flat
            )
        level, load = self._level, mean_pressure / self._pressure_unit
        before = level.equivalent_pairs(level.grid)
        full_contact, surface, indentation = False, None, None
        if _similar(state, mean_pressure):
            level.start_from(state, load)
        else:
            full_contact = level.start(load, self.max_iterations)
        if full_contact and not level.exceeds():
            gap = np.zeros(self.grid.shape)
            residual, iterations, outcome = 0.0, 0, Outcome.CONVERGED
        else:
            residual, iterations, outcome = level.solve(load, self.tolerance, self.max_iterations)
            gap = level.gap()
            gap *= self._unit
            indentation = level.indentation()
            if indentation is not None:
                indentation *= self._unit
            if not self._bounded or indentation is not None:
                surface = level.surface() * self._unit + self._mean_height
        pairs = level.equivalent_pairs(level.grid) - before
        pressure = level.pressure * self._pressure_unit
        return self._solution(pressure, gap, residual, iterations, pairs, outcome, surface, indentation)

    def _at_gap(self, state: np.ndarray, mean_gap: float) -> Solution:
        """Found as the pressure that leaves that gap."""
        touch = self._height.max() - self._mean_height
        if self._flat or mean_gap >= touch:
            return self._solution(np.zeros(self.grid.shape), mean_gap + self._mean_height - self._height)
        least_full = self._level.least_full_contact_pressure() * self._pressure_unit
        if mean_gap == 0:
            return self._at_pressure(state, least_full * (1 + 1e-12))
        pairs = 0.0
        start = state

        def at(log_pressure: float) -> Solution:
            nonlocal pairs, start
            found = self._at_pressure(start, float(np.exp(log_pressure)))
            pairs += found.fft_pairs
            start = found.state
            return found

        def excess(log_pressure: float) -> float:
            difference = float(at(log_pressure).gap.mean()) - mean_gap
            return difference if abs(difference) > self.tolerance * self._unit else 0.0

        # Contact dies about exponentially with the gap, on the scale of the rms height.
        high = np.log(min(least_full, LARGEST_SHARE * self.hardness))
        low = high - mean_gap / self._unit
        while excess(low) < 0:
            high, low = low, low - 2.0
        root = brentq(excess, low, high, xtol=1e-15, rtol=1e-14)
        found = at(root)
        # Two solves of one pressure differ by their tolerance each.
        if found.converged and abs(float(found.gap.mean()) - mean_gap) > 3 * self.tolerance * self._unit:
            found = self._yielded_to(found, mean_gap)
        return replace(found, fft_pairs=pairs)

    def _yielded_to(self, found: Solution, mean_gap: float) -> Solution:
        """The state of a mean gap between those on either side of a pressure at which every touching point yields.

        Under a whole number of points times the hardness surfaces come nearer at no more pressure, the solid unchanged.
        """
        if np.isinf(self.hardness):
            return replace(found, outcome=Outcome.ITERATION_LIMIT)
        pressure = found.pressure
        yields = pressure > 0.5 * self.hardness
        away = np.where(yields, pressure - self.hardness, pressure)
        lift = (mean_gap - float(found.gap[~yields].sum()) / self.grid.points) / float(np.mean(~yields))
        gap = np.where(yields, 0.0, found.gap + lift)
        indentation = np.zeros(self.grid.shape) if found.plastic_indentation is None else found.plastic_indentation
        indentation = np.where(yields, indentation - lift, 0.0)
        if np.abs(away).max() > AT_HARDNESS * self.hardness or gap.min() < 0 or indentation.min() < 0:
            return replace(found, outcome=Outcome.ITERATION_LIMIT)
        return self._solution(
            np.where(yields, self.hardness, 0.0),
            gap,
            found.residual,
            found.iterations,
            surface=found.displacement + lift,
            indentation=indentation,
        )

    def _solution(
        self,
        pressure: np.ndarray,
        gap: np.ndarray,
        residual: float = 0.0,
        iterations: int = 0,
        pairs: float = 0.0,
        outcome: Outcome = Outcome.CONVERGED,
        surface: np.ndarray | None = None,
        indentation: np.ndarray | None = None,
    ) -> Solution:
        displacement = self._height + gap if surface is None else surface
        work = np.vdot(pressure, displacement) / self.grid.points
        elastic_energy = 0.5 * float(work - pressure.mean() * displacement.mean())
        elastic_energy += self.elasticity.compression_energy(float(pressure.mean()))
        beyond = None
        if np.isfinite(self.hardness):
            beyond = max(0.0, -float(pressure.min()), float(pressure.max()) - self.hardness)
            beyond /= self.elasticity.contact_modulus
        return Solution(
            pressure,
            displacement,
            gap,
            pressure,
            elastic_energy,
            0.0,
            residual,
            iterations,
            pairs,
            outcome,
            complementarity_residual=beyond,
            plastic_indentation=indentation,
        )


def _similar(pressure: np.ndarray, mean_pressure: float) -> bool:
    """Whether a state, without its tension if any, carries nearly that load (Pa)."""
    carried = float(np.maximum(pressure, 0).mean())
    return carried > 0 and abs(carried / mean_pressure - 1) * max(pressure.shape) <= SIMILAR_LOAD
