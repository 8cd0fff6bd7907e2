"""Contact of an elastic solid with a rigid rough solid that neither adheres nor gives way.

Pressure and gap satisfy the Signorini conditions, gap >= 0, pressure >= 0, gap × pressure = 0, at every point of the
grid, for a given mean pressure, mean gap or approach. The algorithm is in :mod:`bem_adhesion.hard_wall.active_set`.
"""

from dataclasses import replace

import numpy as np

from bem_adhesion.arguments import check_arguments
from bem_adhesion.hard_wall.pressure_controlled import PressureControlledWall
from bem_adhesion.hard_wall.pressure_search import find_pressure
from bem_adhesion.operators.trace import Trace
from bem_adhesion.solution import Outcome, Solution
from contact_study.numerics.arguments import step_arguments
from contact_study.numerics.exclusive import in_turn
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import Elasticity, elasticity_of

LARGEST_SHARE = 1 - 1e-9
"""Share of the hardness up to which a pressure is looked for: no point of a grid is open then."""

FIRST_SHARE = 1e-3
"""Share of what would hold an approach without a gap that closes: a pressure to look from."""

AT_HARDNESS = 1e-8
"""Share of the hardness by which one of many points that yield may miss it, its mean over them found to rounding."""


class HardWallContact(PressureControlledWall):
    """One rough surface against an elastic solid, to be solved at any number of loads.

    Parameters
    ----------
    height : numpy.ndarray, shape grid.shape
        Heights of the rigid surface, toward the block (m); their mean is of no consequence. Minus infinity is a point
        without a surface, see :class:`~bem_adhesion.contacts.free_boundary.FreeBoundaryContact`.
    grid : Grid
        The periodic grid; any shape. Shapes that can be halved converge in half the time.
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* = E / (1 − ν²) of a half-space (Pa).
    control : {"pressure", "gap", "approach"}
        What a step prescribes.
    tolerance : float, optional
        Largest gap inside the contact and largest penetration outside, in units of the rms height, for a nearly flat
        punch with free boundaries of a thousandth of its displacement; under control of the gap or the approach also
        its largest error.
    max_iterations : int, optional
        Limit of active-set iterations on each grid.
    threads : int, optional
        Threads of the transforms.
    hardness : float, optional
        Largest pressure (Pa): points that carry it give way, see
        :class:`~bem_adhesion.contacts.plastic.PlasticContact`, which keeps what they gave way by.
    unit : float, optional
        Length that the tolerance is in units of, in place of the rms height (m): that of a surface before it yielded.
    trace : Trace, optional
        Receiver of progress while a step is solved.

    Raises
    ------
    ValueError
        If a height is not finite, the shapes differ, the modulus, the tolerance or the hardness is not positive, or
        ``control`` is unknown or not known of the solid.
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
        trace: Trace | None = None,
    ):
        solid = elasticity_of(elasticity)
        heights = np.where(np.isneginf(height), 0.0, height)
        check_arguments(heights, grid, control, tolerance, max_iterations, solid)
        super().__init__(height, grid, solid, tolerance, max_iterations, threads, hardness, unit, trace)
        self.control = control

    @in_turn
    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """The contact at a load. It is unique: the state to start from is a matter of work alone.

        Parameters
        ----------
        state : numpy.ndarray, shape grid.shape, or Solution
            The solution of a similar contact, its ``state``, or :meth:`separated`: a pressure (Pa). It is the start,
            in place of the coarser grids, where its mean is near to the one asked for.
        target : float
            Mean pressure, >= 0 (Pa), mean gap, >= 0 (m), or approach (m), as ``control`` says: how far the solid has
            come beyond the place where, undeformed, its surface touches the highest point. Above the gap of first
            touch, or at an approach up to zero, there is no contact; at a gap of zero the pressure is the least of full
            contact.

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
        state, target = step_arguments(self.control, target, state, self.grid.shape)
        self._check_target(target)
        solve = {"pressure": self._at_pressure, "gap": self._at_gap, "approach": self._at_approach}[self.control]
        before = self._pairs()
        return replace(solve(state, target), fft_pairs=self._pairs() - before)

    def _check_target(self, target: float) -> None:
        if self.control == "approach":
            return
        if target < 0:
            raise ValueError(f"target = {target:g}: a hard wall without adhesion has no negative mean {self.control}")
        if self.control == "pressure" and target >= self._share * self.hardness:
            asked = target / self._share  # of free boundaries on the surface alone
            raise ValueError(f"target = {asked:g}: no state carries the hardness, {self.hardness:g} Pa, or more")
        if self.control == "gap" and target == 0 and np.isfinite(self.hardness):
            raise ValueError("target = 0: with a hardness surfaces close at no one pressure; give a gap above zero")

    def _at_gap(self, state: np.ndarray, mean_gap: float) -> Solution:
        """Found as the pressure that leaves that gap."""
        if self._flat or mean_gap >= self._height.max() - self._mean_height:
            return self._apart(self._mean_height + mean_gap)
        least_full = self._least_full_contact_pressure()
        if mean_gap == 0:
            return self._at_pressure(state, least_full * (1 + 1e-12))

        def excess(found: Solution) -> float:
            return float(found.gap.mean()) - mean_gap

        most = min(least_full, LARGEST_SHARE * self.hardness)
        # Contact dies about exponentially with the gap, on the scale of the rms height.
        first = most * np.exp(-mean_gap / self._unit)
        found = find_pressure(self._at_pressure, state, excess, self.tolerance * self._unit, first, most)
        # What has yielded has no gap.
        moving = float(np.mean(found.pressure <= 0.5 * self.hardness))
        return self._where_wanted(found, excess(found), self._unit, moving)

    def _at_approach(self, state: np.ndarray, approach: float) -> Solution:
        """Found as the pressure that brings it about."""
        highest = float(self._height.max())
        plane = highest - approach
        if approach <= self._rounding:
            return self._apart(plane)
        stiffness = self.elasticity.mean_stiffness_on(self.grid)

        def excess(found: Solution) -> float:
            return float(found.displacement.mean()) - float(found.pressure.mean()) / stiffness - plane

        first = float(state.mean()) or FIRST_SHARE * stiffness * approach
        uniform = stiffness * (self._mean_height - plane)
        if self._flat or (self._bounded and uniform >= self._least_full_contact_pressure()):
            first = uniform  # of full contact
        unit = self._unit_at(approach) or approach
        # Of small approaches their share: near first touch the surface is known to rounding.
        tolerance = self.tolerance * min(unit, approach)
        most = LARGEST_SHARE * self._share * self.hardness
        found = find_pressure(self._at_pressure, state, excess, tolerance, first, most)
        return self._where_wanted(found, excess(found), unit)

    def _where_wanted(self, found: Solution, excess: float, unit: float, moving: float = 1.0) -> Solution:
        """What was found, or where the pressure stands still while surfaces come nearer the state between.

        Parameters
        ----------
        found : Solution
            At the pressure in question.
        excess : float
            By how much its surfaces are too far apart (m).
        unit : float
            What that is measured in (m).
        moving : float, optional
            By how much that changes per movement of the solid.
        """
        # Two solves of one pressure differ by their tolerance each.
        if not found.converged or abs(excess) <= 3 * self.tolerance * unit:
            return found
        if np.isinf(self.hardness):
            return replace(found, outcome=Outcome.ITERATION_LIMIT)
        lift = -excess / moving
        if lift < 0 and float(found.pressure.mean()) > (2 * LARGEST_SHARE - 1) * self._share * self.hardness:
            return self._given_way(found, lift)
        return self._yielded_by(found, lift)

    def _yielded_by(self, found: Solution, lift: float) -> Solution:
        """The state of a solid moved as a whole beside a pressure at which every touching point yields.

        Under a whole number of points times the hardness surfaces come nearer at no more pressure, the solid unchanged.
        """
        pressure = found.pressure
        yields = pressure > 0.5 * self.hardness
        away = np.where(yields, pressure - self.hardness, pressure)
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

    def _given_way(self, found: Solution, lift: float) -> Solution:
        """The same where no point is left that does not yield: flagged, for no load holds the surfaces there."""
        there = np.isfinite(self._height)
        surface = found.displacement + lift
        return self._solution(
            np.where(there, self.hardness, 0.0),
            np.where(there, 0.0, np.inf),
            found.residual,
            found.iterations,
            Outcome.YIELDED,
            surface,
            np.where(there, np.maximum(self._height - surface, 0.0), 0.0),
        )
