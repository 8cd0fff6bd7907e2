"""Ranges of a study's distributions, by spectra, moduli, laws and paths: two seeds of one study have the same bins."""

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
        pressure_edges: np.ndarray = np.linspace(*output.pressure_range, output.pressure_bins + 1)
    else:
        # Points out of contact carry no stress, or next to none of either sign: an edge at zero would part them at
        # random. Zero is in the middle of a bin, one half of it on the side of tension.
        width = (_rounded(tension) + _rounded(compression)) / output.pressure_bins
        below = round(_rounded(tension) / width - 0.5) + 0.5
        pressure_edges = (np.arange(output.pressure_bins + 1) - below) * width
    gap_range = output.gap_range or (0.0, _rounded(gap))
    return Bins(pressure_edges, np.linspace(*gap_range, output.gap_bins + 1))


def _ranges(case: Case, scales: SurfaceScales) -> tuple[float, float, float]:
    """Largest tension, compression (Pa) and gap (m) worth resolving in one case."""
    peak, stiffness, path = case.law.peak_tensile_stress, case.solid.stiffness, case.loading.path
    # Full contact has a Gaussian stress; six deviations leave 1e-9 of it outside.
    fluctuation, applied = 6 * scales.full_contact_stress(case.solid), 0.0
    if case.loading.control == "pressure":
        applied = max(map(abs, path))
    elif case.loading.control == "approach" and case.solid.mean_compliance:
        # What a compressible layer takes where no gap closes; less if one does.
        applied = min(max(0.0, *path) / case.solid.mean_compliance, case.material.hardness or np.inf)
    # Any range suits a flat hard wall under a prescribed gap, which carries nothing.
    compression = (fluctuation + applied + peak) or case.solid.contact_modulus
    # No tension exceeds the law's peak; a quarter more shows that. Persson's theory has no peak, but its tension is at
    # most that of full contact or of its cracks, √(2α K Δγ) of the finest wave.
    cracks = 0.0
    if scales.spectrum is not None and not case.theory.cap_detachment_stress:
        finest = float(stiffness(np.array([scales.spectrum.limits[1]]))[0])
        cracks = float(np.sqrt(2 * case.theory.alpha * finest * case.law.work_of_adhesion))
    tension = max(1.25 * peak, 0.05 * compression, min(cracks, fluctuation + applied))
    # At the lightest contact the block rests on the highest peaks, far above the deepest valley; under tension it
    # bends up a little further between them.
    gap = 1.1 * scales.peak_to_valley + 4 * case.contact_distance
    if case.loading.control == "gap":
        gap += max(path)
    elif case.loading.control == "approach":
        gap += max(0.0, -min(path))
    return tension, compression, gap or 1.0


def _rounded(value: float) -> float:
    """Two significant digits, upwards."""
    scale = 10 ** (np.floor(np.log10(value)) - 1)
    return float(np.ceil(value / scale - 1e-9) * scale)
