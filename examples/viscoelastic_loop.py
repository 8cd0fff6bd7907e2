"""A viscoelastic loop
===================

A rubber is pressed and released at three speeds. The figure shows that the loop is widest where one way takes about
one relaxation time; slow and fast loops lose little.
"""

import matplotlib.pyplot as plt

from contact_study import run

study = {
    "surface": {
        "kind": "self_affine",
        "size": "1 mm",
        "shape": [48, 48],
        "rms_height": "10 um",
        "roll_off_mode": 2,
        "cutoff_mode": 8,
    },
    "material": {"youngs_modulus": "1 MPa", "poissons_ratio": 0.5},
    "elasticity": {"kind": "viscoelastic", "branch_youngs_moduli": ["9 MPa"], "relaxation_times": ["1 s"]},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": ["20 kPa", "50 kPa", "100 kPa", "200 kPa", "300 kPa"], "unload": True, "time_steps": 4},
}

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for duration in ("1 ms", "0.2 s", "100 s"):
    found = run({**study, "loading": {**study["loading"], "duration": duration}})
    axes.plot(found.mean_gap * 1e6, found.mean_pressure / 1e3, "o-", markersize=3, label=f"{duration} a step")
axes.set(xlabel="mean gap (µm)", ylabel="pressure (kPa)")
axes.legend(frameon=False)
figure.savefig("viscoelastic_loop.png", dpi=150)
