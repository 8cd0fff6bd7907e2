"""P(u) of contact without adhesion by Persson's theory, and the DMT-like limit of adhesion that it makes possible.

A. Almqvist, C. Campañá, N. Prodanov, B. N. J. Persson, J. Mech. Phys. Solids 59, 2355 (2011), arXiv:1102.5412. What is
in contact at the magnification ζ and no longer at ζ + dζ has the mean gap u₁(ζ) = d(Aū)/dA there, with ū(ζ) the mean
separation of the surfaces that touch at ζ, under their own pressure p/A(ζ) and with the roughness beyond ζ alone. Of
this gap the roughness beyond ζ, of rms height h(ζ), makes a Gaussian, folded at u = 0:

    P(u) = ∫ dζ (−A'(ζ)) [g(u − u₁; h) + g(u + u₁; h)],     u > 0.

The later form narrows the Gaussian where it would reach far below zero, h⁻² → h⁻² + u₁⁻². The abstract was read, not
the equations of either form, which are written down from memory. The mean gap is that of the u₁, which is ū exactly; a
folded Gaussian's own mean is larger.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import erf, ndtr

from contact_study.fields.arguments import positive
from contact_study.fields.spectrum import RoughnessSpectrum
from contact_study.problem.elasticity import Elasticity, elasticity_of
from contact_study.problem.laws import TractionLaw
from theory.closed_forms import separation, shared_points

if TYPE_CHECKING:
    import xarray as xr

# Bands of the spectrum, and parts of equal area that come off one after the other: where next to nothing comes off, as
# at the longest waves under heavy load, u₁ of a point of ζ has no bound.
_BANDS, _PARTS = 100, 100

# Deviations of a part's Gaussian within which all but a billionth of it lies.
_REACH = 6.0

# Bins of the gap in which a law's traction is summed, graded from a ten-thousandth of the law's length.
_BINS = 4000


@dataclass(frozen=True)
class GapDistribution:
    """P(u) under one pressure, a sum of folded Gaussians.

    Attributes
    ----------
    pressure : float
        p (Pa).
    relative_contact_area : float
        A(q₁)/A₀: what has a gap of zero.
    shares : numpy.ndarray, shape (n,)
        Area of each part out of contact over the nominal one.
    centres, widths : numpy.ndarray, shape (n,)
        u₁ and the deviation of its Gaussian (m).
    """

    pressure: float
    relative_contact_area: float
    shares: np.ndarray
    centres: np.ndarray
    widths: np.ndarray

    @property
    def mean_gap(self) -> float:
        """ū of the theory, Σ share × u₁ (m)."""
        return float(self.shares @ self.centres)

    def fraction_below(self, gap: np.ndarray | float) -> np.ndarray:
        """Share of the nominal area with a gap up to this one (m), contact included."""
        u = np.asarray(gap, dtype=float)[..., None]
        folded = ndtr((u - self.centres) / self.widths) - ndtr((-u - self.centres) / self.widths)
        return self.relative_contact_area + folded @ self.shares

    def density(self, edges: np.ndarray) -> np.ndarray:
        """Mean of P(u) in bins (1/m), shape (n,) for n + 1 edges from zero on (m); without the δ of contact."""
        return np.diff(self.fraction_below(edges)) / np.diff(edges)

    def to_dataset(self, gap_edges: np.ndarray | None = None) -> "xr.Dataset":
        """The state in the schema of ``theory.nc``.

        As in a simulation, P(u) has the contact in the bin that begins at zero.

        Parameters
        ----------
        gap_edges : numpy.ndarray, optional
            Edges of the bins (m); by default even ones over all but a billionth of the area.

        Raises
        ------
        ValueError
            If edges do not rise.
        """
        from theory.datasets import dataset_of  # xarray is slow to import, and only needed here

        def with_contact(edges: np.ndarray) -> np.ndarray:
            below = np.where(edges > 0, self.fraction_below(edges), 0.0)
            return np.diff(below) / np.diff(edges)

        return dataset_of(
            ("almqvist",),
            {
                "mean_pressure": self.pressure,
                "mean_gap": self.mean_gap,
                "relative_contact_area": self.relative_contact_area,
                "gap_pdf": with_contact,
            },
            {"gap_pdf": gap_edges},
            {"gap_pdf": (0.0, float(np.max(self.centres + _REACH * self.widths)))},
        )


def gap_distribution(
    spectrum: RoughnessSpectrum,
    elasticity: Elasticity | float,
    pressure: float,
    regularised: bool = True,
    beta: float = 0.4,
) -> GapDistribution:
    """P(u) without adhesion.

    Parameters
    ----------
    spectrum : RoughnessSpectrum
        Roughness.
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* of a half-space (Pa).
    pressure : float
        p > 0 (Pa).
    regularised : bool, optional
        Whether the Gaussians are those of the later form.
    beta : float, optional
        β of the energy's weight in ū.

    Examples
    --------
    >>> from theory import SelfAffineSpectrum, gap_distribution
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> found = gap_distribution(spectrum, 93.7e9, 1e9)
    >>> bool(0 < found.relative_contact_area < found.fraction_below(1e-9) < 1)
    True
    """
    positive("pressure", pressure, "Pa")
    solid = elasticity_of(elasticity)
    q, ends = _wavevectors(spectrum, solid, pressure)
    variance = spectrum.full_contact_stress_variance(solid.stiffness, q)
    energy = spectrum.full_contact_energy(solid.stiffness, q)
    contact = _contact(pressure, variance[ends])
    gaps = [_separation(variance[i:], energy[i:], pressure / a, beta) for i, a in zip(ends[:-1], contact, strict=False)]
    volume = contact * np.append(gaps, 0.0)
    height = 2 * np.pi * np.maximum(spectrum.moment(1) - spectrum.moment(1, upper=q[ends]), 0.0)
    shares = contact[:-1] - contact[1:]
    centres = (volume[:-1] - volume[1:]) / shares
    widths = np.sqrt(0.5 * (height[:-1] + height[1:]))
    if regularised:
        widths = widths * np.abs(centres) / np.hypot(widths, centres)
    return GapDistribution(pressure, float(contact[-1]), shares, centres, widths)


def dmt_limit(distribution: GapDistribution, law: TractionLaw) -> float:
    """Mean pressure of the same contact with an adhesion that does not deform it, p − ∫ σ(d_eq + u) P(u) du (Pa).

    The DMT-like limit for hard solids and weak or long-ranged attraction, at local Tabor numbers well below one (see
    :mod:`theory.criteria`): B. N. J. Persson, M. Scaraggi, J. Chem. Phys. 141, 124701 (2014), of which the abstract was
    read. The gap of the bare contact is that beyond the law's equilibrium, where its traction σ is zero.

    Parameters
    ----------
    distribution : GapDistribution
        Without adhesion, at the pressure p that the contact itself carries.
    law : TractionLaw
        The law.
    """
    reach = float(np.max(np.abs(distribution.centres) + 9 * distribution.widths)) / law.length
    edges = law.length * np.concatenate([[0.0], np.geomspace(1e-4, max(reach, 1.0), _BINS)])
    mass = np.diff(distribution.fraction_below(edges))
    middle = 0.5 * (edges[1:] + edges[:-1])
    return distribution.pressure - float(mass @ law.traction(law.equilibrium_distance + middle))


def _contact(pressure: float, variance: np.ndarray) -> np.ndarray:
    """A/A₀ = erf(p/√(2s)), one where there is no stress yet."""
    rough = variance > 0
    return np.where(rough, erf(pressure / np.sqrt(2 * np.where(rough, variance, 1.0))), 1.0)


def _wavevectors(spectrum: RoughnessSpectrum, solid: Elasticity, pressure: float) -> tuple[np.ndarray, np.ndarray]:
    """Wavevectors that divide the spectrum well, and which of them end parts of equal area (numbers)."""
    edges = spectrum.band_edges(_BANDS)
    fine = np.unique(np.concatenate([edges, np.geomspace(edges[0], edges[-1], 100 * _BANDS)]))
    contact = _contact(pressure, spectrum.full_contact_stress_variance(solid.stiffness, fine))
    # Area is lost from the last wavevector on that leaves it whole.
    whole = int(np.flatnonzero(contact == contact[0])[-1])
    wanted = np.linspace(contact[0], contact[-1], _PARTS + 1)[1:-1]
    inner = np.interp(-wanted, -contact[whole:], fine[whole:])
    ends = np.concatenate([edges[:1], inner, edges[-1:]])
    q = np.unique(np.concatenate([edges, ends]))
    return q, np.unique(np.searchsorted(q, ends))


def _separation(variance: np.ndarray, energy: np.ndarray, pressure: float, beta: float) -> float:
    """ū of the roughness beyond the first of some wavevectors, under a pressure (m)."""
    root = np.sqrt(2 * np.maximum(variance - variance[0], 0.0))
    stress, parts = shared_points(root, np.diff(energy))
    rough = stress > 0
    return float(separation(np.array([pressure]), stress[rough], parts[rough], beta)[0])
