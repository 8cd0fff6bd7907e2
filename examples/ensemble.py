"""An ensemble with error bars
===========================

Twelve samples of one roughness: mean contact area and its standard error, with and without adhesion::

    python examples/ensemble.py -o ensemble.png
"""

import argparse

import matplotlib.pyplot as plt
import numpy as np

from contact_study import run

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("-o", "--output", default="ensemble.png", help="figure")
parser.add_argument("--samples", type=int, default=12, help="surfaces")
arguments = parser.parse_args()

study = {
    "surface": {
        "kind": "self_affine",
        "size": "52 nm",
        "shape": [96, 96],
        "hurst_exponent": 0.8,
        "rms_height": "5 angstrom",
        "roll_off_mode": 2,
        "cutoff_mode": 8,
    },
    "material": {"youngs_modulus": "77.2 GPa", "poissons_ratio": 0.42},
    "loading": {"path": ["0.2 GPa", "0.5 GPa", "1 GPa", "2 GPa", "5 GPa"]},
    "sweep": {"surface.seed": list(range(1, arguments.samples + 1))},
}
laws = {
    "adhesive": {"law": "lennard_jones_10_4", "work_of_adhesion": "0.7 J/m^2", "length": "3.28 angstrom"},
    "hard wall": {"law": "hard_wall"},
}

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for name, interaction in laws.items():
    dataset = run(study | {"interaction": interaction})
    area = dataset.relative_contact_area
    error = area.std("seed", ddof=1) / np.sqrt(area.sizes["seed"])
    pressure = dataset.applied_pressure / 1e9
    axes.plot(pressure, area.transpose("step", "seed"), color="0.85", lw=0.8, zorder=0)
    axes.errorbar(pressure, area.mean("seed"), error, fmt="o-", ms=4, capsize=3, label=name)
axes.set(xscale="log", yscale="log", xlabel="pressure (GPa)", ylabel="relative contact area")
axes.set_xticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
axes.minorticks_off()
axes.legend(frameon=False, title=f"{arguments.samples} surfaces")
figure.savefig(arguments.output, dpi=150)
