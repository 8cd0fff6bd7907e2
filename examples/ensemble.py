"""An ensemble with error bars
===========================

Twelve surfaces of one spectrum are pressed with and without adhesion. The figure shows each surface in grey and the
mean with its standard error: adhesion adds more contact than the surfaces differ.
"""

import matplotlib.pyplot as plt
import numpy as np

from contact_study import run

samples = 12
study = {
    "surface": {
        "kind": "self_affine",
        "size": "52 nm",
        "shape": [96, 96],
        "rms_height": "5 angstrom",
        "roll_off_mode": 2,
        "cutoff_mode": 8,
    },
    "material": {"youngs_modulus": "77.2 GPa", "poissons_ratio": 0.42},
    "loading": {"path": ["0.2 GPa", "0.5 GPa", "1 GPa", "2 GPa", "5 GPa"]},
    "sweep": {"surface.seed": list(range(1, samples + 1))},
}
adhesive = {"law": "lennard_jones_10_4", "work_of_adhesion": "0.7 J/m^2", "length": "3.28 angstrom"}

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for name, interaction in (("adhesive", adhesive), ("hard wall", {"law": "hard_wall"})):
    found = run(study | {"interaction": interaction})
    pressure, area = found.applied_pressure / 1e9, found.relative_contact_area
    error = area.std("seed", ddof=1) / np.sqrt(samples)
    axes.plot(pressure, area.transpose("step", "seed"), color="0.85", lw=0.8, zorder=0)
    axes.errorbar(pressure, area.mean("seed"), error, fmt="o-", ms=4, capsize=3, label=name)
axes.set(xscale="log", yscale="log", xlabel="pressure (GPa)", ylabel="relative contact area")
axes.tick_params("x", which="minor", labelbottom=False)
axes.legend(frameon=False, title=f"{samples} surfaces")
figure.savefig("ensemble.png", dpi=150)
