"""Area coefficient, Hurst exponent and breadth of the spectrum
============================================================

After N. Prodanov, W. B. Dapp & M. H. Müser, Tribol. Lett. 53, 433 (2014): the contact area of light load is
κ p/(h' E*), with the rms slope h', and hardly depends on the Hurst exponent H. After V. A. Yastrebov, G. Anciaux &
J.-F. Molinari (2017), arXiv:1704.05650: it falls with the logarithm of the breadth of the spectrum, Nayak's α.
Their abstracts give no number.
"""

import matplotlib.pyplot as plt
import numpy as np

import contact_study
from bem_adhesion import HardWall, rough_contact
from contact_study.results.observables import corrected_area

size, points, seeds, modulus, pressure = 1e-6, 1024, (1, 2, 3), 1e9, 0.03
study = {
    "surface": {"kind": "self_affine", "size": size, "shape": [points, points], "rms_height": 1e-9}
    | {"hurst_exponent": 0.8, "roll_off_mode": 4, "cutoff_mode": 64},
    "material": {"youngs_modulus": modulus, "poissons_ratio": 0.0},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": [1e6]},
    "sweep": {"surface.hurst_exponent": [0.2, 0.5, 0.8], "surface.roll_off_mode": [4, 16], "surface.seed": list(seeds)},
}

found = {}
for case in contact_study.make_study(study).cases:
    surface = contact_study.realise(case)
    contact = rough_contact(surface.sampled, size, modulus, HardWall())
    state = contact.step(contact.separated(), pressure * surface.rms_slope * modulus)
    area = corrected_area(state.pressure > 0)
    # m0 m4 / m2² of an isotropic surface; rms_curvature is half of the rms Laplacian.
    breadth = 6 * (surface.rms_height * surface.roughness.rms_curvature) ** 2 / surface.rms_slope**4
    key = case.surface.hurst_exponent, case.surface.cutoff_mode / case.surface.roll_off_mode
    found.setdefault(key, []).append((breadth, area / pressure))

print("| H | cutoff / roll-off | α | κ |\n|---|---|---|---|")
rows = []
for (hurst, ratio), values in found.items():
    (breadth, kappa), (_, error) = np.mean(values, axis=0), np.std(values, axis=0) / np.sqrt(len(values) - 1)
    rows.append((hurst, breadth, kappa, error))
    print(f"| {hurst} | {ratio:.0f} | {breadth:.2f} | {kappa:.3f} ± {error:.3f} |")
hursts, breadths, kappas, errors = np.array(rows).T
slope, start = np.polyfit(np.log(breadths), kappas, 1)
print(f"\nκ = {start:.2f} − {-slope:.3f} ln α, within {np.abs(kappas - start - slope * np.log(breadths)).max():.3f}")

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
for hurst in np.unique(hursts):
    own = hursts == hurst
    axes.errorbar(breadths[own], kappas[own], errors[own], fmt="o", capsize=2, label=f"H = {hurst}")
line = np.geomspace(breadths.min(), breadths.max())
axes.semilogx(line, start + slope * np.log(line), color="0.6", label=f"{start:.2f} − {-slope:.3f} ln α")
axes.set(xlabel="Nayak's parameter α", ylabel="κ = A/A₀ · h' E*/p")
axes.set_xticks([3, 5, 10, 20], ["3", "5", "10", "20"])
axes.set_xticks([], minor=True)
axes.legend(frameon=False)
figure.savefig("area_coefficient.png", dpi=150)
