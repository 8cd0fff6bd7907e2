"""Pull-off of a sphere from a rubber
==================================

A sphere rests on a rubber until it has relaxed, and is pulled off at different speeds. Adaptive steps of time resolve
the slide at pull-off. The work of separation is largest at intermediate speeds, the pull-off force at the fastest.
"""

import matplotlib.pyplot as plt
import numpy as np

from contact_study import run

study = {
    "surface": {"kind": "sphere", "radius": "1 um", "size": "1.6 um", "shape": [54, 54]},
    "material": {"youngs_modulus": "10 MPa", "poissons_ratio": 0.5},
    "elasticity": {"kind": "viscoelastic", "branch_youngs_moduli": ["90 MPa"], "relaxation_times": ["1 s"]},
    "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": 0.05, "length": "40 nm"},
}
loading = {"control": "gap", "adaptive": True, "path": ["300 nm", "200 nm", "200 nm", "500 nm"], "duration": "30 s"}

speeds, forces, works = np.geomspace(1e-10, 1e-5, 8), [], []
for speed in speeds:
    found = run({**study, "loading": {**loading, "speed": [1e-6, 1e-8, 1e-8, float(speed)]}})
    forces.append(-found.pull_off_force.item())
    works.append(found.separation_energy.item())

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
axes.semilogx(speeds, np.divide(works, works[0]), "o-", label="work of separation")
axes.semilogx(speeds, np.divide(forces, forces[0]), "s--", label="pull-off force")
axes.set(xlabel="retraction speed (m/s)", ylabel="over the value at the slowest speed")
axes.legend(frameon=False)
figure.savefig("viscoelastic_pull_off.png", dpi=150)
