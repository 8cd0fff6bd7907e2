"""A sphere that sticks
====================

A smooth sphere is pressed on a soft solid and pulled off. The figure shows that the contact radius follows
the theory of Johnson, Kendall and Roberts, and that contact ends near its pull-off force −3/2 π w R.
"""

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import LennardJones104, rough_contact
from theory import JKR

radius, modulus, work, length = 50e-9, 1e9, 0.05, 0.4e-9  # R, E*, w, r0
size, points = 60e-9, 288
x = (np.arange(points) - points // 2) * size / points
contact = rough_contact(-(x[:, None] ** 2 + x**2) / (2 * radius), size, modulus, LennardJones104(work, length))

unit = np.pi * work * radius
loading = np.linspace(0.05, 3, 8)
unloading = np.concatenate([loading[-2::-1], np.arange(-0.1, -2, -0.1)])
state, radii = contact.separated(), []
for force in (path := np.concatenate([loading, unloading])):
    state = contact.step(state, force * unit / size**2)
    radii.append(0.0 if state.detached else np.sqrt(np.mean(state.gap < 1.1 * length) / np.pi) * size)
    if state.detached:
        break

theory = JKR(radius, modulus, work).curve(3 * unit)
tabor = (radius * work**2 / (modulus**2 * length**3)) ** (1 / 3)

figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
axes.plot(theory.force / unit, theory.contact_radius * 1e9, "-", color="0.6", label="JKR")
axes.plot(path[:8], np.array(radii[:8]) * 1e9, "o", mfc="w", label="loading")
axes.plot(path[8 : len(radii)], np.array(radii[8:]) * 1e9, "s", ms=4, label="unloading")
axes.set(xlabel="force / π w R", ylabel="contact radius (nm)", title=f"Tabor parameter {tabor:.1f}")
axes.legend(frameon=False)
figure.savefig("jkr_sphere.png", dpi=150)
