"""Heights of your own
===================

Any periodic array of heights in metres can be pressed; here it is filtered noise. The figure shows the contact area,
nearly proportional to pressure, and a map of the gap with the edge of contact.
"""

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import LennardJones104, rough_contact

size, points = 100e-9, 128
noise = np.fft.rfft2(np.random.default_rng(1).standard_normal((points, points)))
waves = np.hypot(np.fft.fftfreq(points, 1 / points)[:, None], np.fft.rfftfreq(points, 1 / points))
height = np.fft.irfft2(noise * (1 + waves) ** -1.8 * (waves < 12))
height *= 1e-9 / height.std()

law = LennardJones104(work_of_adhesion=0.1, length=0.33e-9)
contact = rough_contact(height, size, elasticity=20e9, law=law)
pressures, touching = np.geomspace(20, 2000, 9), 1.12 * law.length  # MPa, m
state, gaps = contact.separated(), []
for pressure in pressures:
    state = contact.step(state, pressure * 1e6)
    gaps.append(state.gap)

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
left.loglog(pressures, [np.mean(gap < touching) for gap in gaps], "o-")
left.set(xlabel="pressure (MPa)", ylabel="relative contact area")
left.tick_params("y", which="minor", labelleft=False)
cell = {"extent": [0, size * 1e9] * 2, "origin": "lower"}
image = right.imshow(gaps[4] * 1e9, **cell)
right.contour(gaps[4], [touching], colors="w", linewidths=0.6, **cell)
right.set(xlabel="x (nm)", ylabel="y (nm)", title=f"{pressures[4]:.0f} MPa, contact outlined")
figure.colorbar(image, label="gap (nm)")
figure.savefig("own_heights.png", dpi=150)
