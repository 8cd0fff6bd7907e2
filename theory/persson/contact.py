"""The state of contact at one pressure in Persson's theory; see :mod:`theory.persson.theory`."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_study.numerics.arguments import finite
from theory.persson.diffusion import StressDistribution, diffuse

if TYPE_CHECKING:
    import xarray as xr

    from theory.persson.theory import PerssonTheory

# By which the last wavevector may be missed where it is written as a product.
_ROUNDING = 1e-9

# Largest error of the stress balance of a converged state, over the pressure or over this share of the stress scale.
BALANCE_TOLERANCE, _LEAST_PRESSURE = 0.02, 1e-6


@dataclass(frozen=True)
class PerssonContact:
    """The state of contact at one pressure.

    Attributes
    ----------
    theory : PerssonTheory
        What was solved.
    pressure : float
        p, compression positive (Pa).
    detachment_stress : numpy.ndarray
        σ_a at the theory's magnifications (Pa).
    distribution : StressDistribution
        P(σ) at the highest magnification and A(q), in units of ``theory.stress_scale``.
    converged : bool
        Whether the residual met the tolerance and the stresses balance.
    stalled : bool
        Whether the iteration was ended because it came no nearer to its end.
    residual : float
        Largest change of σ_a in the last iteration over ``theory.stress_scale``.
    iterations : int
        Diffusions solved.
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
        return float(self.distribution.contact[-1])

    @property
    def detached(self) -> bool:
        """Whether no contact is left: without pressure the iteration ends near zero area, not on it."""
        return self.pressure <= 0 and self.relative_contact_area < 1e-6

    @property
    def advice(self) -> str:
        """The remedy for a state that did not converge."""
        if not self.balanced:
            return (
                f"contact and edges carry {self.stress_balance:.3g} times the pressure, and not one within "
                f"{BALANCE_TOLERANCE:g}; use more cells of stress (PerssonTheory(cells=...)) or a higher pressure"
            )
        return "its iteration circles; lower theory.alpha" if self.stalled else "raise solver.max_iterations"

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
        """Whether contact and edges carry the applied pressure, within a fiftieth."""
        error = self.contact_stress + self.edge_stress - self.pressure
        return abs(error) <= BALANCE_TOLERANCE * max(abs(self.pressure), _LEAST_PRESSURE * self.theory.stress_scale)

    def pressure_density(self, edges: np.ndarray) -> np.ndarray:
        """Mean of P(σ) in bins (1/Pa), shape (n,) for n + 1 edges (Pa)."""
        scale = self.theory.stress_scale
        return self.distribution.bin_averages(np.asarray(edges) / scale) / scale

    def stress_density(self, edges: np.ndarray, wavevector: float) -> np.ndarray:
        """Mean of P(σ) in bins at the magnification of a wavevector (1/Pa): roughness above it is not there yet.

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
        if not first < finite("wavevector", wavevector, "1/m") <= last * (1 + _ROUNDING):
            raise ValueError(
                f"wavevector = {wavevector:g} 1/m: the magnifications go from above {first:.6g} to {last:.6g}"
            )
        at = min(wavevector, last)
        end = theory.spectrum.full_contact_stress_variance(theory.solid.stiffness, np.array([at]))[0]
        # As the scheme has it, σ_a is linear in the variance between two nodes.
        below = theory.stress_variance[theory.wavevectors < at]
        variance = np.append(below[below < end], end) / scale**2
        stress = self.detachment_stress if theory.work_of_adhesion else np.zeros_like(self.detachment_stress)
        boundary = np.interp(variance * scale**2, theory.stress_variance, stress)
        # The cells are graded for a last variance of one.
        unit = np.sqrt(variance[-1])
        part = diffuse(self.pressure / scale / unit, variance / unit**2, boundary / scale / unit, theory.cells)
        return part.bin_averages(np.asarray(edges) / scale / unit) / scale / unit

    def quantities(self) -> dict[str, Any]:
        """Everything that is read off the state but its mean gap, by its name in a dataset.

        Distributions are functions of bin edges; what depends on the magnification stands at the theory's own.
        """
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
        """The state in the schema of ``theory.nc``, without the dimension of a path.

        Its mean gap rests on the states at all higher pressures, which are solved for it: some forty more.

        Parameters
        ----------
        pressure_edges : numpy.ndarray, optional
            Edges of the bins of P(σ) (Pa); by default even ones over the whole distribution.
        magnifications : numpy.ndarray, optional
            ζ = q/q_L, above one, at which P(σ, ζ) is given too, as ``pressure_pdf_at``.

        Raises
        ------
        ValueError
            If edges do not rise, or a magnification is not one of the spectrum.
        """
        from theory.datasets import dataset_of  # xarray is slow to import, and only needed here
        from theory.persson.magnification import stress_densities
        from theory.persson.separation import separation_curve

        gap = np.nan
        if self.pressure > 0 and not self.detached:
            lowest = min(self.pressure, self.theory.stress_scale)
            gap = float(separation_curve(self.theory, lowest).mean_gap(self.pressure))
        ends = self.distribution.edges[[0, -1]] * self.theory.stress_scale
        quantities = {**self.quantities(), "mean_gap": gap}
        coordinates = {"wavevector": self.theory.wavevectors}
        if magnifications is not None:
            coordinates["magnification"] = np.asarray(magnifications, dtype=float)
            quantities["pressure_pdf_at"] = stress_densities(self, coordinates["magnification"])
        names = ("pressure_pdf", "pressure_pdf_at")
        return dataset_of(
            ("persson",),
            quantities,
            dict.fromkeys(names, pressure_edges),
            dict.fromkeys(names, (float(ends[0]), float(ends[1]))),
            coordinates,
        )
