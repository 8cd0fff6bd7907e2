"""The power spectrum of many measurements with its bounds, beside that of each."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from contact_study.physics.roughness.combination import uncovered
from contact_study.plots.selection import require
from contact_study.plots.style import COLOURS, SINGLE, add_legend, axes_of, picture

_LISTED = 6  # measurements that the legend names


@picture("Of the command spectrum.", 'xr.open_dataset("surface_psd.nc")')
def measured_spectra(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Power spectrum C(q) with bounds, and of each measurement, faint where it is not reliable."""
    require(dataset, "measured_spectrum")
    axes = axes_of(axes, 1.5 * SINGLE, 3.2)
    several = dataset.sizes["measurement"] > _LISTED
    for number, name in enumerate(dataset["measurement"].values):
        own = dataset.isel(measurement=number)
        q, density, flag = (own[f"measured_{of}"].values for of in ("wavevector", "spectrum", "flag"))
        colour, label = COLOURS[number % len(COLOURS)], None if several else f"{name} ({own['kind'].values!s})"
        reliable = np.where(flag == 0, density, np.nan)
        axes.loglog(q, np.where(density > 0, density, np.nan), "-", color=colour, lw=0.6, alpha=0.35)
        axes.loglog(q, reliable, "o", color=colour, ms=2.5, mew=0, label=label)
    q, density = dataset["wavevector"].values, dataset["power_spectrum"].values
    lower, upper = (dataset[f"power_spectrum_{side}"].values for side in ("lower", "upper"))
    known = dataset["measured_wavevector"].where(dataset["measured_flag"] == 0)
    ends = zip(known.min("band").values, known.max("band").values, strict=True)
    gaps = uncovered([(low, high) for low, high in ends if np.isfinite(low)])
    hole = np.searchsorted(q, [np.sqrt(low * high) for low, high in gaps])
    q, density, lower, upper = (np.insert(values, hole, np.nan) for values in (q, density, lower, upper))
    axes.fill_between(q, lower, upper, color="0.6", alpha=0.4, lw=0, label="combined, 95 %")
    axes.loglog(q, density, "k-", lw=0.9)
    axes.plot([], [], "-", color="0.6", lw=0.6, label="not reliable")
    # Unreliable ends of measurements may be decades away.
    axes.set_ylim(0.1 * np.nanmin(lower), 10 * np.nanmax(upper))
    axes.set(xlabel=r"wavevector $q$ (m$^{-1}$)", ylabel=r"power spectrum $C(q)$ (m$^4$)")
    add_legend(axes)
    return axes
