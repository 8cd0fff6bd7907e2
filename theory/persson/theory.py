"""Persson's theory of rough contact with adhesion, as Yang et al. used it.

C. Yang, B. N. J. Persson, J. Israelachvili and K. Rosenberg, EPL 84, 46004 (2008), arXiv:0808.3463, with B. N. J.
Persson, Surf. Sci. Rep. 61, 201 (2006), arXiv:cond-mat/0603807, section 8. The contact is studied at growing
magnification q: its stress distribution diffuses with the roughness added (:mod:`theory.persson.diffusion`), stopped at
the detachment stress σ_a(q) of a crack of size 1/q,

    σ_a² = 2α K(q) γ_eff(q),     γ_eff(q) A*(q) = Δγ A*(q₁) − U_el(q),

where A*(q) is the true area in contact and U_el(q) the elastic energy stored at wavelengths shorter than 2π/q,

    U_el(q) = π ∫_q^q₁ K(q') W(A(q')) C(q') q' dq'.

The paper has a half-space, K = E* q/2: then σ_a² = α E* q γ_eff and U_el = (π/2) E* ∫ q'² W C dq'. Any other solid
enters by its stiffness K(q) of a wave, and by the stress variance 2π ∫ K² q C dq of full contact. For independent
springs the crack condition is then exact: the energy σ²/2K of a spring is released.

A(q) and σ_a(q) depend on each other at all magnifications: :mod:`theory.persson.iteration` finds them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_study.numerics.arguments import finite
from theory.datasets import dataset_of
from theory.persson.diffusion import StressDistribution, diffuse
from theory.persson.gap_integral import GapIntegral
from theory.persson.interface import Interface
from theory.persson.iteration import IterationOptions, iterate

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class PerssonTheory(Interface):
    """Describe an interface to Persson's theory; the defaults are the paper's.

    Parameters
    ----------
    spectrum : RoughnessSpectrum
        Roughness, analytic or of one surface.
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* of a half-space (Pa).
    work_of_adhesion : float
        Δγ >= 0 (J/m²).
    energy_weight : str, optional
        W(A): ``"paper"`` A[β + (1−β)A²]; ``"wang_mueser"`` A[5/9 − (2/9)A² + (2/3)A⁴]; ``"area"`` A.
    beta : float, optional
        β of the paper's weight.
    true_area : str, optional
        True over projected area: ``"persson"`` <√(1+|∇h|²)> of a Gaussian surface; ``"none"`` 1; ``"lattice"``
        <1/√(1+|∇h|²)>, for a substrate of atoms with a fixed number per projected area.
    alpha : float, optional
        α of the crack condition.
    stress_cap : float, optional
        Upper bound of σ_a, such as the law's largest tensile stress (Pa).
    nodes, cells : int, optional
        Magnifications and stress cells of the diffusion.
    options : PerssonOptions, optional
        Constants of the numerics.

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
    ) -> "PerssonContact":
        """Find the contact at a mean pressure, on the branch that ``start`` leads to.

        Parameters
        ----------
        pressure : float
            p, compression positive (Pa).
        start : numpy.ndarray or str, optional
            First σ_a at the magnifications (Pa), such as that of a neighbouring pressure; or ``"adhered"``, σ_a of
            conformal contact √(2α K Δγ); or ``"detached"``, zero. They differ where both states are stable.
        tolerance : float, optional
            Largest change of σ_a over the stress scale at the end of the iteration.
        max_iterations : int, optional
            Largest number of diffusions. An iteration whose change stops falling ends earlier.

        Returns
        -------
        PerssonContact
            The state, with ``converged`` and ``advice``.

        Raises
        ------
        ValueError
            If the pressure is not finite.
        FloatingPointError
            If the contact area or the detachment stress is not a finite number.
        """
        finite("pressure", pressure, "Pa")
        scale, stress = self.stress_scale, self._first_detachment_stress(start)
        variance = self.stress_variance / scale**2

        def respond(stress: np.ndarray) -> tuple[StressDistribution, np.ndarray]:
            found = diffuse(pressure / scale, variance, stress / scale, self.cells, self.options.diffusion)
            return found, self.stress_square(self.effective_work_of_adhesion(found.contact))

        if self.work_of_adhesion == 0:
            distribution, _ = respond(np.zeros_like(stress))
            contact = PerssonContact(self, pressure, stress, distribution, True, False, 0.0, 1)
        else:
            options = replace(self.options.iteration, tolerance=tolerance, max_iterations=max_iterations)
            end = iterate(respond, self.stress_of_square, stress, scale, pressure > 0, options)
            met = end.change <= tolerance
            contact = PerssonContact(
                self, pressure, end.stress, end.distribution, met, end.stalled, end.change, end.iterations
            )
        return contact if contact.balanced else replace(contact, converged=False)

    def _first_detachment_stress(self, start: np.ndarray | str) -> np.ndarray:
        if isinstance(start, np.ndarray):
            return start.copy()
        if start == "adhered":
            return self.detachment_stress(np.full(self.nodes + 1, self.work_of_adhesion))
        if start == "detached":
            return np.zeros(self.nodes + 1)
        raise ValueError(f"start = {start!r}: expected an array, 'adhered' or 'detached'")

    def sweep(
        self,
        lowest: float,
        per_decade: int = 12,
        tolerance: float = IterationOptions.tolerance,
        max_iterations: int = IterationOptions.max_iterations,
    ) -> tuple["PerssonContact", ...]:
        """States at rising pressures from ``lowest`` (Pa) to full contact, solved from there downward.

        Raises
        ------
        ValueError
            If ``lowest`` is not positive or beyond full contact.
        """
        highest = self.options.full_contact * self.stress_scale
        if not 0 < lowest < highest:
            raise ValueError(f"lowest = {lowest:g} Pa: must lie between 0 and full contact at {highest:g} Pa")
        count = max(8, int(np.ceil(per_decade * np.log10(highest / lowest))))
        contacts: list[PerssonContact] = []
        for p in np.geomspace(highest, lowest, count + 1):
            contacts.append(self.at_pressure(float(p), _extrapolated(contacts[-3:]), tolerance, max_iterations))
        return tuple(reversed(contacts))


def _extrapolated(contacts: Sequence["PerssonContact"]) -> np.ndarray | str:
    """First σ_a of the next state of a sweep, from up to three before: γ_eff as a polynomial of ln p."""
    if not contacts:
        return "adhered"
    coefficients = {1: (1,), 2: (-1, 2), 3: (1, -3, 3)}[len(contacts)]
    works = [contact.effective_work_of_adhesion for contact in contacts]
    work = sum(share * each for share, each in zip(coefficients, works, strict=True))
    return contacts[-1].theory.detachment_stress(np.asarray(work))


@dataclass(frozen=True)
class PerssonContact:
    """Hold the state of contact at one pressure, which :meth:`PerssonTheory.at_pressure` returns.

    Attributes
    ----------
    theory : PerssonTheory
        The interface.
    pressure : float
        p, compression positive (Pa).
    detachment_stress : numpy.ndarray
        σ_a at the theory's magnifications (Pa).
    distribution : StressDistribution
        P(σ) at the highest magnification and A(q), in units of ``theory.stress_scale``.
    converged : bool
        Whether the residual met the tolerance and the stresses balance.
    stalled : bool
        Whether the iteration ended because its change stopped falling.
    residual : float
        Largest change of σ_a in the last iteration over ``theory.stress_scale``.
    iterations : int
        Diffusions solved.

    Examples
    --------
    >>> from theory import PerssonTheory, SelfAffineSpectrum
    >>> theory = PerssonTheory(SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8), 93.7e9, 0.1)
    >>> contact = theory.at_pressure(1e9)
    >>> round(contact.stress_balance, 6), bool(contact.contact_stress > 1e9 > contact.edge_stress)
    (1.0, True)
    """

    theory: PerssonTheory
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
        return float(self.distribution.contact[-1])

    @property
    def detached(self) -> bool:
        """True without contact: at no pressure the iteration ends near zero area, not on it."""
        return self.pressure <= 0 and self.relative_contact_area < 1e-6

    @property
    def advice(self) -> str:
        """The remedy for a state that did not converge."""
        if not self.balanced:
            return (
                f"contact and edges carry {self.stress_balance:.3g} times the pressure, and not one within "
                f"{self.theory.options.balance:g}; use more cells (PerssonTheory(cells=...)) or a higher pressure"
            )
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
        theory = self.theory
        return float(-theory.work_of_adhesion * self.relative_contact_area * theory.area_factor[-1])

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
        error = self.contact_stress + self.edge_stress - self.pressure
        options = self.theory.options
        least = options.least_pressure * self.theory.stress_scale
        return abs(error) <= options.balance * max(abs(self.pressure), least)

    def pressure_density(self, edges: np.ndarray) -> np.ndarray:
        """Mean of P(σ) in bins (1/Pa), shape (n,) for n + 1 edges (Pa)."""
        scale = self.theory.stress_scale
        return self.distribution.bin_averages(np.asarray(edges) / scale) / scale

    def stress_density(self, edges: np.ndarray, wavevector: float) -> np.ndarray:
        """Mean of P(σ) in bins without the roughness above a wavevector (1/Pa).

        Parameters
        ----------
        edges : numpy.ndarray, shape (n + 1,)
            Edges of the bins (Pa).
        wavevector : float
            q above the first magnification, up to the last (1/m).

        Raises
        ------
        ValueError
            If q is outside the magnifications.
        """
        theory, scale = self.theory, self.theory.stress_scale
        first, last = theory.wavevectors[[0, -1]]
        rounding = 1e-9  # of a last wavevector that is a product
        if not first < finite("wavevector", wavevector, "1/m") <= last * (1 + rounding):
            raise ValueError(
                f"wavevector = {wavevector:g} 1/m: the magnifications go from above {first:.6g} to {last:.6g}"
            )
        at = min(wavevector, last)
        end = theory.spectrum.full_contact_stress_variance(theory.solid.stiffness, np.array([at]))[0]
        # In the scheme σ_a is linear in the variance between two nodes.
        below = theory.stress_variance[theory.wavevectors < at]
        variance = np.append(below[below < end], end) / scale**2
        stress = self.detachment_stress if theory.work_of_adhesion else np.zeros_like(self.detachment_stress)
        boundary = np.interp(variance * scale**2, theory.stress_variance, stress)
        # The cells are graded for a last variance of one.
        unit = np.sqrt(variance[-1])
        cells, options = theory.cells, theory.options.diffusion
        part = diffuse(self.pressure / scale / unit, variance / unit**2, boundary / scale / unit, cells, options)
        return part.bin_averages(np.asarray(edges) / scale / unit) / scale / unit

    def stress_densities(self, zetas: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """P(σ, ζ) as a function from edges (m + 1,) of bins (Pa) to means (n, m) (1/Pa), at ζ = q/q_L above one."""
        first = self.theory.wavevectors[0]
        if self.detached:
            return lambda edges: np.zeros((zetas.size, edges.size - 1))
        return lambda edges: np.array([self.stress_density(edges, float(zeta * first)) for zeta in zetas])

    def quantities(self) -> dict[str, Any]:
        """All values but the mean gap by their names in a dataset; distributions are functions of bin edges."""
        return {
            "mean_pressure": self.pressure,
            "relative_contact_area": self.relative_contact_area,
            "elastic_energy": self.elastic_energy,
            "interaction_energy": self.adhesion_energy,
            "pressure_pdf": self.pressure_density,
            "contact_stress": self.contact_stress,
            "edge_stress": self.edge_stress,
            "stress_balance": self.stress_balance,
            "relative_contact_area_at": self.contact,
            "detachment_stress": self.detachment_stress,
            "effective_work_of_adhesion": self.effective_work_of_adhesion,
            "converged": self.converged,
            "detached": self.detached,
            "residual": self.residual * self.theory.stress_scale / self.theory.solid.contact_modulus,
            "iterations": self.iterations,
        }

    def to_dataset(
        self, pressure_edges: np.ndarray | None = None, magnifications: np.ndarray | None = None
    ) -> "xr.Dataset":
        """Give the state in the schema of ``theory.nc``, without the dimension of a path.

        The mean gap takes some forty states at higher pressures.

        Parameters
        ----------
        pressure_edges : numpy.ndarray, optional
            Edges of the bins of P(σ) (Pa); by default even ones over the whole distribution.
        magnifications : numpy.ndarray, optional
            ζ = q/q_L, above one, for P(σ, ζ) in ``pressure_pdf_at``.

        Returns
        -------
        xarray.Dataset
            The quantities of the state.

        Raises
        ------
        ValueError
            If edges do not rise, or a magnification is not one of the spectrum.
        """
        theory, gap = self.theory, np.nan
        if self.pressure > 0 and not self.detached:
            swept = theory.sweep(min(self.pressure, theory.stress_scale))
            gap = float(gap_integral(swept).gap(np.log(self.pressure)))
        ends = self.distribution.edges[[0, -1]] * theory.stress_scale
        quantities = {**self.quantities(), "mean_gap": gap}
        coordinates = {"wavevector": theory.wavevectors}
        if magnifications is not None:
            coordinates["magnification"] = np.asarray(magnifications, dtype=float)
            quantities["pressure_pdf_at"] = self.stress_densities(coordinates["magnification"])
        names = ("pressure_pdf", "pressure_pdf_at")
        ranges = dict.fromkeys(names, (float(ends[0]), float(ends[1])))
        return dataset_of(("persson",), quantities, dict.fromkeys(names, pressure_edges), ranges, coordinates)


def gap_integral(contacts: Sequence[PerssonContact]) -> GapIntegral:
    """The mean gap over ln p from states at rising pressures."""
    pressure, energy = (np.array([getattr(each, name) for each in contacts]) for name in ("pressure", "energy"))
    return GapIntegral(pressure, energy, contacts[-1].theory.full_contact_energy)
