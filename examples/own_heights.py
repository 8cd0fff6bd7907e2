"""Heights of one's own
====================

A height array of one's own, pressed: contact area over pressure, and where it touches::

    python examples/own_heights.py -o own_heights.png
"""

import argparse

import matplotlib.pyplot as plt
import numpy as np

from bem_adhesion import LennardJones104, rough_contact

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("-o", "--output", default="own_heights.png", help="figure")
output = parser.parse_args().output

# Any periodic array of heights in metres will do: here noise with its short waves filtered out.
size, points = 100e-9, 128
noise = np.fft.rfft2(np.random.default_rng(1).standard_normal((points, points)))
waves = np.hypot(np.fft.fftfreq(points, 1 / points)[:, None], np.fft.rfftfreq(points, 1 / points))
height = np.fft.irfft2(noise * (1 + waves) ** -1.8 * (waves < 12), (points, points))
height *= 1e-9 / height.std()

law = LennardJones104(work_of_adhesion=0.1, length=0.33e-9)
contact = rough_contact(height, size, elasticity=20e9, law=law)

pressures = np.geomspace(20e6, 2e9, 9)
states, state = [], contact.separated()
for pressure in pressures:
    states.append(contact.step(state, pressure))
    state = states[-1].state

areas = [np.mean(found.gap < 1.12 * law.length) for found in states]
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
left.loglog(pressures / 1e6, areas, "o-")
left.set(xlabel="pressure (MPa)", ylabel="relative contact area")
left.set_yticks([0.02, 0.05, 0.1, 0.2, 0.5], ["0.02", "0.05", "0.1", "0.2", "0.5"])
left.minorticks_off()
middle = len(states) // 2
image = right.imshow(states[middle].gap * 1e9, extent=[0, size * 1e9] * 2, origin="lower", cmap="viridis")
figure.colorbar(image, label="gap (nm)")
right.contour(
    states[middle].gap, [1.12 * law.length], colors="w", linewidths=0.6, extent=[0, size * 1e9] * 2, origin="lower"
)
right.set(xlabel="x (nm)", ylabel="y (nm)", title=f"{pressures[middle] / 1e6:.0f} MPa, contact outlined")
figure.savefig(output, dpi=150)
