"""Criteria of stickiness, each as the work of adhesion over the one at which a rough surface begins to stick.

They use the spectrum, the work of adhesion Δγ (J/m²) and the range or reach Δr = Δγ/σ_max (m) of a law. A number for
the elasticity is the contact modulus E* of a half-space (Pa).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import ndtr

from contact_study.numerics.arguments import positive
from contact_study.physics.laws import TractionLaw
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.solids import Elasticity, elasticity_of
from theory.datasets import Dataset, dataset_of
from theory.non_adhesive.closed_forms import low_pressure_asymptote
from theory.non_adhesive.gap_distribution import attracted_at_light_load
from theory.persson.interface import true_area_factor

_KAPPA = 2.0  # of light contact without adhesion, A = κ F/(E* h'), in simulations
_HIGHEST = 10.0  # height of the bearing area in deviations: 1e-23 of the area lies beyond


def persson_tosatti_ratio(
    spectrum: RoughnessSpectrum, elasticity: Elasticity | float, work_of_adhesion: float
) -> float:
    """Ratio Δγ S over the elastic energy of full contact, π ∫ K C q dq: above one full contact gains energy.

    B. N. J. Persson, E. Tosatti, J. Chem. Phys. 115, 5597 (2001): Δγ A − U_el is the effective work of adhesion of a
    solid in full contact, of the true area S. It holds for attraction of no range, at large Tabor parameters; partial
    contact may stick below.
    """
    factor = float(true_area_factor(np.array(spectrum.rms_slope)))
    return work_of_adhesion * factor / float(spectrum.full_contact_energy(elasticity_of(elasticity).stiffness))


def pastewka_robbins_ratio(
    spectrum: RoughnessSpectrum, elasticity: Elasticity | float, work_of_adhesion: float, attraction_range: float
) -> float:
    """Ratio of the tension at the edges of light contact to its load, π (3/16)^(2/3) κΔγ/(h'Δr E*) (4Δr/h'd)^(2/3).

    After L. Pastewka, M. O. Robbins, PNAS 111, 3298 (2014). Experimental: not compared with their equation. It follows
    from the gap x^(3/2) outside a patch whose edge has the slope h', with κ = 2 and the diameter d = 4h'/h'' of a
    contact patch, h'' the rms mean curvature. It holds for weak attraction of a range short against h'd, at contact of
    few per cent. Of a solid other than a half-space the modulus of its finest waves is taken.
    """
    positive("attraction_range", attraction_range, "m")
    finest = spectrum.limits[1]
    modulus = 2 * float(elasticity_of(elasticity).stiffness(np.array([finest]))[0]) / finest
    slope, curvature = spectrum.rms_slope, spectrum.rms_laplacian / 2
    patch = 4 * slope / curvature
    asked = slope * attraction_range * modulus / _KAPPA * (slope * patch / (4 * attraction_range)) ** (2 / 3)
    return float(np.pi * (3 / 16) ** (2 / 3) * work_of_adhesion / asked)


def dmt_tension_ratio(
    spectrum: RoughnessSpectrum, elasticity: Elasticity | float, work_of_adhesion: float, attraction_range: float
) -> float:
    """Ratio of the tension on the area within the range to the pressure of light contact, both of Persson's theory.

    This project's own criterion, for hard solids at small Tabor parameters. Adhesion does not deform the contact, as in
    the DMT limit: its tension is Δγ/Δr on the area out of contact and within Δr. G. Violano, L. Afferrante, A.
    Papangelo, M. Ciavarella, J. Adhesion (2019), doi:10.1080/00218464.2019.1685384, have another equation.
    """
    return work_of_adhesion / attraction_range * attracted_at_light_load(spectrum, elasticity, attraction_range)


def attracted_area(mean_gap: np.ndarray | float, rms_height: float, attraction_range: float) -> np.ndarray:
    """Share of a Gaussian surface with a gap to a plane, ū above its mean, between zero and the range."""
    gap = np.asarray(mean_gap, dtype=float)
    return ndtr(-(gap - attraction_range) / rms_height) - ndtr(-gap / rms_height)


def bearing_area(
    spectrum: RoughnessSpectrum, elasticity: Elasticity | float, work_of_adhesion: float, attraction_range: float
) -> tuple[float, float]:
    """Δγ over the least one at which the bearing-area model pulls at some gap, and its lowest pressure (Pa) or zero.

    M. Ciavarella, Meccanica (2017), doi:10.1007/s11012-017-0701-6: p(ū) is the repulsion of light contact minus σ_max
    on the attracted area. The repulsion here is another, p₀ e^(−ū/u₀) of :func:`low_pressure_asymptote`. Experimental:
    not compared with the paper's numbers. For hard solids, small Tabor parameters and gaps above half the rms height.
    """
    decay, prefactor = low_pressure_asymptote(spectrum, elasticity)
    height = float(np.sqrt(spectrum.mean_square_height))
    positive("attraction_range", attraction_range, "m")

    def pressure(gap: np.ndarray) -> np.ndarray:
        tension = work_of_adhesion / attraction_range * attracted_area(gap, height, attraction_range)
        return prefactor * np.exp(-gap / decay) - tension

    def balance(gap: np.ndarray) -> np.ndarray:  # logarithm of the work of adhesion that balances the repulsion
        return (
            np.log(prefactor * attraction_range) - gap / decay - np.log(attracted_area(gap, height, attraction_range))
        )

    ratio = float(work_of_adhesion / np.exp(_lowest(balance, height)))
    return ratio, min(_lowest(pressure, height), 0.0)


def _lowest(function: Callable[[np.ndarray], np.ndarray], height: float) -> float:
    """The least value at mean gaps from zero to beyond all heights."""
    gaps = height * np.linspace(0.0, _HIGHEST, 401)
    at = int(np.argmin(function(gaps)))
    low, high = gaps[max(at - 1, 0)], gaps[min(at + 1, gaps.size - 1)]
    return float(minimize_scalar(function, bounds=(low, high), method="bounded", options={"xatol": 1e-9 * height}).fun)


def range_of(law: TractionLaw) -> float:
    """z₀ of a Tabor parameter (m): the equilibrium distance, outside a wall the range of the attraction."""
    return law.length if law.has_wall else law.equilibrium_distance


def local_tabor_number(
    wavevector: np.ndarray | float,
    spectrum: RoughnessSpectrum,
    elasticity: Elasticity | float,
    work_of_adhesion: float,
    length: float,
) -> np.ndarray:
    """μ = (R Δγ²/E*² z₀³)^(1/3) of the roughness up to a wavevector, whose curvature 1/R is half its rms Laplacian.

    B. N. J. Persson, M. Scaraggi, J. Chem. Phys. 141, 124701 (2014); adhesion is DMT-like where it is below about 0.1
    and JKR-like above about 3. Of a solid other than a half-space the modulus of the waves is taken; z₀ (m) is that of
    :func:`range_of`. At the smallest wavevector, with no roughness yet, it is NaN.
    """
    q = np.asarray(wavevector, dtype=float)
    curvature = 0.5 * np.sqrt(2 * np.pi * spectrum.moment(5, upper=q))
    modulus = 2 * elasticity_of(elasticity).stiffness(q) / q
    rough = np.where(curvature > 0, curvature, np.nan)
    return np.cbrt((work_of_adhesion / modulus) ** 2 / rough) / positive("length", length, "m")


@dataclass(frozen=True)
class StickinessCriteria:
    """Hold every criterion for a surface under a law, as :func:`stickiness` returns them.

    Attributes
    ----------
    tabor_number, bearing_area_pull_off : float
        Tabor parameter at the finest scale, and lowest pressure of the bearing-area model (Pa).
    persson_tosatti, pastewka_robbins, dmt_tension, bearing_area : float
        Δγ over the one at which the criterion begins to hold.

    Examples
    --------
    :func:`stickiness` returns one.
    """

    tabor_number: float
    persson_tosatti: float
    pastewka_robbins: float
    dmt_tension: float
    bearing_area: float
    bearing_area_pull_off: float

    def quantities(self) -> dict[str, float]:
        """The numbers by their names in a dataset."""
        ratios = ("persson_tosatti", "pastewka_robbins", "dmt_tension", "bearing_area")
        found = {f"{name}_ratio": getattr(self, name) for name in ratios}
        return {"finest_tabor_number": self.tabor_number, **found, "bearing_area_pull_off": self.bearing_area_pull_off}

    def to_dataset(self) -> Dataset:
        """Give the numbers in the schema of ``theory.nc``, as for :func:`contact_study.plots.criteria_map`."""
        return dataset_of((), self.quantities(), {})


def stickiness(spectrum: RoughnessSpectrum, elasticity: Elasticity | float, law: TractionLaw) -> StickinessCriteria:
    """Calculate every criterion for a spectrum under a law.

    Parameters
    ----------
    spectrum, elasticity, law
        As for :func:`gap_flow`; the law is an adhesive one.

    Returns
    -------
    StickinessCriteria
        The ratios, and the Tabor parameter.

    Raises
    ------
    ValueError
        If the law does not attract.

    Examples
    --------
    >>> from theory import LennardJones104, SelfAffineSpectrum, stickiness
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> found = stickiness(spectrum, 93.7e9, LennardJones104(0.69, 3.28e-10))
    >>> found.persson_tosatti < 1 < found.bearing_area
    False
    """
    if not law.attracts:
        raise ValueError(f"{law.title}: a law that does not attract has no criterion of sticking")
    work_of_adhesion, attraction_range = law.work_of_adhesion, law.work_of_adhesion / law.peak_tensile_stress
    arguments = spectrum, elasticity, work_of_adhesion
    tabor = float(local_tabor_number(spectrum.limits[1], *arguments, range_of(law)))
    ratios = pastewka_robbins_ratio(*arguments, attraction_range), dmt_tension_ratio(*arguments, attraction_range)
    return StickinessCriteria(
        tabor, persson_tosatti_ratio(*arguments), *ratios, *bearing_area(*arguments, attraction_range)
    )
