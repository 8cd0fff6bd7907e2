"""A probe that waits on a rubber
===============================

A spring presses a sphere on a rubber until a trigger force. The machine holds still for a dwell and pulls off. The
contact grows while the machine waits, and the pull-off force with it.
"""

import matplotlib.pyplot as plt

import contact_study
from contact_study import plots

study = {
    "surface": {"kind": "sphere", "radius": "1 um", "size": "1.6 um", "shape": [54, 54]},
    "material": {"youngs_modulus": "10 MPa", "poissons_ratio": 0.5},
    "elasticity": {"kind": "viscoelastic", "branch_youngs_moduli": ["90 MPa"], "relaxation_times": ["1 s"]},
    "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": "40 nm"},
    "loading": {
        "control": "approach",
        "adaptive": True,
        "path": ["-100 nm", "1 um", "1 um", "-800 nm"],  # the trigger ends the way in; the next point is the dwell
        "speed": "1 um/s",
        "machine_stiffness": "2 N/m",
        "trigger_force": "200 nN",
    },
    "sweep": {"loading.duration": ["0.01 s", "1 s", "10 s"]},
}
found = contact_study.run(study, "continuum")
print("pull-off force (nN):", (found.pull_off_force.values * 1e9).round())

figure, panels = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
plots.force_curve(found, panels[0])
panels[1].semilogx(found.duration, -1e9 * found.pull_off_force, "o-", label="pull-off force (nN)")
panels[1].semilogx(found.duration, 1e9 * found.contact_radius.values[:, 2], "s--", label="contact radius before (nm)")
panels[1].set(xlabel="dwell (s)", ylim=(0, None))
panels[1].legend(frameon=False)
figure.savefig("rubber_probe.png", dpi=150)
