"""Adhesion in stripes
===================

The work of adhesion varies along a rough surface: stripes of 90 and 10 mJ/m² in place of 50 mJ/m² everywhere. Light
contact gathers in the strong stripes (left: on loading). They hold the surfaces together up to a larger tension.
"""

import matplotlib.pyplot as plt
import numpy as np

from contact_study import run

study = {
    "surface": {
        "kind": "self_affine",
        "size": "2.5 um",
        "shape": [108, 108],
        "rms_height": "30 nm",
        "roll_off_mode": 4,
        "cutoff_mode": 16,
    },
    "material": {"youngs_modulus": "30 MPa", "poissons_ratio": 0.5},
    "interaction": {"law": "exponential", "work_of_adhesion": "50 mJ/m^2", "length": "10 nm"},
    "loading": {"control": "gap", "path": [f"{gap} nm" for gap in (*range(130, 30, -10), 25, 15)], "unload": True},
    "output": {"fields": True},
}
figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.8), layout="constrained")
for stripes, colour in ((0, "C0"), (2, "C1")):
    adhesion = {"kind": "patches", "modes": [0, stripes], "contrast": 0.8} if stripes else {"kind": "none"}
    found = run({**study, "adhesion_map": adhesion})
    label = f"{stripes} stripes" if stripes else "uniform"
    right.plot(found.mean_gap * 1e9, found.mean_pressure / 1e6, "o-", color=colour, markersize=3, label=label)
touching = np.where(found.gap[7] <= 0, found.work_of_adhesion_map * 1e3, np.nan)
shown = left.imshow(touching, origin="lower", extent=(0, 2.5, 0, 2.5), cmap="coolwarm", vmin=0, vmax=100)
figure.colorbar(shown, ax=left, label="work of adhesion in contact (mJ/m²)")
left.set(xlabel="x (µm)", ylabel="y (µm)", facecolor="0.93")
right.set(xlabel="mean gap (nm)", ylabel="pressure (MPa)")
right.axhline(0, color="0.6", linewidth=0.8)
right.legend(frameon=False)
figure.savefig("adhesive_stripes.png", dpi=150)
