"""Adhesive contact of one rough surface, step after step: where the energy has several minima the path decides."""

from dataclasses import replace
from functools import partial
from threading import RLock
from typing import Any

import numpy as np

from bem_adhesion.adhesive.multigrid import MultigridSolver
from bem_adhesion.adhesive.newton import NewtonSolver
from bem_adhesion.kernels.law import blocks
from bem_adhesion.kernels.local_energy import LocalEnergy
from bem_adhesion.kernels.local_law import LocalLaw
from bem_adhesion.linear.conjugate_gradients import typical_wavenumber
from bem_adhesion.operators import Load, Trace, Window, Work, periodic
from bem_adhesion.solution import NewtonResult, Outcome, Solution, approach_stiffness, check_arguments, require_solution
from contact_study.numerics.arguments import step_arguments
from contact_study.numerics.balance import LIGHT
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product
from contact_study.numerics.memory import in_turn
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import Elasticity, elasticity_of

NO_TENSION = 1e-3  # over the law's peak: the gap at which the tension has fallen to this is out of reach
# Stiffness between core and tail, over the geometric mean of strongest softening and typical stiffness of the solid.
PRECONDITIONER_SHIFT = 0.22
GAP_CORRECTIONS = 20  # of the mean gap that a step holds where points yield
APPROACH_REFINEMENTS = 5  # solves at smaller and smaller tolerance until an approach is reached
TOUCHING = 1e-14  # rounding of a gap of zero outside a wall, over the largest height


def reach(law: TractionLaw) -> float:
    """Return the gap beyond which the tension is below a thousandth of its peak, or the repulsion ends (m)."""
    if not law.attracts:
        return law.equilibrium_distance
    nearer, farther = law.peak_distance, law.peak_distance + max(law.peak_distance, law.length)
    no_tension = NO_TENSION * law.peak_tensile_stress
    while law.traction(np.array(farther)) > no_tension:
        nearer, farther = farther, 2 * farther
    from scipy.optimize import brentq  # slow to import

    # SciPy's default tolerance is a length in metres, a hundredth of an atom's.
    exact = 1e-12 * law.length
    return float(brentq(lambda gap: float(law.traction(np.array(gap))) - no_tension, nearer, farther, xtol=exact))


class AdhesiveContact:
    """One rough surface against a solid under a law, see :func:`rough_contact`; heights outside the window are ignored.

    Inside, the units are the law's length and the contact modulus. Every step holds a mean gap by the pressure that it
    finds; the stiffness of solid and machine against a uniform pressure holds an approach. The work of adhesion varies
    in the window alone. With a hardness the gap and a mean gap are over the surface as this step has indented it.
    """

    def __init__(
        self,
        height: np.ndarray,
        grid: Grid,
        elasticity: Elasticity | float,
        law: TractionLaw,
        control: str = "pressure",
        tolerance: float = 1e-8,
        max_iterations: int = 2000,
        threads: int = 1,
        window: Window | None = None,
        trace: Trace | None = None,
        work_of_adhesion: np.ndarray | None = None,
        hardness: float = np.inf,
        machine_compliance: float = 0.0,
    ):
        self.turn = RLock()
        self.elasticity = elasticity_of(elasticity)
        check_arguments(grid, control, tolerance, max_iterations, self.elasticity, machine_compliance)
        self.height, self.law, self.grid = height, law, grid
        self.machine_compliance = machine_compliance  # per area (m/Pa)
        self.control, self.tolerance, self.max_iterations = control, tolerance, max_iterations
        self.hardness = hardness
        self._reach = reach(law)
        self._length = law.length
        self._law = law.scaled(self._length, self.elasticity.contact_modulus)
        self._grid = Grid(grid.shape, (grid.size[0] / self._length, grid.size[1] / self._length))
        self._inside: Any = window or ...
        self.strength = None if work_of_adhesion is None else work_of_adhesion / law.work_of_adhesion
        pointwise = LocalLaw.of(law, self.strength, hardness, height[self._inside].shape)
        self._local = LocalEnergy(law, window=window, pointwise=pointwise)
        solid = self.elasticity.scaled(self._length, self.elasticity.contact_modulus)
        inside, (dy, dx) = height[self._inside] / self._length, self._grid.spacing
        wavenumber = typical_wavenumber(inside, Grid(inside.shape, (inside.shape[0] * dy, inside.shape[1] * dx)))
        typical_stiffness = float(solid.stiffness(wavenumber))
        # Without softening there is no tail: the shift then only separates points that touch from those that do not.
        softening = self._law.strongest_softening or self._law.equilibrium_stiffness
        shift = PRECONDITIONER_SHIFT * np.sqrt(softening * typical_stiffness)
        self._machine_compliance = machine_compliance * self.elasticity.contact_modulus / self._length
        self._spring = 0.0
        if control == "approach":
            self._spring = approach_stiffness(solid, self._grid, self._machine_compliance)
        if control == "gap":
            # Steps towards a mean gap descend in an energy with a spring on it, as stiff as the solid's stiffest wave.
            self._spring = float(solid.stiffness_on(self._grid).max())
        self._work = Work(grid.points, trace)
        make_operator = periodic(solid, self._spring, threads, self._work)
        make_solver = partial(NewtonSolver, make_operator, self._law, shift)
        scaled = pointwise.scaled(self._length, self.elasticity.contact_modulus)
        self.levels = MultigridSolver(self._grid, make_solver, window, pointwise=scaled)
        self._heights = Load.of_heights(self.levels.finest.solid, height, 1 / self._length)

    def separated(self) -> np.ndarray:
        """Return the displacement of the undeformed solid just out of reach of the law (m)."""
        return np.full(self.height.shape, self.height.max() + self._reach)

    @in_turn
    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the equilibrium that a displacement (m) descends to under a new load, see :meth:`Contact.step`."""
        state, target = step_arguments(self.control, target, state, self.height.shape)
        gap = self._gap_of(state)
        closest = gap[self._inside].min()
        sign, inside = ("<", closest < 0) if self.law.has_wall else ("<=", self.law.diverges and not closest > 0)
        if inside:
            raise ValueError(f"the state to start from has gaps {sign} 0")
        out_of_reach = self._out_of_reach(gap)
        before = self._work.pairs
        if self.control == "gap":
            mean_gap = target / self._length + self._law.equilibrium_distance
            yield_gap = self.levels.finest.local.pointwise.yield_gap
            if yield_gap is not None and mean_gap <= float(yield_gap.mean()):
                raise ValueError(
                    f"target = {target:g}: with a hardness surfaces close at no one pressure; give a larger gap"
                )
            if out_of_reach:  # nothing deforms the solid on its way
                gap += max(mean_gap - gap.mean(), 0.0)
            if mean_gap == 0:  # only at a wall can all points close, at any pressure above that of opening
                gap[...] = 0
            result = self._hold_gap(gap, mean_gap, out_of_reach)
        elif self.control == "approach":
            first_touch = float(self.height[self._inside].max()) + self.law.equilibrium_distance
            result = self._hold_approach(gap, (first_touch - target) / self._length, out_of_reach)
        elif out_of_reach and target <= 0:
            return self._apart(Outcome.APART)
        else:
            result = self._solve(gap, self._load(target / self.elasticity.contact_modulus), out_of_reach)
        pairs = self._work.pairs - before
        if result.outcome is Outcome.DETACHED:
            return self._apart(Outcome.DETACHED, result.iterations, pairs)
        del gap  # the solver has overwritten it
        return self._solution(result, pairs)

    def _gap_of(self, displacement: np.ndarray) -> np.ndarray:
        """Return the gap of a displacement (m) in units of the law's length; zero for points that touch a wall."""
        gap = displacement - self.height
        gap /= self._length
        if self.law.has_wall:
            over_surface = gap[self._inside]
            touching = TOUCHING * max(self.height.max(), -self.height.min()) / self._length
            over_surface[np.abs(over_surface) <= touching] = 0.0
        # A rounding may be below the yield gap of points that have yielded.
        return self.levels.finest.local.without_yielding(gap)

    def _out_of_reach(self, gap: np.ndarray) -> bool:
        """Return whether the law acts on no point, for a gap in units of its length."""
        # Less by the rounding of a displacement that was stored and read.
        return bool(gap[self._inside].min() > (1 - 1e-6) * self._reach / self._length)

    @in_turn
    def stiffness(self, solution: Solution) -> float:
        """Return −dp/dū of a converged state of this contact (Pa/m); zero for separated surfaces."""
        require_solution(solution)
        if solution.detached:
            return 0.0
        gap = self._gap_of(solution.state)
        return self.levels.finest.mean_stiffness(gap) * self.elasticity.contact_modulus / self._length

    def _solve(self, gap: np.ndarray, load: Load, first_contact: bool, tolerance: float | None = None) -> NewtonResult:
        return self.levels.solve(gap, load, tolerance or self.tolerance, self.max_iterations, first_contact)

    def _load(self, pressure: float) -> Load:
        """Return the load at a mean pressure, in units of the contact modulus."""
        return replace(self._heights, pressure=pressure)

    def _hold_gap(self, gap: np.ndarray, mean_gap: float, first_contact: bool) -> NewtonResult:
        """Solve for a mean gap; what yields is no gap, so that the secant method finds what the solver has to hold."""
        held, iterations = mean_gap, 0
        previous: tuple[float, float] | None = None
        for _ in range(GAP_CORRECTIONS):
            result = self._solve(gap, replace(self._heights, mean_gap=held), first_contact)
            iterations += result.iterations
            gap, first_contact = result.gap, False
            error = 0.0
            if np.isfinite(self.hardness):
                error = float(np.mean(self.levels.finest.local.without_yielding(gap))) - mean_gap
            if result.outcome is not Outcome.CONVERGED or abs(error) <= self.tolerance:
                return replace(result, iterations=iterations)
            slope = 1.0 if previous is None else np.clip((error - previous[1]) / (held - previous[0]), 1e-3, 1.0)
            previous = held, error
            held -= error / slope
        return replace(result, iterations=iterations, outcome=Outcome.ITERATION_LIMIT)

    def _hold_approach(self, gap: np.ndarray, plane: float, first_contact: bool) -> NewtonResult:
        """Solve until the undeformed surface is at its height, too: a small residual may move a soft mean far."""
        tolerance, iterations = self.tolerance, 0
        for _ in range(APPROACH_REFINEMENTS):
            result = self._solve(gap, self._load(-self._spring * plane), first_contact, tolerance)
            iterations += result.iterations
            pressure, _ = self._pressure(result.gap * self._length, result.reaction)
            mean_pressure = float(pressure.mean()) / self.elasticity.contact_modulus
            displacement = float(np.mean(self.height)) / self._length + float(np.mean(result.gap))
            found = displacement - mean_pressure / self._spring
            # The force that extends a machine is known as a load would be.
            extension = self._machine_compliance * min(1.0, abs(mean_pressure) / LIGHT)
            if result.outcome is not Outcome.CONVERGED or abs(found - plane) <= self.tolerance * (1 + extension):
                return replace(result, iterations=iterations)
            gap, first_contact = result.gap, False
            tolerance *= 0.1
        return replace(result, iterations=iterations, outcome=Outcome.ITERATION_LIMIT)

    def _solution(self, result: NewtonResult, pairs: float) -> Solution:
        gap = result.gap
        gap *= self._length  # in place, to save a field at the peak of a step's memory
        displacement = self.height + gap
        pressure, interaction = self._pressure(gap, result.reaction)
        # In equilibrium K w is the interface pressure minus its mean: ½<w, K w> without another transform.
        mean = float(pressure.mean())
        work = sum(inner_product(pressure[here] - mean, displacement[here]) for here in blocks(gap))
        elastic = 0.5 * work / gap.size + self.elasticity.compression_energy(mean)
        pull = max(0.0, -float(np.min(result.reaction))) if self.law.has_wall else None
        outcome, indentation = result.outcome, None
        if np.isfinite(self.hardness):
            yielded, gap = gap, self._local.without_yielding(gap)
            indentation = gap - yielded
            interaction -= self.hardness * float(indentation.mean())
            if indentation[self._inside].all():
                outcome = Outcome.YIELDED
            beyond = (float(pressure.max()) - self.hardness) / self.elasticity.contact_modulus
            pull = max(pull or 0.0, beyond)
        end = result.residual, result.iterations, pairs, outcome, pull
        fields = displacement, displacement, gap, pressure, elastic, interaction
        return Solution(*fields, *end, plastic_indentation=indentation, law=self.law)

    def _pressure(self, gap: np.ndarray, reaction: np.ndarray | float) -> tuple[np.ndarray, float]:
        """Return the pressure of the interface at a gap in metres (Pa), and its energy per area (J/m²)."""
        pressure = np.empty_like(gap)
        interaction = self._local.traction(gap, pressure) / gap.size
        np.negative(pressure, out=pressure)
        pressure += reaction * self.elasticity.contact_modulus
        return pressure, interaction

    def _apart(self, outcome: Outcome, iterations: int = 0, pairs: float = 0.0) -> Solution:
        """Return separated surfaces: infinite gaps, no pressure; a later step starts from separation."""
        apart, shape = self.separated(), self.height.shape
        none = (0.0, 0.0, 0.0, iterations, pairs, outcome)
        return Solution(apart, apart, np.full(shape, np.inf), np.zeros(shape), *none, law=self.law)
