"""Persson's theory of rough contact with adhesion, as Yang et al. used it.

C. Yang, B. N. J. Persson, J. Israelachvili, K. Rosenberg, EPL 84, 46004 (2008), arXiv:0808.3463, and B. N. J. Persson,
Surf. Sci. Rep. 61, 201 (2006), section 8. Stress diffuses with the magnification q (:mod:`theory.persson.diffusion`),
stopped at σ_a(q) of a crack of size 1/q; A* is the true area, U_el the energy of wavelengths shorter than 2π/q:

    σ_a² = 2α K γ_eff,     γ_eff A* = Δγ A*(q₁) − U_el,     U_el(q) = π ∫_q^q₁ K W(A) C q' dq'.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.special import erfcx

from contact_study.numerics.arguments import finite, positive
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from theory.numerics.fixed_point import accelerated
from theory.persson.contact import PerssonContact
from theory.persson.diffusion import DiffusionOptions, StressDistribution, diffuse

ENERGY_WEIGHTS = ("paper", "wang_mueser", "area")
TRUE_AREAS = ("persson", "none", "lattice")


@dataclass(frozen=True)
class IterationOptions:
    """Constants of the iteration."""

    tolerance: float = 1e-7  # largest change of σ_a over the stress scale, four digits below the error of the nodes
    max_iterations: int = 400  # diffusions at most
    accelerated: int = 40  # diffusions after which the acceleration is given up
    memory: int = 3  # states that it uses; with more it fails near the sticking threshold
    relaxation: float = 0.8  # largest share of the change that the damped iteration takes
    patience: int = 200  # diffusions in which the smallest change of the damped iteration has to halve


@dataclass(frozen=True)
class PerssonOptions:
    """Constants of the numerics."""

    early_share: float = 0.4  # of the nodes even in this power of the stress variance, not in ln q
    early_power: float = 1 / 6
    nearest: float = 1e-14  # smallest distance from the first wavevector of a node, over the spectrum's width
    negligible: float = 1e-9  # stress variance left out: filtered maps have shells down to the rounding
    full_contact: float = 7.0  # pressure beyond which contact is full to 1e-12, over the stress scale
    balance: float = 0.02  # largest error of the stress balance of a converged state, over the pressure
    least_pressure: float = 1e-6  # its bound is that of this pressure where p is smaller, over the stress scale
    diffusion: DiffusionOptions = field(default_factory=DiffusionOptions)
    iteration: IterationOptions = field(default_factory=IterationOptions)


Response = Callable[[np.ndarray], tuple[StressDistribution, np.ndarray]]
# σ_a (Pa), its distribution, whether it converged or progress ended, the last change over the scale, and diffusions.
FixedPoint = tuple[np.ndarray, StressDistribution, bool, bool, float, int]


@dataclass(frozen=True)
class PerssonTheory:
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

    spectrum: RoughnessSpectrum
    elasticity: Elasticity | float
    work_of_adhesion: float
    energy_weight: str = "paper"
    beta: float = 0.4
    true_area: str = "persson"
    alpha: float = 1.0
    stress_cap: float = np.inf
    nodes: int = 200
    cells: int = 300
    options: PerssonOptions = field(default_factory=PerssonOptions)

    def __post_init__(self):
        if finite("work_of_adhesion", self.work_of_adhesion, "J/m²") < 0:
            raise ValueError(f"work_of_adhesion = {self.work_of_adhesion!r}: must not be negative, in J/m²")
        for name in ("alpha", "nodes", "cells"):
            positive(name, getattr(self, name), "1")
        for name, known in (("energy_weight", ENERGY_WEIGHTS), ("true_area", TRUE_AREAS)):
            if getattr(self, name) not in known:
                raise ValueError(f"{name} = {getattr(self, name)!r}: expected one of {', '.join(known)}")

    @cached_property
    def solid(self) -> Elasticity:
        """The elastic solid."""
        return elasticity_of(self.elasticity)

    @cached_property
    def wavevectors(self) -> np.ndarray:
        """Magnifications from the smallest to the largest wavevector with roughness, shape (nodes + 1,) (1/m).

        They equidistribute 0.4 (s/s₁)^(1/6) + 0.6 ln q; octaves that add no stress variance get none.
        """
        options = self.options
        fine = self.spectrum.band_edges(100 * self.nodes)
        near = fine[0] + (fine[-1] - fine[0]) * np.geomspace(options.nearest, 1e-2, 20 * self.nodes)
        fine = np.unique(np.concatenate([fine, near, np.geomspace(fine[0], fine[-1], 100 * self.nodes)]))
        share = np.maximum.accumulate(self.spectrum.full_contact_stress_variance(self.solid.stiffness, fine))
        share /= share[-1]
        end = int(np.argmax(share >= 1 - options.negligible)) + 1
        fine, share = fine[:end], share[:end]
        octaves = np.diff(np.log(fine))
        octaves[np.diff(share) < options.negligible * octaves / octaves.sum()] = 0.0
        late = np.concatenate([[0.0], np.cumsum(octaves)]) / octaves.sum()
        measure = options.early_share * share**options.early_power + (1 - options.early_share) * late
        return np.interp(np.linspace(0, measure[-1], self.nodes + 1), measure, fine)

    @cached_property
    def _stiffness(self) -> np.ndarray:
        """K at the magnifications (Pa/m)."""
        return self.solid.stiffness(self.wavevectors)

    @cached_property
    def stress_variance(self) -> np.ndarray:
        """s(q) at the magnifications (Pa²)."""
        return self.spectrum.full_contact_stress_variance(self.solid.stiffness, self.wavevectors)

    @property
    def stress_scale(self) -> float:
        """√s(q₁), the standard deviation of the stress in full contact (Pa)."""
        return float(np.sqrt(self.stress_variance[-1]))

    @cached_property
    def area_factor(self) -> np.ndarray:
        """True over projected area of conformal contact at the magnifications."""
        if self.true_area == "none":
            return np.ones(self.nodes + 1)
        slope = np.sqrt(2 * np.pi * self.spectrum.moment(3, upper=self.wavevectors))
        return true_area_factor(slope) if self.true_area == "persson" else mean_cosine(slope)

    @cached_property
    def _energy_parts(self) -> np.ndarray:
        """Full-contact elastic energy of the roughness between neighbouring magnifications (J/m²)."""
        return np.diff(self.spectrum.full_contact_energy(self.solid.stiffness, self.wavevectors))

    @property
    def full_contact_energy(self) -> float:
        """Interfacial energy U at infinite pressure: U_full − Δγ S (J/m²)."""
        return float(self._energy_parts.sum() - self.work_of_adhesion * self.area_factor[-1])

    def elastic_energy(self, contact: np.ndarray) -> np.ndarray:
        """U_el(q) at the magnifications from A(q) (J/m²)."""
        weight = energy_weight(contact, self.energy_weight, self.beta)
        parts = self._energy_parts * 0.5 * (weight[1:] + weight[:-1])
        return np.concatenate([np.cumsum(parts[::-1])[::-1], [0.0]])

    def effective_work_of_adhesion(self, contact: np.ndarray) -> np.ndarray:
        """γ_eff(q) from A(q), zero where nothing is in contact (J/m²)."""
        true_area = contact * self.area_factor
        gain = self.work_of_adhesion * true_area[-1] - self.elastic_energy(contact)
        return np.divide(gain, true_area, out=np.zeros_like(gain), where=true_area > 0)

    def detachment_stress(self, effective_work: np.ndarray) -> np.ndarray:
        """σ_a(q) from γ_eff(q) (Pa)."""
        return self._root(2 * self.alpha * self._stiffness * effective_work)

    def _root(self, square: np.ndarray) -> np.ndarray:
        """σ_a (Pa) from its square where nothing caps it, negative where γ_eff is (Pa²)."""
        return np.minimum(np.sqrt(np.maximum(square, 0.0)), self.stress_cap)

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
            Largest last change of σ_a over the stress scale, and number of diffusions; fewer where it stops falling.
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


def energy_weight(contact: np.ndarray, kind: str, beta: float) -> np.ndarray:
    """Share W(A) of the full-contact elastic energy that incomplete contact stores."""
    if kind == "paper":
        return contact * (beta + (1 - beta) * contact**2)
    if kind == "wang_mueser":
        return contact * (5 / 9 - 2 / 9 * contact**2 + 2 / 3 * contact**4)
    return contact.copy()


def true_area_factor(rms_slope: np.ndarray) -> np.ndarray:
    """S(ξ) = ∫₀^∞ √(1+ξ²x) e^(−x) dx = 1 + (√π/2) ξ e^(1/ξ²) erfc(1/ξ), <√(1+|∇h|²)> of a Gaussian surface."""
    inverse = 1 / np.maximum(rms_slope, 1e-150)  # ξ = 0 is the limit, without a division by zero
    return 1 + 0.5 * np.sqrt(np.pi) * rms_slope * erfcx(inverse)


def mean_cosine(rms_slope: np.ndarray) -> np.ndarray:
    """∫₀^∞ e^(−x)/√(1+ξ²x) dx = (√π/ξ) e^(1/ξ²) erfc(1/ξ), <1/√(1+|∇h|²)> of a Gaussian surface."""
    inverse = 1 / np.maximum(rms_slope, 1e-150)
    return np.sqrt(np.pi) * inverse * erfcx(inverse)
