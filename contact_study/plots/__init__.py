"""Pictures of datasets, one call each: an xarray dataset in, Matplotlib axes out.

Each function draws on the axes it is given, or on those of a new figure, which is ``axes.figure``; ``inference`` and
``tornado`` have several and return the figure. None touches pyplot's state or any setting.
"""

from contact_study.plots.curves import contact_area, hysteresis_loop, mean_gap
from contact_study.plots.densities import (
    area_by_magnification,
    detachment_stress,
    effective_work_of_adhesion,
    gap_distribution,
    stress_by_magnification,
    stress_distribution,
    surface_spectrum,
)
from contact_study.plots.force_curves import force_curve
from contact_study.plots.inference import inference
from contact_study.plots.maps import atoms, contact_map, gap_map, height_map, pressure_map, section
from contact_study.plots.measured_spectra import measured_spectra
from contact_study.plots.patches import leakage, patch_sizes
from contact_study.plots.sweep_maps import criteria_map, deviations
from contact_study.plots.uncertainty import tornado

__all__ = [
    "area_by_magnification",
    "atoms",
    "contact_area",
    "contact_map",
    "criteria_map",
    "detachment_stress",
    "deviations",
    "effective_work_of_adhesion",
    "force_curve",
    "gap_distribution",
    "gap_map",
    "height_map",
    "hysteresis_loop",
    "inference",
    "leakage",
    "mean_gap",
    "measured_spectra",
    "patch_sizes",
    "pressure_map",
    "section",
    "stress_by_magnification",
    "stress_distribution",
    "surface_spectrum",
    "tornado",
]


def __dir__() -> list[str]:
    return sorted(__all__)
