"""When rough surfaces stick
=========================

After L. Pastewka & M. O. Robbins, PNAS 111, 3298 (2014), doi:10.1073/pnas.1320846111. The area of light contact is
proportional to the load, and above a threshold of the work of adhesion the prefactor changes sign. Here it is the
secant at a contact area of one per cent, beside the thresholds of four criteria for the same surfaces. Theirs is shown
for the diameter d = 4 h'/h'' of patches, rms slope over curvature, and for that measured without adhesion.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import contact_study
from bem_adhesion import Exponential, HardWall, rough_contact
from contact_study.results.observables import edge_sides
from theory import stickiness

warnings.filterwarnings("ignore", message="grid too coarse")  # of sticky surfaces, beyond the threshold

size, points, seeds, modulus, height, share = 1e-6, 128, (1, 2, 3, 4), 1e9, 5e-9, 0.01
ranges = np.array([0.6, 1.2, 2.4]) * 1e-9  # of the attraction (m)
names = ("persson_tosatti", "bearing_area", "dmt_tension", "pastewka_robbins")
labels = ("Persson–Tosatti", "bearing area", "DMT tension", "Pastewka–Robbins", "the same, measured d")
study = {
    "surface": {"kind": "self_affine", "size": size, "shape": [points, points], "rms_height": height}
    | {"hurst_exponent": 0.8, "roll_off_mode": 4, "cutoff_mode": 16},
    "material": {"youngs_modulus": modulus, "poissons_ratio": 0.0},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": [1e6]},
    "sweep": {"surface.seed": list(seeds)},
}


def load_over_area(surface, law):
    """Load over area, in units of rms slope and modulus, where the repulsive area first exceeds the share."""
    contact = rough_contact(surface.sampled, size, modulus, law, control="gap")
    state, gap, loads, areas = contact.separated(), 2.4 * height, [], []
    while not areas or areas[-1] < share:
        state, gap = contact.step(state, gap), 0.94 * gap
        loads.append(state.pressure.mean())
        areas.append((state.pressure > 0).mean())
    return np.interp(share, areas, loads) / (share * surface.rms_slope * modulus)


cases = contact_study.make_study(study).cases
surfaces = [contact_study.realise(case) for case in cases]
slope, curvature = surfaces[0].rms_slope, surfaces[0].roughness.rms_curvature
estimated, measured = 4 * slope / curvature, []
for surface in surfaces:
    contact = rough_contact(surface.sampled, size, modulus, HardWall())
    touching = contact.step(contact.separated(), 0.5 * share * surface.rms_slope * modulus).pressure > 0
    measured.append(4 * touching.sum() * size / points / sum(edge_sides(touching)))  # π times area over perimeter
diameter = np.mean(measured)
reduced = ranges / (slope * diameter)
works, thresholds, known = np.geomspace(0.005, 0.1, 7), [], {label: [] for label in labels}
for reach in ranges:
    criteria = stickiness(cases[0].scales.spectrum, modulus, Exponential(1.0, reach))
    for name, label in zip(names, labels, strict=False):
        known[label].append(1 / getattr(criteria, name))
    known[labels[-1]].append(known["Pastewka–Robbins"][-1] * (diameter / estimated) ** (2 / 3))
    own = []
    for surface in surfaces:
        falling = [load_over_area(surface, Exponential(work, reach)) for work in works]
        own.append(np.interp(0, np.negative(falling), works))
    thresholds.append((np.mean(own), np.std(own) / np.sqrt(len(own) - 1)))

print(f"| range / h'd | threshold (J/m²) | {' | '.join(labels)} |\n{'|---' * 7}|")
for number, (work, error) in enumerate(thresholds):
    others = " | ".join(f"{values[number]:.3f}" for values in known.values())
    print(f"| {reduced[number]:.3f} | {work:.3f} ± {error:.3f} | {others} |")

figure, axes = plt.subplots(figsize=(5.2, 4.4), layout="constrained")
axes.errorbar(reduced, *np.transpose(thresholds), fmt="ko", capsize=2, label="boundary elements")
for label, values in known.items():
    axes.plot(reduced, values, label=label)
axes.set(ylim=(0, None), xlabel="range of attraction / h'd", ylabel="threshold of sticking (J/m²)")
figure.legend(frameon=False, loc="outside upper center", ncols=2)
figure.savefig("stickiness.png", dpi=150)
