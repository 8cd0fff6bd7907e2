"""A sheet on a rough surface
==========================

Sheets of three bending stiffnesses are pressed on a rough surface and released. The figure shows a section: adhesion
holds the most flexible sheet in the valleys, the stiffest rests on the hills.
"""

import matplotlib.pyplot as plt

import contact_study

study = {
    "surface": {
        "kind": "self_affine",
        "size": "60 nm",
        "shape": [64, 64],
        "rms_height": "1 nm",
        "roll_off_mode": 3,
        "cutoff_mode": 8,
    },
    "material": {"youngs_modulus": "1 TPa", "poissons_ratio": 0.2},
    "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": "0.2 J/m^2", "length": "0.8 nm"},
    "loading": {"path": ["1 GPa", "1 kPa"]},
    "output": {"fields": True},
}

figure, axes = plt.subplots(figsize=(6.4, 3.4), layout="constrained")
for stiffness in ("1.5 eV", "100 eV", "1500 eV"):
    found = contact_study.run({**study, "elasticity": {"kind": "sheet", "bending_stiffness": stiffness}})
    row = found.isel(step=-1, y=0)
    area = f"{100 * float(row.relative_contact_area):.0f} % in contact"
    axes.plot(row.x * 1e9, (row.height + row.gap) * 1e9, lw=1.2, label=f"κ = {stiffness}: {area}")
axes.fill_between(row.x * 1e9, row.height * 1e9, row.height.min() * 1e9, color="0.8", lw=0, label="rough surface")
axes.set(xlabel="x (nm)", ylabel="height (nm)")
figure.legend(frameon=False, ncols=2, loc="outside upper center")
figure.savefig("sheet.png", dpi=150)
