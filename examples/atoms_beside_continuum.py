"""Atoms beside the continuum
==========================

One surface, twice: a block of atoms and an elastic half-space with the smeared law of the same atoms::

    python examples/atoms_beside_continuum.py -o atoms_beside_continuum.png
"""

import argparse

import matplotlib.pyplot as plt
import numpy as np

import bem_adhesion
import md_reference

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("-o", "--output", default="atoms_beside_continuum.png", help="figure")
parser.add_argument("--atoms", type=int, default=64, help="atoms a side")
arguments = parser.parse_args()

spacing, modulus, poisson, well, r0 = 0.26e-9, 77.2e9, 0.42, 2.98e-21, 0.328e-9  # a, E, ν, ε, r0
atoms, size = arguments.atoms, arguments.atoms * spacing
y, x = np.meshgrid(*[2 * np.pi * np.arange(atoms) / atoms] * 2, indexing="ij")
height = 0.25e-9 * (np.cos(x) + np.cos(y) + 0.5 * np.cos(2 * x + y) + 0.5 * np.sin(x - 3 * y))

# Two layers of atoms, smeared: Δγ = (6π/5) n_a n_b ε r0², with the substrate denser by the golden mean squared.
densities = 1 / spacing**2, (round(atoms * (1 + 5**0.5) / 2) / size) ** 2
law = bem_adhesion.LennardJones104(6 * np.pi / 5 * densities[0] * densities[1] * well * r0**2, r0)
continuum = bem_adhesion.rough_contact(height, size, modulus / (1 - poisson**2), law)
block = md_reference.rough_contact(height, size, spacing, modulus, poisson, well, r0)

pressures = np.geomspace(0.2e9, 8e9, 6)
touching = 2 ** (1 / 6) * r0
found = {}
for name, contact in (("half-space", continuum), ("atoms", block)):
    state, found[name] = contact.separated(), []
    for pressure in pressures:
        found[name].append(contact.step(state, pressure))
        state = found[name][-1].state

figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), layout="constrained", width_ratios=(1.2, 1, 1))
for name, marker in (("half-space", "o-"), ("atoms", "s--")):
    areas = [np.mean(solution.gap < touching) for solution in found[name]]
    axes[0].semilogx(pressures / 1e9, areas, marker, mfc="w", label=name)
axes[0].set(
    xlabel="pressure (GPa)",
    ylabel="relative contact area",
    xticks=[0.2, 0.5, 1, 2, 5],
    xticklabels=["0.2", "0.5", "1", "2", "5"],
)
axes[0].minorticks_off()
axes[0].legend(frameon=False)
middle = len(pressures) // 2
for panel, name in zip(axes[1:], found, strict=True):
    image = panel.imshow(found[name][middle].gap * 1e9, vmin=0.3, vmax=1, extent=[0, size * 1e9] * 2, origin="lower")
    panel.set(xlabel="x (nm)", yticks=[], title=f"{name}, {pressures[middle] / 1e9:.1f} GPa")
figure.colorbar(image, ax=axes[1:], label="gap (nm)")
figure.savefig(arguments.output, dpi=150)
