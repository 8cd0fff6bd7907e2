"""What snaps: the cantilever
============================

A soft sphere is brought into contact and pulled off by cantilevers of three stiffnesses, each until a trigger force.
The figure shows that a soft cantilever snaps in and off along lines of its own stiffness, and a stiff one does not
jump at all; all of them measure one pull-off force.
"""

import warnings

import matplotlib.pyplot as plt

import contact_study
from contact_study import plots

warnings.filterwarnings("ignore", message=".*process zone")
study = {
    "surface": {"kind": "sphere", "radius": "100 nm", "size": "100 nm", "shape": [48, 48]},
    "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3},
    "elasticity": {"boundary": "free"},
    "interaction": {"law": "exponential", "work_of_adhesion": "50 mJ/m^2", "length": "1 nm"},
    "loading": {
        "control": "approach",
        "path": ["-6 nm", "60 nm", "-50 nm"],  # the trigger ends the way in
        "trigger_force": "20 nN",
        "adaptive": True,
    },
    "sweep": {"loading.machine_stiffness": ["1 N/m", "3 N/m", "100 N/m"]},
}
found = contact_study.run(study, "continuum")
print("pull-off force (nN):", (found.pull_off_force.values * 1e9).round(2))

figure, panels = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
for axes, against in zip(panels, ("displacement", "approach"), strict=True):
    plots.force_curve(found, axes, against)
    axes.set_xlim(-42, 25)
    axes.legend(loc="upper left", fontsize=8)
panels[1].get_legend().remove()
figure.savefig("cantilever.png", dpi=150)
