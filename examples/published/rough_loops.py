"""Preload, loss and pull-off of a rough sphere
============================================

After G. Violano & L. Afferrante, Lubricants 9, 7 (2021), doi:10.3390/lubricants9010007. Loops of a rough sphere from
rising preloads: the paper's abstract says that the loss increases linearly with the true area of contact, and that the
detachment force hardly depends on the preload.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import contact_study
from theory import JKR

warnings.filterwarnings("ignore", message="grid too coarse")  # to be quick

turns, points = (0.6, 1.1, 1.6, 2.1, 2.6), 128  # where loops turn, in units of displacement
radius, modulus, work = 1e-6, 1e9, 0.05  # R (m), E* (Pa), w (J/m²)
sphere = JKR(radius, modulus, work)
free = sphere.at_force(0.0)[2]  # contact radius without load
size, unit = 4.4 * free, free**2 / radius  # of the cell, and of displacements
reach = np.sqrt(2 * work * size / points / modulus)  # two points per process zone
study = {
    "form": {"kind": "paraboloid", "radii": radius},
    "surface": {"kind": "self_affine", "size": size, "shape": [points, points], "rms_height": "1.2 nm"}
    | {"hurst_exponent": 0.8, "low_mode": 4, "roll_off_mode": 4, "cutoff_mode": 16},
    "material": {"youngs_modulus": modulus, "poissons_ratio": 0.0},
    "elasticity": {"boundary": "free"},
    "interaction": {"law": "exponential", "work_of_adhesion": work, "length": reach},
    "loading": {"control": "approach"},
}
step, rows = 0.05, []
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 3.6), layout="constrained")
print("| preload / wR | contact area / πR² | loss / wπR² | pull-off / JKR |\n|---|---|---|---|")
for turn in turns:
    way_in = np.arange(-0.8, turn, step)
    study["loading"]["path"] = [*(way_in * unit), *(np.arange(way_in[-1] - step, -1.8, -step) * unit)]
    found = contact_study.run(study, "continuum")
    force, displacement = found.total_force.values, found.displacement.values
    area = float(found.contact_radius.max()) ** 2 / radius**2
    loss = np.trapezoid(force, displacement) / (np.pi * work * radius**2)
    rows.append((force.max() / (work * radius), area, loss, force.min() / sphere.pull_off_force))
    print("| {:.1f} | {:.5f} | {:.6f} | {:.3f} |".format(*rows[-1]))
    left.plot(displacement * 1e9, force * 1e9, label=f"{1e9 * force.max():.0f} nN")

_, area, loss, _ = np.transpose(rows)
slope, begun = np.polyfit(area, loss, 1)
print(f"\nloss = {begun:.2g} + {slope:.3f} times the area, correlation {np.corrcoef(area, loss)[0, 1]:.3f}")
lowest = 1e9 * force.min()
left.set(xlabel="displacement (nm)", ylabel="force (nN)", xlim=(-8, 8), ylim=(1.3 * lowest, -2 * lowest))
right.plot(area, loss, "o", label="boundary elements")
right.plot(area, begun + slope * area, "-", label="linear fit")
right.legend(frameon=False)
left.legend(title="preload", frameon=False)
right.set(xlabel="contact area / πR²", ylabel="loss / wπR²")
figure.savefig("rough_loops.png", dpi=150)
