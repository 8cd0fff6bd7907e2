"""Small gaps at the edges of contact
==================================

After J. M. Monti, A. Sanner & L. Pastewka, Tribol. Lett. 69 (2021), doi:10.1007/s11249-021-01454-6. Without adhesion
the contact area is κ F/(h' E*), with κ about 2 and the rms slope h'. The density of gaps is a power law, up to the rms
slope times the mean diameter of the patches. Near an edge the gap rises as the 3/2 power of the distance; from that
follows the exponent −1/3.
"""

import matplotlib.pyplot as plt
import numpy as np

import contact_study
from bem_adhesion import HardWall, rough_contact
from contact_study.results.observables import corrected_area, edge_sides

size, points, seeds, modulus = 1e-6, 2048, (1, 2, 3), 1e9
study = {
    "surface": {
        "kind": "self_affine",
        "size": size,
        "shape": [points, points],
        "rms_height": 1e-9,
        "hurst_exponent": 0.8,
    }
    | {"roll_off_mode": 2, "cutoff_mode": 32},
    "material": {"youngs_modulus": modulus, "poissons_ratio": 0.0},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": [1e6]},
}
# Bins of the gap over slope times diameter; the grid blurs what is smaller than the gap one point away from an edge.
edges = np.geomspace(1e-4, 1, 17)
middle = np.sqrt(edges[1:] * edges[:-1])
fitted = (middle > 1e-3) & (middle < 2e-2)

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
print("| p / (h' E*) | A / A₀ | κ, published about 2 | exponent, −1/3 for a 3/2 power |\n|---|---|---|---|")
for pressure in (0.02, 0.05):
    areas, exponents, densities = [], [], []
    for case in contact_study.make_study({**study, "sweep": {"surface.seed": list(seeds)}}).cases:
        surface = contact_study.realise(case)
        contact = rough_contact(surface.sampled, size, modulus, HardWall())
        state = contact.step(contact.separated(), pressure * surface.rms_slope * modulus)
        touching = state.pressure > 0
        sides = edge_sides(touching)
        areas.append(corrected_area(touching, sides))
        diameter = 4 * areas[-1] * size**2 / (np.pi / 4 * sum(sides) * size / points)  # 4 A/perimeter
        gaps = state.gap[~touching] / (surface.rms_slope * diameter)
        densities.append(np.histogram(gaps, edges)[0] / np.diff(edges) / touching.size)
        exponents.append(np.polyfit(np.log(middle[fitted]), np.log(densities[-1][fitted]), 1)[0])
    kappa, power = (f"{np.mean(one):.2f} ± {np.std(one):.2f}" for one in (np.array(areas) / pressure, exponents))
    print(f"| {pressure} | {np.mean(areas):.3f} | {kappa} | {power} |")
    axes.loglog(middle, np.mean(densities, axis=0), "o-", ms=4, label=f"contact area {100 * np.mean(areas):.1f} %")

line = middle[fitted]
axes.loglog(
    line, 1.25 * np.mean(densities, axis=0)[fitted][0] * np.cbrt(line[0] / line), color="0.6", label="slope −1/3"
)
axes.set(xlabel="gap / (rms slope × mean diameter)", ylabel="probability density of the gap")
axes.legend(frameon=False)
figure.savefig("edge_gaps.png", dpi=150)
