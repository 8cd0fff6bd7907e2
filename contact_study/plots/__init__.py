"""Pictures of datasets, one call each: an xarray dataset in, Matplotlib axes out.

Each function draws on the axes it is given, or on those of a new figure, which is ``axes.figure``; none touches
pyplot's state or any setting.
"""

from contact_study.plots.curves import contact_area, hysteresis_loop, mean_gap
from contact_study.plots.densities import gap_distribution, stress_distribution, surface_spectrum
from contact_study.plots.deviations import deviations
from contact_study.plots.maps import contact_map, gap_map, height_map, pressure_map
from contact_study.plots.section import section

__all__ = [
    "contact_area",
    "contact_map",
    "deviations",
    "gap_distribution",
    "gap_map",
    "height_map",
    "hysteresis_loop",
    "mean_gap",
    "pressure_map",
    "section",
    "stress_distribution",
    "surface_spectrum",
]
