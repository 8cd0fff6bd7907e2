"""Loss of a loop and the mesh
===========================

After A. Wang, Y. Zhou & M. H. Müser, Lubricants 9, 17 (2021), doi:10.3390/lubricants9020017. A mesh of size a carries
adhesion of no shorter range than about √(w a/E*). A sphere then jumps into contact early, and its loop under a
prescribed approach loses less than that of Johnson, Kendall and Roberts. The paper's abstract: the correction vanishes
at best with the third root of the mesh size.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import contact_study
from theory import JKR

warnings.filterwarnings("ignore", message="grid too coarse")  # the grids are the subject

grids, radius, modulus, work = (48, 72, 108, 162), 1e-6, 1e9, 0.05  # points, R (m), E* (Pa), w (J/m²)

# The loop under a prescribed approach loses the work of JKR's sphere between pull-off and an approach of zero.
sphere = JKR(radius, modulus, work)
curve = sphere.curve(sphere.at_displacement(0.0)[0], 2000)
loss = -float(np.trapezoid(curve.force[curve.held], curve.displacement[curve.held]))
off = sphere.pull_off_displacement
size = 2.86 * sphere.at_force(0.0)[2]  # over the contact radius without load

missing = []
print("| mesh size / cell | loss / loss of JKR | pull-off / JKR | order, published 1/3 |\n|---|---|---|---|")
for points in grids:
    reach = np.sqrt(work * size / points / modulus)  # one point per process zone
    loop = contact_study.run(
        {
            "surface": {"kind": "sphere", "size": size, "shape": [points, points], "radius": radius},
            "material": {"youngs_modulus": modulus, "poissons_ratio": 0.0},
            "elasticity": {"boundary": "free"},
            "interaction": {"law": "exponential", "work_of_adhesion": work, "length": reach},
            "loading": {"control": "approach", "adaptive": True, "resolution": 0.005}
            | {"path": [-12 * reach, -0.5 * off, 2.2 * off - 2 * reach]},
        },
        "continuum",
    )
    lost, unknown, force = (
        float(loop[name].values.ravel()[-1]) * size**2
        for name in ("dissipated_energy", "dissipated_energy_resolution_error", "pull_off_pressure")
    )
    missing.append(1 - lost / loss)
    order = np.log(missing[-1] / missing[-2]) / np.log(grids[len(missing) - 2] / points) if len(missing) > 1 else np.nan
    pull_off = force / sphere.pull_off_force
    print(
        f"| 1/{points} | {lost / loss:.3f} ± {unknown / loss:.3f} | {pull_off:.3f} | {order:.2f} |".replace("nan", "")
    )

mesh = 1 / np.array(grids)
figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
axes.loglog(mesh, missing, "o", label="one point per process zone")
axes.loglog(mesh, missing[-1] * np.cbrt(mesh / mesh[-1]), "-", color="0.6", label="slope 1/3")
axes.set(xlabel="mesh size / cell", ylabel="1 − loss / loss of JKR")
axes.legend(frameon=False)
figure.savefig("hysteresis_mesh.png", dpi=150)
