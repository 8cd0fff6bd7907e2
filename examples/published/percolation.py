"""Contact area at which a seal closes
===================================

After W. B. Dapp, A. Lücke, B. N. J. Persson & M. H. Müser, Phys. Rev. Lett. 108, 244301 (2012), arXiv:1308.3449, and
A. Wang & M. H. Müser, Tribol. Lett. (2021), doi:10.1007/s11249-020-01378-7. Elastic deformation lowers the contact area
at which no fluid passes any more; the later paper confirms an area near 0.415. Cut by a plane, without deformation, a
Gaussian surface closes at a half, as heights of both signs are alike.
"""

import matplotlib.pyplot as plt
import numpy as np

import contact_study
from bem_adhesion import HardWall, rough_contact
from contact_study.results.observables import corrected_area
from contact_study.results.observables.clusters import channels
from contact_study.results.observables.leakage import hydraulic_gaps

size, points, seeds, modulus = 1e-6, 256, range(1, 33), 1e9
surface = {"kind": "self_affine", "size": size, "shape": [points, points], "rms_height": 1e-9, "hurst_exponent": 0.8}
study = {
    "surface": surface | {"roll_off_mode": 8, "cutoff_mode": 32},
    "material": {"youngs_modulus": modulus, "poissons_ratio": 0.0},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": [1e6]},
    "sweep": {"surface.seed": list(seeds)},
}


def closing(contact_at, low, high):
    """Areas at which the gap closes along y and along x: loads are halved eight times."""
    found = []
    for axis, ends in enumerate(([low, high], [low, high])):
        for _ in range(8):
            middle = 0.5 * sum(ends)
            ends[0 if channels(~contact_at(middle))[axis].any() else 1] = middle
        found.append(0.5 * sum(corrected_area(contact_at(end)) for end in ends))
    return found


elastic, cut, open_states = [], [], []
for case in contact_study.make_study(study).cases:
    rough = contact_study.realise(case)
    heights, stress, states = rough.sampled, rough.rms_slope * modulus, {}
    contact = rough_contact(heights, size, modulus, HardWall())

    def pressed(load, contact=contact, states=states, stress=stress):
        """Contact under a load, in units of rms slope and modulus."""
        if load not in states:
            states[load] = contact.step(contact.separated(), load * stress)
        return states[load].pressure > 0

    elastic += closing(pressed, 0.1, 0.4)
    open_states.append([states[load] for load in sorted(states) if channels(states[load].pressure <= 0)[1].any()])
    cut += closing(lambda level, heights=heights: heights > -level, -heights.max(), heights.max())

print("| contact | area at which the gap closes | published |\n|---|---|---|")
for words, areas, known in (("elastic", elastic, "near 0.415"), ("cut by a plane", cut, "")):
    error = np.std(areas) / np.sqrt(len(areas) / 2)  # the two directions of a surface are not independent
    print(f"| {words} | {np.mean(areas):.3f} ± {error:.3f} | {known} |")

apart = {"wspace": 0.1}
figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.5), layout="constrained", gridspec_kw=apart)
last, closed = open_states[0][-1], open_states[0][-1].pressure > 0
gaps = np.ma.masked_where(closed, 1e9 * last.gap)
image = left.imshow(gaps, norm="log", vmin=1e-3, origin="lower", extent=(0, 1) * 2)
left.set(xlabel="x / L", ylabel="y / L", title=f"last channel along x, contact area {corrected_area(closed):.2f}")
figure.colorbar(image, ax=left, label="gap (nm), contact white")
for path in open_states[:6]:
    films = [np.where(state.pressure > 0, 0.0, state.gap) for state in path]
    leaks = [1e9 * hydraulic_gaps(film, (size / points, size / points))[1] for film in films]
    right.semilogy([corrected_area(film == 0) for film in films], leaks, ".-", lw=0.8)
right.axvline(0.415, color="0.4", ls=":")  # published
right.set(xlabel="relative contact area", ylabel="hydraulic gap along x (nm)", title="dotted: published closing area")
figure.savefig("percolation.png", dpi=150)
