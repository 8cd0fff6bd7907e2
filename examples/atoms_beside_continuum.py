"""Atoms beside the continuum
==========================

One surface is pressed twice, on a block of atoms and on a half-space with the law of the same atoms, smeared. The
figure shows equal areas within a few per cent, and the same patches in the two maps of the gap.
"""

import matplotlib.pyplot as plt
import numpy as np

import bem_adhesion
import md_reference

atoms, spacing, modulus, poisson, well, r0 = 64, 0.26e-9, 77.2e9, 0.42, 2.98e-21, 0.328e-9  # n, a, E, ν, ε, r0
size = atoms * spacing
x, y = np.meshgrid(*[2 * np.pi * np.arange(atoms) / atoms] * 2)
height = 0.25e-9 * (np.cos(x) + np.cos(y) + 0.5 * np.cos(2 * x + y) + 0.5 * np.sin(x - 3 * y))

# Two layers of atoms, smeared: Δγ = (6π/5) n_a n_b ε r0²; the substrate is denser by the golden mean squared.
work = 6 * np.pi / 5 / spacing**2 * (round(atoms * (1 + 5**0.5) / 2) / size) ** 2 * well * r0**2
law = bem_adhesion.LennardJones104(work, r0)
half_space = bem_adhesion.rough_contact(height, size, modulus / (1 - poisson**2), law)
block = md_reference.rough_contact(height, size, spacing, modulus, poisson, well, r0)

figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), layout="constrained", width_ratios=(1.2, 1, 1))
pressures = np.geomspace(0.2, 8, 6)  # GPa
for name, contact, panel in (("half-space", half_space, axes[1]), ("atoms", block, axes[2])):
    state, gaps = contact.separated(), []
    for pressure in pressures:
        solution = contact.step(state, pressure * 1e9)
        state = solution.state
        gaps.append(solution.gap)
    axes[0].semilogx(pressures, [np.mean(gap < 2 ** (1 / 6) * r0) for gap in gaps], "o-", mfc="w", label=name)
    image = panel.imshow(gaps[3] * 1e9, vmin=0.3, vmax=1, extent=[0, size * 1e9] * 2, origin="lower")
    panel.set(xlabel="x (nm)", yticks=[], title=f"{name}, {pressures[3]:.1f} GPa")
axes[0].set(xlabel="pressure (GPa)", ylabel="relative contact area")
axes[0].tick_params("x", which="minor", labelbottom=False)
axes[0].legend(frameon=False)
figure.colorbar(image, ax=axes[1:], label="gap (nm)")
figure.savefig("atoms_beside_continuum.png", dpi=150)
