"""A rough sphere that sticks
==========================

A sphere touches a soft solid and retreats, smooth and with self-affine roughness. The force curves show that
roughness weakens adhesion; the map shows that it breaks the contact into patches.
"""

import matplotlib.pyplot as plt
import numpy as np

import contact_study

side = 8  # µm
study = {
    "surface": {"kind": "flat", "size": f"{side} um", "shape": [128, 128]},
    "form": {"kind": "sphere", "radius": "10 um"},
    "material": {"youngs_modulus": "7.5 MPa", "poissons_ratio": 0.5},
    "elasticity": {"boundary": "free"},
    "interaction": {"law": "exponential", "work_of_adhesion": "50 mJ/m^2", "length": "45 nm"},
    "loading": {"control": "approach", "path": [f"{d} nm" for d in range(-250, 276, 25)], "unload": True},
    "output": {"fields": True},
}
rough = {"kind": "self_affine", "rms_height": "40 nm", "roll_off_mode": 4, "cutoff_mode": 24}

figure, (curve, image) = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
for name, surface in (("smooth", study["surface"]), ("rough", {**study["surface"], **rough})):
    found = contact_study.run({**study, "surface": surface})
    curve.plot(1e9 * found.applied_approach, side**2 * found.mean_pressure / 1e6, ".-", label=name)
pressed = found.pressure[np.argmax(found.mean_pressure.values)]
shown = image.imshow(pressed / 1e6, origin="lower", extent=[0, side, 0, side], cmap="RdBu_r", vmin=-2, vmax=2)
figure.colorbar(shown, label="pressure (MPa)")
image.set(title="rough sphere, largest force", xlabel="x (µm)", ylabel="y (µm)")
curve.axhline(0, color="0.7", zorder=0)
curve.set(xlabel="approach (nm)", ylabel="force (µN)")
curve.legend(frameon=False)
figure.savefig("rough_sphere.png", dpi=150)
