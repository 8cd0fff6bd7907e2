"""A line contact that sticks
==========================

A cylinder is pressed on a soft half-space and pulled off. The surface ends across the line and repeats along it. The
figure shows that force and width follow the theory of JKR down to its least force. What the width lacks is the process
zone beside it, 0.08 µm at this range of adhesion.
"""

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import Exponential, rough_contact

radius, modulus, work = 10e-6, 1e6, 0.01  # m, Pa, J/m²
points, extent = 512, 10e-6
across = (np.arange(points) + 0.5) * extent / points - extent / 2
height = np.tile(-(across[:, None] ** 2) / (2 * radius), (1, 4))  # the line runs along x
contact = rough_contact(
    height, (extent, 4 * extent / points), modulus, Exponential(work, 28e-9), control="approach", boundary="free_y"
)

state, forces, widths = contact.separated(), [], []
for approach in np.linspace(0.6e-6, -0.5e-6, 56):
    found = contact.step(state, approach)
    if found.relative_contact_area == 0:
        break
    state = found.state
    forces.append(found.pressure.mean() * extent)
    widths.append(found.relative_contact_area * extent / 2)

a = np.linspace(1e-9, max(widths), 400)
jkr = np.pi * modulus * a**2 / (4 * radius) - np.sqrt(2 * np.pi * modulus * work * a)
figure, axes = plt.subplots(figsize=(5.2, 3.8), layout="constrained")
axes.plot(a * 1e6, jkr, "k-", lw=0.9, label="JKR, of a line")
axes.plot(np.array(widths) * 1e6, forces, "o", markersize=4, label="boundary elements")
axes.axhline(-0.75 * np.cbrt(4 * np.pi * modulus * work**2 * radius), color="0.6", lw=0.8, label="JKR, pull-off")
axes.set(xlabel="half width (µm)", ylabel="force per length (N/m)")
axes.legend(frameon=False)
figure.savefig("line_contact.png", dpi=150)
