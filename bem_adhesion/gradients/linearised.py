"""The linearised equations of a state, and their adjoint state.

On the solver's grid a state u (displacement), P (mean pressure) satisfies, with the traction φ' of the law,

    R = K u + φ'(u − h) + P = 0 where points are free,   u = h where a wall holds them,   c(u, P) = 0 by the control.

The adjoint state (μ, ν, η) of a number J is (K + φ'') μ + ν c_u = J_u, 1ᵀμ + ν c_P = J_P, and η on held points what the
first equation leaves there.
"""

import warnings
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from bem_adhesion.adhesive.contact import PRECONDITIONER_SHIFT, AdhesiveContact
from bem_adhesion.contacts.rough_contact import FreeBoundaryContact
from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.linear.conjugate_gradients import typical_wavenumber
from bem_adhesion.operators import periodic
from bem_adhesion.solution import Solution, approach_stiffness
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product
from contact_study.physics.laws import TractionLaw

REDUCTION, ITERATIONS = 1e-11, 4000  # of the residual of an adjoint solve, and its limit
INVERSE_ITERATIONS, SETTLED = 12, 1e-10  # for the mode of a fold, until its curvature changes by this share
DIFFERENCE = 1e-5  # step of the derivative of φ'', over the law's length


class Adjoint(NamedTuple):
    """An adjoint state: of the equations of free points, of the control, and of held points."""

    points: np.ndarray
    control: float
    held: np.ndarray | float


class LinearisedState:
    """The linearised equations of a state, on the grid of the solver."""

    def __init__(self, contact: Any, solution: Solution):
        self.share, window = 1.0, None
        self.solution = solution
        self.height = np.asarray(contact.height)
        if isinstance(contact, FreeBoundaryContact):
            contact, window, self.share = contact.padded, contact.window, contact.share
        if not isinstance(contact, AdhesiveContact | HardWallContact):
            raise ValueError(f"contact: {type(contact).__name__} has no gradients; leave hardness and relaxation out")
        if not isinstance(solution, Solution) or not solution.converged or solution.detached:
            raise ValueError("solution: must be a converged state in contact, as a step returns it")
        if solution.state.shape != contact.grid.shape:
            raise ValueError(f"solution: is on {solution.state.shape} points, the contact on {contact.grid.shape}")
        self.free_boundary, self.inside = window is not None, window or (slice(None), slice(None))
        self.grid, self.solid, self.control = contact.grid, contact.elasticity, contact.control
        self.law: TractionLaw = contact.law
        self.strength = 1.0 if contact.strength is None else contact.strength
        self.area = float(np.prod(self.grid.size)) * self.share
        solid = self.solid.mean_stiffness_on(self.grid)
        series = approach_stiffness(self.solid, self.grid, contact.machine_compliance)
        self.solid_compliance, self.compliance = (1 / each if each else 0.0 for each in (solid, series))
        self.gap, touching = solution.gap, solution.pressure > 0
        if not self.law.bare_wall:
            touching = self.gap == 0 if self.law.has_wall else np.zeros(self.gap.shape, bool)
        self.held, self.curvature = np.zeros(self.grid.shape, bool), np.zeros(self.grid.shape)
        self.held[self.inside] = touching
        self.traction = np.zeros(self.height.shape)
        if not self.law.bare_wall:
            self.traction = self.strength * self.law.traction(self.gap)
            self.curvature[self.inside] = self.strength * self.law.stiffness(self.gap)
        # Where the control fixes the mean, a spring on it keeps the equations positive definite.
        stiffest = float(self.solid.stiffness_on(self.grid).max())
        self.spring = {"pressure": 0.0, "gap": stiffest, "approach": 1 / self.compliance if self.compliance else 0.0}[
            self.control
        ]
        self.operator = periodic(self.solid, self.spring)(self.grid)
        rows, columns = self.height.shape
        own = Grid((rows, columns), (rows * self.grid.spacing[0], columns * self.grid.spacing[1]))
        typical = float(self.solid.stiffness(typical_wavenumber(self.height, own)))
        softening = 0.0 if self.law.bare_wall else self.law.strongest_softening or self.law.equilibrium_stiffness
        shift = PRECONDITIONER_SHIFT * np.sqrt(softening * typical) or typical
        self.core = np.where(self.held, np.inf, np.maximum(self.curvature, 0.0))
        self.tail = np.where(self.held, 0.0, shift / (np.where(self.held, 0.0, self.core) + shift))
        self.inverse = self.operator.inverse_shifted(shift)
        self.iterations, self.solves = 0, 0

    @property
    def pressure(self) -> float:
        """Mean pressure on the solver's grid (Pa)."""
        return float(np.mean(self.solution.pressure)) * self.share

    @cached_property
    def flexure(self) -> np.ndarray:
        """K u on the solver's grid, the pressure of the interface minus its mean (Pa)."""
        flexure = np.full(self.grid.shape, -self.pressure)
        flexure[self.inside] += self.solution.pressure
        return flexure

    @property
    def bending_energy(self) -> float:
        """½<u, K u> (J/m²)."""
        compression = 0.5 * self.pressure**2 * self.solid_compliance
        return self.solution.elastic_energy * self.share - compression

    def adjoint(self, by_displacement: np.ndarray | float, by_pressure: float = 0.0) -> Adjoint:
        """Solve the adjoint equations of a number from its derivatives J_u and J_P."""
        by_displacement = np.broadcast_to(by_displacement, self.grid.shape)
        points = self.grid.points
        if self.control == "gap":
            along, rest = self._solved(by_displacement), self._solved(np.full(self.grid.shape, 1 / points))
            # (K + φ'' + spring) μ = J_u + (spring J_P − ν) c_u, with 1ᵀμ = J_P.
            beyond = (by_pressure - float(along.sum())) / float(rest.sum()) if rest.any() else 0.0
            state, control = along + beyond * rest, self.spring * by_pressure - beyond
        else:
            state = self._solved(by_displacement + self.spring * by_pressure / points)
            # Of a pressure ν = J_P − 1ᵀμ; of an approach c_P = −1/spring.
            control = by_pressure - float(state.sum())
            control *= -self.spring if self.control == "approach" else 1.0
        return self._with_held(state, control, by_displacement)

    def mode(self) -> Adjoint:
        """Return the mode of the least curvature under the control, by inverse iteration."""
        state = np.where(self.held, 0.0, 1.0)
        if self.control == "gap":
            state[self.inside] *= self.gap - self.gap.mean()
        least = np.inf
        for _ in range(INVERSE_ITERATIONS):
            state = state / np.sqrt(inner_product(state, state))
            found = self.adjoint(state)
            before, least = least, 1 / inner_product(state, found.points)
            state = found.points
            if abs(least - before) <= SETTLED * abs(least):
                break
        size = np.sqrt(inner_product(state, state))
        return self._with_held(state / size, found.control / size, np.zeros(self.grid.shape))

    def _with_held(self, state: np.ndarray, control: float, by_displacement: np.ndarray) -> Adjoint:
        if not self.held.any():
            return Adjoint(state, control, 0.0)
        self.operator.field[...] = state
        rest = by_displacement - self.operator.apply(self.operator.stiffness)
        # The field has the spring on the mean, and ν c_u is that of the control.
        rest += self.spring * state.mean()
        if self.control != "pressure":
            rest -= control / self.grid.points
        return Adjoint(state, control, np.where(self.held, rest, 0.0))

    def _solved(self, right_side: np.ndarray) -> np.ndarray:
        """Solve (K + spring + φ'') x = b for free points, x = 0 for held ones."""
        from scipy.sparse.linalg import LinearOperator, cg  # slow to import

        def apply(x: np.ndarray) -> np.ndarray:
            x = np.where(self.held, 0.0, x.reshape(self.grid.shape))
            self.operator.field[...] = x
            return np.where(self.held, 0.0, self.operator.apply(self.operator.stiffness) + self.curvature * x).ravel()

        def precondition(r: np.ndarray) -> np.ndarray:
            r = r.reshape(self.grid.shape)
            root = np.sqrt(self.tail)
            self.operator.field[...] = root * r
            smooth = root * self.operator.apply(self.inverse)
            return ((1 - self.tail) / (self.core + 0.5 * self.operator.largest) * r + smooth).ravel()

        def count(_: np.ndarray) -> None:
            self.iterations += 1

        self.solves += 1
        size = right_side.size, right_side.size
        system, inverse = (LinearOperator(size, each, dtype=float) for each in (apply, precondition))
        b = np.where(self.held, 0.0, right_side).ravel()
        x, failed = cg(system, b, rtol=REDUCTION, maxiter=ITERATIONS, M=inverse, callback=count)
        if failed or not np.all(np.isfinite(x)):
            warnings.warn(
                f"gradient: the linear solve did not converge in {ITERATIONS} iterations; the state is at the end of "
                "its branch, or not a minimum",
                stacklevel=4,
            )
        return x.reshape(self.grid.shape)

    def fold_distance(self, mode: np.ndarray) -> float:
        """Estimate from a mode how far the target may change until the branch ends, with sign (Pa or m).

        Along a mode v of the curvature λ the equations are λ s + ½ κ s² + f t = 0 with κ = Σ φ''' v³ and f = R_t·v:
        they have a solution until t = λ²/(2 κ f).
        """
        if self.law.bare_wall:
            return np.inf
        size = inner_product(mode, mode)
        if not size:
            return np.inf
        mode = mode / np.sqrt(size)
        self.operator.field[...] = mode
        least = inner_product(mode, self.operator.apply(self.operator.stiffness) + self.curvature * mode)
        if self.control == "gap":
            least -= self.spring * mode.mean() ** 2 * mode.size
        step = DIFFERENCE * self.law.length
        nearer = self.gap - step if not self.law.has_wall else np.maximum(self.gap - step, 0.0)
        third = self.strength * (self.law.stiffness(self.gap + step) - self.law.stiffness(nearer))
        third = third / (self.gap + step - nearer)
        bent = float(np.sum(third * mode[self.inside] ** 3))
        force = {"pressure": self.share * float(mode.sum()), "approach": self.spring * float(mode.sum())}.get(
            self.control, float(np.sum(self.curvature * mode))
        )
        return least**2 / (2 * bent * force) if bent * force else np.inf
