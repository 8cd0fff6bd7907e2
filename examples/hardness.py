"""A surface that yields
=====================

The pressure cannot exceed the hardness, and what has yielded stays. The loop shows that unloading is elastic: it
returns along another curve, with more contact at the same load. Adhesion holds that contact down to a tension.
"""

import matplotlib.pyplot as plt

from contact_study import run

surface = {
    "kind": "self_affine",
    "size": "1 um",
    "shape": [96, 96],
    "rms_height": "10 nm",
    "roll_off_mode": 2,
    "cutoff_mode": 16,
}
loading = {"path": ["0.1 GPa", "0.3 GPa", "0.6 GPa", "1 GPa", "1.5 GPa", "2 GPa"], "unload": True}
wall = {"law": "hard_wall"}
adhesive = {"law": "exponential", "work_of_adhesion": "2 J/m^2", "length": "2 nm"}

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for label, interaction, hardness, colour in (
    ("elastic", wall, None, "C0"),
    ("hardness 6 GPa", wall, "6 GPa", "C1"),
    ("hardness 6 GPa, adhesion", adhesive, "6 GPa", "C2"),
):
    material = {"youngs_modulus": "100 GPa", "poissons_ratio": 0.3} | ({"hardness": hardness} if hardness else {})
    found = run({"surface": surface, "material": material, "interaction": interaction, "loading": loading})
    axes.plot(found.mean_pressure / 1e9, found.relative_contact_area, "o-", color=colour, markersize=4, label=label)
axes.set(xlabel="pressure (GPa)", ylabel="relative contact area")
axes.legend(frameon=False)
figure.savefig("hardness.png", dpi=150)
