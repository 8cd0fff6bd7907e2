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
} | {"roll_off_mode": 2, "cutoff_mode": 16}
up, tension = [0.1, 0.3, 0.6, 1.0, 1.5, 2.0], [0.0, -0.03, -0.06, -0.1, -0.15]  # GPa
wall = {"law": "hard_wall"}
adhesive = {"law": "exponential", "work_of_adhesion": "2 J/m^2", "length": "2 nm"}

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for label, interaction, hardness, colour in (
    ("elastic", wall, None, "C0"),
    ("hardness 6 GPa", wall, "6 GPa", "C1"),
    ("hardness 6 GPa, adhesion", adhesive, "6 GPa", "C2"),
):
    material = {"youngs_modulus": "100 GPa", "poissons_ratio": 0.3} | ({"hardness": hardness} if hardness else {})
    path = up + up[-2::-1] + (tension if interaction is adhesive else [])
    study = {"surface": surface, "material": material, "interaction": interaction}
    found = run(study | {"loading": {"path": [f"{pressure} GPa" for pressure in path]}})
    pressure, area = found.mean_pressure / 1e9, found.relative_contact_area.where(found.detached == 0)
    way_in, way_out = slice(0, len(up)), slice(len(up) - 1, None)
    axes.plot(pressure[way_in], area[way_in], "o-", color=colour, markersize=4, label=label)
    axes.plot(pressure[way_out], area[way_out], "o--", color=colour, markersize=4, markerfacecolor="white")
axes.set(xlabel="pressure (GPa)", ylabel="relative contact area", ylim=(0, None))
axes.axvline(0, color="0.7", zorder=0)
figure.legend(frameon=False, title="unloading dashed", loc="outside upper center", ncols=3)
figure.savefig("hardness.png", dpi=150)
