"""Apparent work of adhesion of a rough probe
==========================================

After S. Dalvi, A. Gujrati, S. R. Khanal, L. Pastewka, A. Dhinojwala & T. D. B. Jacobs, PNAS 116, 25484 (2019),
doi:10.1073/pnas.1913126116. On approach a soft sphere touches a rough surface as JKR's would with a lower work of
adhesion: less by the energy U of conformal contact. Here the reduction is about half of U, also on a finer grid with a
shorter range of the attraction. The edge flow's work of separation on both branches is what a flat contact of the same
roughness has.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import contact_study
from bem_adhesion import ExponentialCore
from theory import JKR, edge_flow

warnings.filterwarnings("ignore", message="grid too coarse")  # to be quick

shares, points, radius, modulus, work = (0.0, 0.2, 0.4), 144, 1e-6, 1e9, 0.05  # U/w, points, R (m), E* (Pa), w (J/m²)
sphere = JKR(radius, modulus, work)
free = sphere.at_force(0.0)[2]  # contact radius without load
size = 3.3 * free
reach = np.sqrt(work * size / points / modulus)  # the grid's shortest attraction, one point per process zone
study = {
    "form": {"kind": "paraboloid", "radii": radius},
    "surface": {"kind": "self_affine", "size": size, "shape": [points, points], "rms_height": 1e-10}
    | {"hurst_exponent": 0.8, "low_mode": 8, "roll_off_mode": 8, "cutoff_mode": 9},
    "material": {"youngs_modulus": modulus, "poissons_ratio": 0.0},
    "elasticity": {"boundary": "free"},
    "interaction": {"law": "exponential", "work_of_adhesion": work, "length": reach},
    "loading": {"control": "approach"},
    "output": {"fields": True},
}
path = np.concatenate([np.linspace(-0.4, 1.2, 20), np.linspace(1.1, -2.5, 45)]) * free**2 / radius

# Elastic energy of conformal contact, E*/4 Σ q |h(q)|², of the roughness without the form.
rough = contact_study.realise(contact_study.make_study({**study, "form": {}, "loading": {"path": [0.0]}}).cases[0])
waves = np.abs(np.fft.fft2(rough.sampled) / points**2) ** 2
q = 2 * np.pi / size * np.hypot(*np.meshgrid(*2 * [np.fft.fftfreq(points, 1 / points)]))
conformal = modulus / 4 * np.sum(q * waves)

law = ExponentialCore(work, reach, reach, 0.04 * reach)  # a short repulsion in place of the wall
rows = []
figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
print("| U / w | reduction on approach / w | edge flow | on retraction / w | edge flow | pull-off / JKR |")
print("|---|---|---|---|---|---|")
for share in shares:
    study["surface"]["rms_height"] = 1e-10 * max(np.sqrt(share * work / conformal), 1e-6)
    study["loading"]["path"] = list(path)
    found = contact_study.run(study, "continuum")
    y, x = (found[name] - found[name].mean() for name in ("y", "x"))
    # Outer radius of contact, breaks inside included: a disk of radius a has the mean square distance a²/2.
    inside = (x**2 + y**2).where(found.gap < reach)
    a = np.sqrt(2 * inside.mean(("y", "x"))).values
    force = found.total_force.values
    apparent = (4 * modulus * a**3 / (3 * radius) - force) ** 2 / (8 * np.pi * modulus * a**3) / work
    on_approach = np.arange(path.size) < 20
    mean = [np.nanmean(apparent[way & (a > 0.4 * free)]) for way in (on_approach, ~on_approach)]
    rows.append(mean)
    pull_off = force.min() / sphere.pull_off_force
    flat = [0.0, 0.0]
    if share:
        spectrum = contact_study.realise(contact_study.make_study({**study, "form": {}}).cases[0]).measured_spectrum()
        flows = (edge_flow(spectrum, modulus, law, branch=branch) for branch in ("loading", "unloading"))
        flat = [1 - flow.work_of_separation / work for flow in flows]
    cells = (f"{rows[0][way] - mean[way]:.2f} | {flat[way]:.2f}" for way in (0, 1))
    print(f"| {share} | {' | '.join(cells)} | {pull_off:.2f} |")
    lines = axes.plot(a * 1e9, np.where(on_approach, force, np.nan) * 1e9, "--", label=f"U = {share} w")
    axes.plot(a * 1e9, np.where(~on_approach, force, np.nan) * 1e9, color=lines[0].get_color())

axes.set(xlabel="contact radius (nm)", ylabel="force (nN)", title="approach dashed, retraction solid")
axes.legend(frameon=False)
figure.savefig("rough_probe.png", dpi=150)
