"""P(u) of contact without adhesion by Persson's theory, and the DMT-like limit of adhesion that it makes possible.

A. Almqvist, C. Campañá, N. Prodanov, B. N. J. Persson, J. Mech. Phys. Solids 59, 2355 (2011), arXiv:1102.5412. The area
that leaves contact at the magnification ζ has the mean gap u₁(ζ) = d(Aū)/dA, ū(ζ) being the mean separation under the
pressure p/A(ζ) with the roughness beyond ζ alone. Its rms height h(ζ) spreads the gap as a Gaussian g, folded at 0:

    P(u) = ∫ dζ (−A'(ζ)) [g(u − u₁; h) + g(u + u₁; h)],     u > 0.

``regularised`` narrows the Gaussian, h⁻² → h⁻² + u₁⁻². Experimental: compared with the gaps of the continuum
(docs/theories.md), not with the equations in print.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from contact_study.numerics.arguments import positive
from contact_study.physics.laws import TractionLaw
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from theory.datasets import Dataset, dataset_of
from theory.non_adhesive.closed_forms import BETA, relative_contact_area, separation, shared_points

# Bands of the spectrum, and parts of the area that leave contact: as many of equal area and of equal ratios.
_BANDS, _PARTS = 100, 50
_FIRST = 1e-12  # smallest share of the stress variance, or of the spectrum's width, that is resolved
_REACH, _BINS = 6.0, 4000  # deviations with all but a billionth of a Gaussian, and bins of the gap under a traction
_LEAST = 1e-100  # deviation of a part that lies deep under contact and has a gap of zero (m)


@dataclass(frozen=True)
class GapDistribution:
    """Hold P(u) under one pressure, a sum of folded Gaussians.

    Attributes
    ----------
    pressure, relative_contact_area : float
        p (Pa), and A(q₁)/A₀, the share with a gap of zero.
    shares : numpy.ndarray, shape (n,)
        Area of each part out of contact over the nominal one.
    centres, widths : numpy.ndarray, shape (n,)
        u₁ and the deviation of its Gaussian (m).

    Examples
    --------
    :func:`gap_distribution` returns one.
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

    def to_dataset(self, gap_edges: np.ndarray | None = None) -> Dataset:
        """Give the state in the schema of ``theory.nc``, with the contact in the bin of P(u) that begins at zero.

        Without edges of the bins (m) there are even ones over all but a billionth of the area.
        """

        def with_contact(edges: np.ndarray) -> np.ndarray:
            return np.diff(np.where(edges > 0, self.fraction_below(edges), 0.0)) / np.diff(edges)

        quantities = {"mean_pressure": self.pressure, "mean_gap": self.mean_gap, "gap_pdf": with_contact}
        quantities["relative_contact_area"] = self.relative_contact_area
        farthest = float(np.max(self.centres + _REACH * self.widths))
        return dataset_of(("almqvist",), quantities, {"gap_pdf": (gap_edges, (0.0, farthest))})


def gap_distribution(
    spectrum: RoughnessSpectrum,
    elasticity: Elasticity | float,
    pressure: float,
    regularised: bool = True,
    beta: float = BETA,
) -> GapDistribution:
    """Find P(u) without adhesion.

    Parameters
    ----------
    spectrum, elasticity
        As for :func:`gap_flow`.
    pressure : float
        p > 0 (Pa).
    regularised, beta : bool, float, optional
        Narrow the Gaussians near zero, h⁻² → h⁻² + u₁⁻²; β of the energy's weight in ū.

    Returns
    -------
    GapDistribution
        Shares of the area with the Gaussians of their gaps.

    Raises
    ------
    ValueError
        If the pressure is not positive, or leaves no gap.

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

    def contact(variance: np.ndarray) -> np.ndarray:
        return relative_contact_area(pressure, np.maximum(variance, np.finfo(float).tiny))

    q, stress = _stress(spectrum, solid)
    left = contact(stress)
    whole = int(np.flatnonzero(left == left[0])[-1])  # the last wavevector that leaves the area whole
    if whole == q.size - 1:
        raise ValueError(f"pressure = {pressure:g} Pa: presses the roughness flat, and leaves no gap to distribute")
    steps = np.linspace(0.0, 1.0, _PARTS + 1)[1:-1]
    # Under light load all of the area that matters is in the last of the equal parts: as many in equal ratios.
    wanted = np.concatenate([left[0] + steps * (left[-1] - left[0]), left[0] * (left[-1] / left[0]) ** steps])
    ends = np.interp(-np.unique(wanted)[::-1], -left[whole:], q[whole:])
    ends = np.concatenate([q[:1], ends, q[-1:]])
    parts = _parts(spectrum, solid, ends, contact, lambda area: pressure / area, regularised, beta)
    return GapDistribution(pressure, float(left[-1]), *parts)


def attracted_at_light_load(spectrum: RoughnessSpectrum, elasticity: Elasticity | float, reach: float) -> float:
    """Area out of contact with a gap within a range (m), over the pressure, as the pressure vanishes (1/Pa).

    The sum is that of :func:`gap_distribution`, not regularised, for an infinite surface: at a magnification with the
    stress variance s the area in contact is √(2/πs) for every unit of pressure, under √(πs/2).
    """
    positive("attraction_range", reach, "m")
    solid = elasticity_of(elasticity)
    q, stress = _stress(spectrum, solid)
    rough = stress > _FIRST * stress[-1]
    shares = np.concatenate([np.geomspace(_FIRST, 0.5, _PARTS + 1), 1 - np.geomspace(0.5, 1e-3, _PARTS)[1:]])
    ends = np.exp(np.interp(np.log(shares * stress[-1]), np.log(stress[rough]), np.log(q[rough])))
    ends = np.append(ends, q[-1])
    contact, local = (lambda variance: np.sqrt(2 / (np.pi * variance))), (lambda area: 1 / area)
    areas, centres, widths = _parts(spectrum, solid, ends, contact, local)
    return float((ndtr((reach - centres) / widths) - ndtr((-reach - centres) / widths)) @ areas)


def dmt_limit(distribution: GapDistribution, law: TractionLaw) -> float:
    """Subtract from the pressure an adhesion that does not deform the contact, p − ∫ σ(d_eq + u) P(u) du.

    The DMT-like limit for hard solids and weak or long-ranged attraction, at local Tabor parameters well below one (see
    :mod:`theory.criteria`), which B. N. J. Persson, M. Scaraggi, J. Chem. Phys. 141, 124701 (2014) treat. Experimental,
    as P(u) is. The gap of the bare contact is that beyond the law's equilibrium, where its traction σ is zero.

    Parameters
    ----------
    distribution, law : GapDistribution, TractionLaw
        P(u) without adhesion, at the pressure p that the contact itself carries; the adhesive law.

    Returns
    -------
    float
        Mean pressure on the same contact with adhesion (Pa).

    Examples
    --------
    >>> from theory import LennardJones104, SelfAffineSpectrum, dmt_limit, gap_distribution
    >>> bare = gap_distribution(SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8), 93.7e9, 1e9)
    >>> dmt_limit(bare, LennardJones104(0.1, 3.28e-10)) < 1e9
    True
    """
    reach = float(np.max(np.abs(distribution.centres) + 9 * distribution.widths)) / law.length
    edges = law.length * np.concatenate([[0.0], np.geomspace(1e-4, max(reach, 1.0), _BINS)])
    mass = np.diff(distribution.fraction_below(edges))
    middle = 0.5 * (edges[1:] + edges[:-1])
    return distribution.pressure - float(mass @ law.traction(law.equilibrium_distance + middle))


def _stress(spectrum: RoughnessSpectrum, solid: Elasticity) -> tuple[np.ndarray, np.ndarray]:
    """Wavevectors that divide the spectrum finely, above all at its beginning (1/m), and the stress variance there."""
    edges = spectrum.band_edges(_BANDS)
    first = edges[0] + (edges[-1] - edges[0]) * np.geomspace(_FIRST, 1e-2, 20 * _BANDS)
    q = np.unique(np.concatenate([edges, first, np.geomspace(edges[0], edges[-1], 100 * _BANDS)]))
    return q, spectrum.full_contact_stress_variance(solid.stiffness, q)


def _parts(
    spectrum: RoughnessSpectrum,
    solid: Elasticity,
    ends: np.ndarray,
    contact: Callable[[np.ndarray], np.ndarray],
    local: Callable[[np.ndarray], np.ndarray],
    regularised: bool = False,
    beta: float = BETA,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Area, u₁ and deviation of the parts that leave contact between wavevectors (1/m).

    ``contact`` gives the area in contact at stress variances, ``local`` the pressure on such an area.
    """
    ends = np.unique(ends)
    q = np.unique(np.concatenate([spectrum.band_edges(_BANDS), ends]))
    variance = spectrum.full_contact_stress_variance(solid.stiffness, q)
    energy = spectrum.full_contact_energy(solid.stiffness, q)
    first = np.searchsorted(q, ends)
    area = contact(variance[first])
    gaps = np.zeros(area.size)  # ū of the roughness beyond
    for part, (i, pressure) in enumerate(zip(first[:-1], local(area[:-1]), strict=True)):
        root = np.sqrt(2 * np.maximum(variance[i:] - variance[i], 0.0))
        stress, parts = shared_points(root, np.diff(energy[i:]))
        rough = stress > 0
        gaps[part] = separation(np.array([float(pressure)]), stress[rough], parts[rough], beta)[0]
    volume = area * gaps
    height = 2 * np.pi * np.maximum(spectrum.moment(1) - spectrum.moment(1, upper=ends), 0.0)
    shares = area[:-1] - area[1:]
    lost = shares > 0  # none where the spectrum is empty, or where pressure holds all in contact
    shares = shares[lost]
    centres = (volume[:-1] - volume[1:])[lost] / shares
    widths = np.sqrt(0.5 * (height[:-1] + height[1:]))[lost]
    if regularised:
        widths = widths * np.abs(centres) / np.hypot(widths, centres)
    return shares, centres, np.maximum(widths, _LEAST)
