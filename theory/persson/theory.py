"""Persson's theory of rough contact with adhesion, as Yang et al. used it.

C. Yang, B. N. J. Persson, J. Israelachvili, K. Rosenberg, EPL 84, 46004 (2008), arXiv:0808.3463, and B. N. J. Persson,
Surf. Sci. Rep. 61, 201 (2006), section 8. Stress diffuses with the magnification q (:mod:`theory.persson.diffusion`),
stopped at σ_a(q) of a crack of size 1/q; A* is the true area, U_el the energy of wavelengths shorter than 2π/q:

    σ_a² = 2α K γ_eff,     γ_eff A* = Δγ A*(q₁) − U_el,     U_el(q) = π ∫_q^q₁ K W(A) C q' dq'.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from contact_study.numerics.arguments import finite
from theory.datasets import Dataset, dataset_of
from theory.numerics.fixed_point import accelerated
from theory.persson.diffusion import StressDistribution, diffuse
from theory.persson.interface import IterationOptions, PerssonInterface


@dataclass(frozen=True)
class PerssonContact:
    """Hold the state of contact at one pressure, which :meth:`theory.PerssonTheory.at_pressure` returns.

    Attributes
    ----------
    theory : PerssonTheory
        The interface.
    pressure, detachment_stress : float, numpy.ndarray
        p, compression positive, and σ_a at the theory's magnifications (Pa).
    distribution : StressDistribution
        P(σ) at the highest magnification and A(q), in units of ``theory.stress_scale``.
    converged, stalled : bool
        Whether the residual met the tolerance and the stresses balance; or its change stopped falling.
    residual, iterations : float, int
        Largest change of σ_a in the last iteration over ``theory.stress_scale``; diffusions solved.

    Examples
    --------
    ``PerssonTheory(...).at_pressure(p)`` returns one, see :class:`theory.PerssonTheory`.
    """

    theory: "PerssonTheory"
    pressure: float
    detachment_stress: np.ndarray
    distribution: StressDistribution
    converged: bool
    stalled: bool
    residual: float
    iterations: int

    @property
    def contact(self) -> np.ndarray:
        """A(q)/A₀ at the magnifications."""
        return self.distribution.contact

    @property
    def relative_contact_area(self) -> float:
        """A(q₁)/A₀, the real contact area."""
        return float(self.contact[-1])

    @property
    def detached(self) -> bool:
        """True without contact: at no pressure the iteration ends near zero area, not on it."""
        return self.pressure <= 0 and self.relative_contact_area < 1e-6

    @property
    def advice(self) -> str:
        """The remedy for a state that did not converge."""
        if not self.balanced:
            bound = f"{self.theory.options.balance:g}; use more cells (PerssonTheory(cells=...)) or a higher pressure"
            return f"contact and edges carry {self.stress_balance:.3g} times the pressure, and not one within {bound}"
        return "the iteration oscillates; lower theory.alpha" if self.stalled else "raise solver.max_iterations"

    @property
    def effective_work_of_adhesion(self) -> np.ndarray:
        """γ_eff at the magnifications (J/m²)."""
        return self.theory.effective_work_of_adhesion(self.contact)

    @property
    def elastic_energy(self) -> float:
        """U_el(q_L) per nominal area (J/m²)."""
        return float(self.theory.elastic_energy(self.contact)[0])

    @property
    def adhesion_energy(self) -> float:
        """−Δγ A*(q₁) per nominal area (J/m²)."""
        return float(-self.theory.work_of_adhesion * self.relative_contact_area * self.theory.area_factor[-1])

    @property
    def energy(self) -> float:
        """Interfacial energy U = U_el − Δγ A* (J/m²)."""
        return self.elastic_energy + self.adhesion_energy

    @property
    def contact_stress(self) -> float:
        """Mean stress carried inside the contact, ∫ σ P dσ (Pa)."""
        return self.distribution.contact_stress * self.theory.stress_scale

    @property
    def edge_stress(self) -> float:
        """Mean stress carried at detached edges, −∫ σ_a g ds <= 0 (Pa); with the contact's it makes the pressure."""
        return self.distribution.edge_stress * self.theory.stress_scale

    @property
    def stress_balance(self) -> float:
        """Stress carried by contact and edges over the applied pressure: one, but for the cells; NaN at p = 0."""
        return (self.contact_stress + self.edge_stress) / self.pressure if self.pressure else np.nan

    @property
    def balanced(self) -> bool:
        """True if contact and edges carry the applied pressure within the bound of the options."""
        error, options = self.contact_stress + self.edge_stress - self.pressure, self.theory.options
        least = options.least_pressure * self.theory.stress_scale
        return abs(error) <= options.balance * max(abs(self.pressure), least)

    def pressure_density(self, edges: np.ndarray) -> np.ndarray:
        """Mean of P(σ) in bins (1/Pa), shape (n,) for n + 1 edges (Pa)."""
        scale = self.theory.stress_scale
        return self.distribution.bin_averages(np.asarray(edges) / scale) / scale

    def stress_density(self, edges: np.ndarray, wavevector: float) -> np.ndarray:
        """Mean of P(σ) in bins (1/Pa) between edges (Pa), without the roughness above a wavevector (1/m)."""
        theory, scale = self.theory, self.theory.stress_scale
        low, high = theory.wavevectors[[0, -1]]
        if not low < finite("wavevector", wavevector, "1/m") <= high * (1 + 1e-9):  # it may be a product
            span = f"from above {low:.6g} to {high:.6g}"
            raise ValueError(f"wavevector = {wavevector:g} 1/m: the magnifications go {span}")
        at = min(wavevector, high)
        end = theory.spectrum.full_contact_stress_variance(theory.solid.stiffness, np.array([at]))[0]
        below = theory.stress_variance[theory.wavevectors < at]
        variance = np.append(below[below < end], end) / scale**2
        boundary = np.interp(variance * scale**2, theory.stress_variance, self.detachment_stress)
        unit = np.sqrt(variance[-1])  # cells are graded for a last variance of one
        cells, options = theory.cells, theory.options.diffusion
        part = diffuse(self.pressure / scale / unit, variance / unit**2, boundary / scale / unit, cells, options)
        return part.bin_averages(np.asarray(edges) / scale / unit) / scale / unit

    def stress_densities(self, zetas: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """P(σ, ζ) as a function from edges (m + 1,) of bins (Pa) to means (n, m) (1/Pa), at ζ = q/q_L above one."""
        if self.detached:
            return lambda edges: np.zeros((zetas.size, edges.size - 1))
        return lambda edges: np.array(
            [self.stress_density(edges, float(q)) for q in zetas * self.theory.wavevectors[0]]
        )

    def quantities(self) -> dict[str, Any]:
        """All values but the mean gap by their names in a dataset; distributions are functions of bin edges."""
        names = ("relative_contact_area", "elastic_energy", "contact_stress", "edge_stress", "stress_balance")
        further = ("detachment_stress", "effective_work_of_adhesion", "converged", "detached", "iterations")
        return {name: getattr(self, name) for name in names + further} | {
            "mean_pressure": self.pressure,
            "interaction_energy": self.adhesion_energy,
            "pressure_pdf": self.pressure_density,
            "relative_contact_area_at": self.contact,
            "residual": self.residual * self.theory.stress_scale / self.theory.solid.contact_modulus,
        }

    def to_dataset(self, pressure_edges: np.ndarray | None = None, magnifications: np.ndarray | None = None) -> Dataset:
        """Give the state in the schema of ``theory.nc``, without the dimension of a path.

        The mean gap takes some forty states at higher pressures.

        Parameters
        ----------
        pressure_edges : numpy.ndarray, optional
            Edges of the bins of P(σ) (Pa); by default even ones over the whole distribution.
        magnifications : numpy.ndarray, optional
            ζ = q/q_L, above one, for P(σ, ζ) in ``pressure_pdf_at``.
        """
        theory, gap = self.theory, np.nan
        if self.pressure > 0:
            swept = theory.sweep(min(self.pressure, theory.stress_scale))
            gap = float(gap_integral(swept)(np.log(self.pressure)))
        low, high = self.distribution.edges[[0, -1]] * theory.stress_scale
        quantities, coordinates = {**self.quantities(), "mean_gap": gap}, {"wavevector": theory.wavevectors}
        if magnifications is not None:
            coordinates["magnification"] = np.asarray(magnifications, dtype=float)
            quantities["pressure_pdf_at"] = self.stress_densities(coordinates["magnification"])
        bins = dict.fromkeys(("pressure_pdf", "pressure_pdf_at"), (pressure_edges, (float(low), float(high))))
        return dataset_of(("persson",), quantities, bins, coordinates)


Response = Callable[[np.ndarray], tuple[StressDistribution, np.ndarray]]
# σ_a (Pa), its distribution, whether it converged or progress ended, the last change over the scale, and diffusions.
FixedPoint = tuple[np.ndarray, StressDistribution, bool, bool, float, int]


@dataclass(frozen=True)
class PerssonTheory(PerssonInterface):
    """Describe an interface to Persson's theory; the defaults are the paper's.

    Parameters
    ----------
    spectrum : RoughnessSpectrum
        Roughness, analytic or of one surface.
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* of a half-space (Pa).
    work_of_adhesion : float
        Δγ >= 0 (J/m²).
    energy_weight, beta : str, float, optional
        W(A): ``"paper"`` A[β + (1−β)A²]; ``"wang_mueser"`` A[5/9 − (2/9)A² + (2/3)A⁴]; ``"area"`` A.
    true_area : str, optional
        True over projected area: ``"persson"`` <√(1+|∇h|²)> of a Gaussian surface; ``"none"`` 1; ``"lattice"``
        <1/√(1+|∇h|²)>, for a substrate of atoms with a fixed number per projected area.
    alpha, stress_cap : float, optional
        α of the crack condition, and upper bound of σ_a, such as the law's largest tensile stress (Pa).
    nodes, cells, options : int, PerssonOptions, optional
        Magnifications and stress cells of the diffusion; constants of the numerics.

    Raises
    ------
    ValueError
        If a choice is unknown or a number is not possible.

    Examples
    --------
    >>> from theory import PerssonTheory, SelfAffineSpectrum
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> contact = PerssonTheory(spectrum, elasticity=93.7e9, work_of_adhesion=0.1).at_pressure(1e9)
    >>> bool(contact.converged and 0 < contact.relative_contact_area < 1)
    True
    """

    def at_pressure(
        self,
        pressure: float,
        start: np.ndarray | str = "adhered",
        tolerance: float = IterationOptions.tolerance,
        max_iterations: int = IterationOptions.max_iterations,
    ) -> PerssonContact:
        """Find the contact at a mean pressure, on the branch that ``start`` leads to.

        Parameters
        ----------
        pressure : float
            p, compression positive (Pa).
        start : numpy.ndarray or str, optional
            First σ_a at the magnifications (Pa), such as that of a neighbouring pressure; or ``"adhered"``, σ_a of
            conformal contact √(2α K Δγ); or ``"detached"``, zero. They differ where both states are stable.
        tolerance, max_iterations : optional
            Largest change of σ_a over the stress scale in the last iteration, and diffusions at most; it ends earlier
            where the change stops falling.
        """
        finite("pressure", pressure, "Pa")
        scale = self.stress_scale
        if isinstance(start, str):
            if start not in ("adhered", "detached"):
                raise ValueError(f"start = {start!r}: expected an array, 'adhered' or 'detached'")
            start = self.detachment_stress(np.full(self.nodes + 1, self.work_of_adhesion * (start == "adhered")))
        first = start if self.work_of_adhesion else np.zeros_like(start)
        variance = self.stress_variance / scale**2

        def respond(stress: np.ndarray) -> tuple[StressDistribution, np.ndarray]:
            """The distribution under a σ_a (Pa), and the square of the σ_a that follows (Pa²)."""
            found = diffuse(pressure / scale, variance, stress / scale, self.cells, self.options.diffusion)
            return found, 2 * self.alpha * self._stiffness * self.effective_work_of_adhesion(found.contact)

        options = replace(self.options.iteration, tolerance=tolerance, max_iterations=max_iterations)
        # Under compression there is one state, which the acceleration finds unless γ_eff passes through zero. Without
        # it a detached state exists as well: the damped iteration follows the branch of its start.
        iterate = self._accelerated if pressure > 0 else self._damped
        contact = PerssonContact(self, pressure, *iterate(respond, first, options))
        return contact if contact.balanced else replace(contact, converged=False)

    def _accelerated(self, respond: Response, stress: np.ndarray, options: IterationOptions) -> FixedPoint:
        """The σ_a that the distribution under it asks for, from a first one (Pa); damped where acceleration fails."""
        root, scale = self._root, self.stress_scale
        used = stress
        distribution: StressDistribution

        def update(square: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
            nonlocal used, distribution
            used = root(scale**2 * square)
            distribution, found = respond(used)
            found = found / scale**2
            change = float(np.max(np.abs(root(scale**2 * found) - used))) / scale
            # A magnification without detachment stress, before and after, has no effect.
            weight = ((square > 0) | (found > 0)).astype(float)
            return found - square, weight, change

        # σ_a² is smooth, continued below zero, where σ_a is not.
        limit = min(options.max_iterations, options.accelerated)
        start, bounds = (stress / scale) ** 2, (-np.inf, np.inf)
        _, change, spent = accelerated(update, start, bounds, options.tolerance, limit, 1.0, options.memory)
        if change <= options.tolerance or spent >= options.max_iterations:
            return used, distribution, change <= options.tolerance, False, change, spent
        return self._damped(respond, used, options, spent)

    def _damped(self, respond: Response, stress: np.ndarray, options: IterationOptions, spent: int = 0) -> FixedPoint:
        """Iterate σ_a with less relaxation at magnifications where the change alternates.

        The slope of σ_a has no bound where γ_eff passes through zero: each node needs its own damping.
        """
        relaxation, previous = np.full(stress.size, options.relaxation), np.zeros(stress.size)
        iterations = since = spent
        best = np.inf
        while True:
            distribution, square = respond(stress)
            iterations += 1
            difference = self._root(square) - stress
            change = float(np.max(np.abs(difference))) / self.stress_scale
            if not np.isfinite(change):
                raise FloatingPointError(f"σ_a is not finite after {iterations - spent} diffusions")
            if change < 0.5 * best:
                best, since = change, iterations
            converged = change <= options.tolerance
            stalled = not converged and iterations - since == options.patience
            if converged or stalled or iterations >= options.max_iterations:
                return stress, distribution, converged, stalled, change, iterations
            alternates = difference * previous < 0
            relaxation = np.where(alternates, 0.7 * relaxation, np.minimum(1.1 * relaxation, options.relaxation))
            stress, previous = stress + relaxation * difference, difference

    def sweep(
        self,
        lowest: float,
        per_decade: int = 12,
        tolerance: float = IterationOptions.tolerance,
        max_iterations: int = IterationOptions.max_iterations,
    ) -> tuple[PerssonContact, ...]:
        """States at rising pressures from ``lowest`` (Pa) to full contact, solved from there downward."""
        highest = self.options.full_contact * self.stress_scale
        if not 0 < lowest < highest:
            raise ValueError(f"lowest = {lowest:g} Pa: must lie between 0 and full contact at {highest:g} Pa")
        count = max(8, int(np.ceil(per_decade * np.log10(highest / lowest))))
        contacts: list[PerssonContact] = []
        start: np.ndarray | str = "adhered"
        for p in np.geomspace(highest, lowest, count + 1):
            contacts.append(self.at_pressure(float(p), start, tolerance, max_iterations))
            # γ_eff as a polynomial of ln p through up to three states.
            shares = {1: (1,), 2: (-1, 2), 3: (1, -3, 3)}[min(len(contacts), 3)]
            works = (k * each.effective_work_of_adhesion for k, each in zip(shares, contacts[-3:], strict=True))
            start = self.detachment_stress(np.asarray(sum(works)))
        return tuple(reversed(contacts))


def gap_integral(contacts: Sequence[PerssonContact]) -> Callable[[np.ndarray], np.ndarray]:
    """ū (m) over ln p, ∫_p^∞ (dU/dp') dp'/p' along a cubic spline of U(ln p) through states at rising pressures."""
    pressure, energy = (np.array([getattr(each, name) for each in contacts]) for name in ("pressure", "energy"))
    spline = CubicSpline(np.log(pressure), energy)
    nodes = spline.x
    points, weights = np.polynomial.legendre.leggauss(6)

    def between(start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """∫ (dU/dx) e^(−x) dx between points of one interval of the spline, by Gauss's rule."""
        half = 0.5 * (end - start)
        inside = start[..., None] + half[..., None] * (1 + points)
        return half * np.sum(weights * spline(inside, 1) * np.exp(-inside), axis=-1)

    rest = (contacts[-1].theory.full_contact_energy - energy[-1]) / pressure[-1]  # gained at the last pressure
    above = np.concatenate([np.cumsum(between(nodes[:-1], nodes[1:])[::-1])[::-1], [0.0]]) + rest

    def gap(x: np.ndarray) -> np.ndarray:
        interval = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
        return above[interval + 1] + between(x, nodes[interval + 1])

    return gap
