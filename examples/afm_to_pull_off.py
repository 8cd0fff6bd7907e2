"""From a height map to pull-off
=============================

A height map is pressed against a soft solid and pulled off under gap control, with adaptive load steps. The shaded area
of the loop is the energy lost in jumps; its lowest point is the pull-off stress.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.ndimage import gaussian_filter

from contact_study import plots, run

# In place of a measured map; run() also takes the path of a file as surface.path.
heights = gaussian_filter(np.random.default_rng(5).standard_normal((64, 64)), 4, mode="wrap")
heights *= 20e-9 / heights.std()  # m

found = run(
    {
        "surface": {"heights": heights, "size": "1 um"},
        "material": {"youngs_modulus": "3 MPa", "poissons_ratio": 0.5},
        "interaction": {"law": "exponential", "work_of_adhesion": "30 mJ/m^2", "length": "8 nm"},
        "loading": {"control": "gap", "path": ["150 nm", "5 nm"], "unload": True, "adaptive": True, "resolution": 0.02},
    }
)
axes = plots.hysteresis_loop(found)
axes.set_title(f"pull-off at {float(found.pull_off_pressure) / 1e3:.1f} kPa")
plt.close("all")
axes.figure.savefig("afm_to_pull_off.png", dpi=150)
