"""The ranges over which a study's distributions are resolved, chosen from its spectra, moduli, laws and paths.

No realisation has a say: two seeds of one study have the same bins, and their datasets concatenate.
"""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.physics.surfaces.surface import SurfaceScales
from contact_study.study.case import Case
from contact_study.study.study import Study


def bins_of(study: Study) -> Bins:
    """The bins of a study's distributions, one set for all of its cases; InputError if a height map cannot be used."""
    ranges = (_ranges(case, scale) for case, scale in zip(study.cases, study.scales, strict=True))
    tension, compression, gap = (max(values) for values in zip(*ranges, strict=True))
    output = study.cases[0].output
    if output.pressure_range is not None:
        pressure_edges = np.linspace(*output.pressure_range, output.pressure_bins + 1)
    else:
        pressure_edges = _around_zero(_rounded(tension), _rounded(compression), output.pressure_bins)
    gap_range = output.gap_range or (0.0, _rounded(gap))
    return Bins(pressure_edges, np.linspace(*gap_range, output.gap_bins + 1))


def _around_zero(tension: float, compression: float, bins: int) -> np.ndarray:
    """Edges over [−tension, compression] with zero in the middle of a bin.

    Points out of contact carry no stress, or next to none of either sign: an edge at zero would part them at random.
    """
    width = (tension + compression) / bins
    below = round(tension / width - 0.5) + 0.5  # bins on the side of tension, the middle one half
    return (np.arange(bins + 1) - below) * width


def _ranges(case: Case, scales: SurfaceScales) -> tuple[float, float, float]:
    """Largest tension, compression (Pa) and gap (m) worth resolving in one case."""
    law, modulus = case.law, case.solid.contact_modulus
    peak = law.peak_tensile_stress
    # Full contact has a Gaussian stress; six deviations leave 1e-9 of it outside.
    fluctuation = 6 * scales.full_contact_stress(case.solid)
    applied = _applied(case)
    # Any range suits a flat hard wall under a prescribed gap, which carries nothing.
    compression = (fluctuation + applied + peak) or modulus
    # No tension exceeds the law's peak; a quarter more shows that. Persson's theory has no peak, but its tension is at
    # most that of its cracks or of full contact.
    cracks = min(_detachment_stress(case, scales), fluctuation + applied)
    tension = max(1.25 * peak, 0.05 * compression, cracks)
    # At the lightest contact the block rests on the highest peaks, far above the deepest valley; under tension it
    # bends up a little further between them.
    gap = 1.1 * scales.peak_to_valley + 4 * case.contact_distance
    if case.loading.control == "gap":
        gap += max(case.loading.path)
    elif case.loading.control == "approach":
        gap += max(0.0, -min(case.loading.path))
    return tension, compression, gap or 1.0


def _applied(case: Case) -> float:
    """Largest mean pressure of either sign that the path says (Pa)."""
    path, control, compliance = case.loading.path, case.loading.control, case.solid.mean_compliance
    if control == "pressure":
        return max(map(abs, path))
    if control == "gap" or not compliance:
        return 0.0
    # What a compressible layer takes where no gap closes; less if one does.
    return min(max(0.0, *path) / compliance, case.material.hardness or np.inf)


def _detachment_stress(case: Case, scales: SurfaceScales) -> float:
    """Largest one of Persson's theory (Pa): √(2α K Δγ) of the finest wave, unless it is capped."""
    if scales.spectrum is None or case.theory.cap_detachment_stress:
        return 0.0
    stiffness = float(case.solid.stiffness(np.array([scales.spectrum.limits[1]]))[0])
    return float(np.sqrt(2 * case.theory.alpha * stiffness * case.law.work_of_adhesion))


def _rounded(value: float) -> float:
    """Two significant digits, upwards."""
    scale = 10 ** (np.floor(np.log10(value)) - 1)
    return float(np.ceil(value / scale - 1e-9) * scale)
