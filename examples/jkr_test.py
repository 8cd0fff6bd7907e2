"""A JKR test beside the model
===========================

A glass sphere is pressed on a soft rubber and pulled off; force, displacement and contact radius are measured. The
points here are synthetic: JKR theory with noise, written to a file as a test writes one. The figure shows them over
the computed curve. The computed sphere attracts over a finite range, so it snaps in a little earlier.
"""

import numpy as np
from matplotlib.figure import Figure

import contact_study
from contact_study import plots
from theory import JKR

radius, modulus, work = 5e-6, 2e6, 0.05  # R, E*, w

# The file of a test: synthetic, with noise of 3 nm, 30 nN and 20 nm.
sphere, random = JKR(radius, modulus, work), np.random.default_rng(1)
loading, unloading = np.linspace(0.0, 0.4e-6, 12), np.linspace(0.38e-6, 0.97 * sphere.pull_off_displacement, 24)
states = np.array([sphere.at_displacement(one) for one in np.concatenate([loading, unloading])])
states += np.array([3e-8, 3e-9, 2e-8]) * random.standard_normal(states.shape)
table = np.column_stack([states * 1e9, np.full(len(states), 30.0)])
np.savetxt("jkr_test.csv", table, "%.1f", ",", header="force (nN), displacement (nm), radius (nm), force error (nN)")

measured = contact_study.read_force_curve("jkr_test.csv")
computed = contact_study.run(
    {
        "surface": {"kind": "sphere", "size": "8 um", "shape": [80, 80], "radius": radius},
        "material": {"youngs_modulus": modulus, "poissons_ratio": 0.0},
        "elasticity": {"boundary": "free"},
        "interaction": {"law": "dugdale", "work_of_adhesion": work, "length": "0.1 um"},
        "loading": {"control": "approach", "path": [*loading, *np.arange(0.36, -0.5, -0.04) * 1e-6]},
    }
)
figure = Figure(figsize=(8, 3.6), layout="constrained")
left, right = figure.subplots(1, 2)
plots.force_curve(computed, left, measured=[measured], theories=["jkr", "maugis"])
plots.force_curve(computed, right, against="contact_radius", measured=[measured], theories=["jkr", "maugis"])
figure.savefig("jkr_test.png", dpi=150)
